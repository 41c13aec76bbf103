#include "energy/densities.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/random_matrices.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Central differences against the derivative: the error must fall as t^2.
template <int n>
void check_slope(const Mat<n>& F, double delta, Objective objective, const Mat<n>& dF, double t) {
    with_density({.objective = objective}, [&](auto density) {
        const auto f = [&](double s) {
            return density.f(distortion<n>(shifted<n>(F, dF, s), delta, measure_of(density)));
        };
        const double exact = inner<n>(density_gradient<n>(F, delta, density), dF);
        double error[2];
        for (int k = 0; k < 2; ++k) {
            const double step = t / (1 + k);
            error[k] = std::abs((f(step) - f(-step)) / (2 * step) - exact);
        }
        CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.05));
    });
}

template <int n>
void check_gradients() {
    std::mt19937 random(7);
    for (const Objective objective : {Objective::squared, Objective::deviation, Objective::size_shape})
        for (int trial = 0; trial < 5; ++trial) {
            const Mat<n> dF = random_matrix<n>(random);
            check_slope<n>(random_gradient<n>(random, 1), 0, objective, dF, 2e-2);
            check_slope<n>(random_gradient<n>(random, 1e-2), 0, objective, dF, 2e-4);  // nearly inverted
            check_slope<n>(random_gradient<n>(random, -0.5), 0.3, objective, dF, 1e-2);  // inverted, regularised
        }
}

}  // namespace

TEST_CASE("eta is one exactly for rotations times scalings") {
    CHECK(distortion<2>({{{1, 0}, {0, 1}}}, 0) == 1);
    CHECK(distortion<3>({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 0) == doctest::Approx(1));
    CHECK(distortion<2>({{{0, -5}, {5, 0}}}, 0) == 1);
    CHECK(distortion<2>({{{2, 0}, {0, 1}}}, 0) == 1.25);           // (4 + 1) / (2 * 2)
    CHECK(distortion<3>({{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}}, 0) == doctest::Approx(1));
    CHECK(distortion<3>({{{8, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 0) == doctest::Approx(66.0 / (3 * 4)));
}

TEST_CASE("eta is infinite for degenerate and inverted maps, unless regularised") {
    CHECK(std::isinf(distortion<2>({{{1, 0}, {0, -1}}}, 0)));
    CHECK(std::isinf(distortion<2>({{{1, 1}, {1, 1}}}, 0)));
    CHECK(std::isinf(distortion<3>(Mat<3>{}, 0)));
    CHECK(std::isinf(distortion<2>({{{NAN, 0}, {0, 1}}}, 0)));
    // Eq. 3 at sigma = 0: sigma_delta = delta.
    CHECK(distortion<2>({{{1, 1}, {1, 1}}}, 0.5) == doctest::Approx(4 / (2 * 0.5)));
    CHECK(std::isfinite(distortion<2>({{{1, 0}, {0, -1}}}, 0.1)));
}

TEST_CASE("eta does not see rotations and scalings of either frame") {
    std::mt19937 random(3);
    for (int trial = 0; trial < 20; ++trial) {
        const Mat<3> F = random_gradient<3>(random, 0.3);
        Mat<3> R = random_rotation<3>(random);
        for (auto& row : R)
            for (double& v : row) v *= 7.5;
        const double eta = distortion<3>(F, 0);
        CHECK(distortion<3>(multiply<3>(R, F), 0) == doctest::Approx(eta));
        CHECK(distortion<3>(multiply<3>(F, R), 0) == doctest::Approx(eta));
    }
}

TEST_CASE("with the size factor eta is one exactly for rotations, and sees scalings of either sense alike") {
    std::mt19937 random(5);
    for (int trial = 0; trial < 20; ++trial) {
        CHECK(distortion<2>(random_rotation<2>(random), 0, ShapeAndSize()) == doctest::Approx(1).epsilon(1e-14));
        CHECK(distortion<3>(random_rotation<3>(random), 0, ShapeAndSize()) == doctest::Approx(1).epsilon(1e-14));
        CHECK(distortion<2>(random_gradient<2>(random, 1), 0, ShapeAndSize()) > 1.001);
        CHECK(distortion<3>(random_gradient<3>(random, 1), 0, ShapeAndSize()) > 1.001);
    }
    for (double s : {0.5, 2.0}) {  // det F = s^n
        const Mat<3> scaling = {{{s, 0, 0}, {0, s, 0}, {0, 0, s}}};
        CHECK(distortion<2>({{{s, 0}, {0, s}}}, 0, ShapeAndSize()) == doctest::Approx(0.5 * (4 + 0.25)));
        CHECK(distortion<3>(scaling, 0, ShapeAndSize()) == doctest::Approx(0.5 * (8 + 0.125)));
    }
    const Mat<2> same_area = {{{2, 0}, {0, 0.5}}};
    CHECK(distortion<2>(same_area, 0, ShapeAndSize()) == distortion<2>(same_area, 0));
    CHECK(std::isinf(distortion<2>({{{1, 0}, {0, -1}}}, 0, ShapeAndSize())));
    // sigma_delta = delta where det F = 0.
    CHECK(distortion<2>({{{1, 1}, {1, 1}}}, 0.5, ShapeAndSize()) == doctest::Approx(4 / (2 * 0.5) * 0.5 * (0.5 + 2)));
}

TEST_CASE("first derivatives have slope 2 in 2D") { check_gradients<2>(); }
TEST_CASE("first derivatives have slope 2 in 3D") { check_gradients<3>(); }

TEST_CASE("lanes give what a single number gives, the infinite ones too") {
    Mat<3, Lanes> F{};
    for (int l = 0; l < lanes; ++l) {
        F[0][0][l] = l - 0.5;  // the first is inverted
        F[1][1][l] = 2;
        F[2][1][l] = 0.3;
        F[2][2][l] = 1 + l;
    }
    for (const double delta : {0.0, 0.2}) {
        const Lanes eta = distortion<3>(F, delta);
        const Mat<3, Lanes> P = density_gradient<3>(F, delta, Power{Shape(), true});
        for (int l = 0; l < lanes; ++l) {
            const Mat<3> single = {{{l - 0.5, 0, 0}, {0, 2, 0}, {0, 0.3, 1.0 + l}}};
            if (l == 0 && delta == 0) {
                CHECK(std::isinf(eta[l]));
                continue;
            }
            CHECK(eta[l] == doctest::Approx(distortion<3>(single, delta)).epsilon(1e-14));
            const Mat<3> expected = density_gradient<3>(single, delta, Power{Shape(), true});
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    CHECK(P[i][j][l] == doctest::Approx(expected[i][j]).epsilon(1e-12).scale(1));
        }
    }
}
