#include "energy/density_hessian.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/random_matrices.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

template <int n>
Mat<n, Lanes> identity() {
    Mat<n, Lanes> I{};
    for (int i = 0; i < n; ++i) I[i][i] = in_all_lanes(1);
    return I;
}

// The Hessian applied to dF, in one lane.
template <int n>
Mat<n> apply(const Tensor<n>& C, const Mat<n>& dF, int lane) {
    Mat<n> result{};
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l)
            for (int a = 0; a < n; ++a)
                for (int b = 0; b < n; ++b) result[a][k] += C[k][l][a][b][lane] * dF[b][l];
    return result;
}

template <int n>
Tensor<n> hessian(const Mat<n, Lanes>& F, double delta, Objective objective, double kept_negative) {
    return with_density({.objective = objective}, [&](auto density) {
        return density_hessian<n>(F, identity<n>(), in_all_lanes(1), density, delta, kept_negative);
    });
}

template <int n>
Mat<n> gradient(const Mat<n>& F, double delta, Objective objective) {
    return with_density({.objective = objective}, [&](auto density) { return density_gradient<n>(F, delta, density); });
}

// Central differences of the gradient: the error must fall as t^2, in every lane.
template <int n>
void check_slopes(std::mt19937& random, double thin, double delta, Objective objective, double step) {
    Mat<n, Lanes> F;
    for (int l = 0; l < lanes; ++l) set_lane<n>(F, l, random_gradient<n>(random, thin));
    const Tensor<n> C = hessian<n>(F, delta, objective, 1);
    const Mat<n> dF = random_matrix<n>(random);
    for (int l = 0; l < lanes; ++l) {
        const Mat<n> single = lane_of<n>(F, l), exact = apply<n>(C, dF, l);
        double error[2];
        for (int k = 0; k < 2; ++k) {
            const double t = step / (1 + k);
            Mat<n> difference = gradient<n>(shifted<n>(single, dF, t), delta, objective);
            difference = shifted<n>(difference, gradient<n>(shifted<n>(single, dF, -t), delta, objective), -1);
            for (auto& row : difference)
                for (double& v : row) v /= 2 * t;
            error[k] = std::sqrt(frobenius_squared<n>(shifted<n>(difference, exact, -1)));
        }
        CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.05));
    }
}

template <int n>
void check_second_derivatives() {
    std::mt19937 random(7);
    for (const Objective objective : {Objective::squared, Objective::deviation, Objective::size_shape}) {
        check_slopes<n>(random, 1, 0, objective, 2e-2);
        check_slopes<n>(random, 1e-2, 0, objective, 2e-4);  // nearly inverted
        check_slopes<n>(random, -0.5, 0.3, objective, 1e-2);  // inverted, regularised
    }
}

// Frobenius norm, in one lane.
template <int n>
double norm_of(const Tensor<n>& C, int lane) {
    double squared = 0;
    for (const auto& row : C)
        for (const auto& block : row)
            for (const auto& entries : block)
                for (const Lanes& entry : entries) squared += entry[lane] * entry[lane];
    return std::sqrt(squared);
}

// dF : (projected Hessian) dF is neither negative nor below the unprojected form, and above it for some.
template <int n>
void check_projection(Objective objective) {
    std::mt19937 random(11);
    int lifted = 0;
    for (int trial = 0; trial < 50; ++trial) {
        Mat<n, Lanes> F;
        for (int l = 0; l < lanes; ++l) set_lane<n>(F, l, random_gradient<n>(random, l % 2 ? 0.2 : 0.05));
        const Tensor<n> full = hessian<n>(F, 0, objective, 1);
        const Tensor<n> projected = hessian<n>(F, 0, objective, 0);
        for (int l = 0; l < lanes; ++l) {
            const Mat<n> dF = random_matrix<n>(random);
            const double scale = std::sqrt(frobenius_squared<n>(apply<n>(full, dF, l)));
            const double before = inner<n>(dF, apply<n>(full, dF, l)), after = inner<n>(dF, apply<n>(projected, dF, l));
            CHECK(after >= -1e-14 * scale);
            CHECK(after >= before - 1e-13 * scale);
            // What is left out and what is left have nothing to do with each other: (H + H-) H- = 0.
            const Mat<n> left_out = shifted<n>(apply<n>(projected, dF, l), apply<n>(full, dF, l), -1);
            const Mat<n> of_both = apply<n>(projected, left_out, l);
            CHECK(std::sqrt(frobenius_squared<n>(of_both)) <= 1e-11 * norm_of<n>(projected, l) * scale);
            lifted += after > before + 1e-6 * scale;
        }
    }
    CHECK(lifted > 0);  // otherwise there is nothing to project
}

}  // namespace

TEST_CASE("second derivatives have slope 2 in 2D") { check_second_derivatives<2>(); }
TEST_CASE("second derivatives have slope 2 in 3D") { check_second_derivatives<3>(); }
TEST_CASE("the projected Hessian has no negative part and lies above the full one") {
    for (const Objective objective : {Objective::deviation, Objective::size_shape}) {
        check_projection<2>(objective);
        check_projection<3>(objective);
    }
}

TEST_CASE("at the identity the Hessian of Eq. 5 is zero and that of eta^2 has the conformal maps as kernel") {
    const Tensor<3> zero = hessian<3>(identity<3>(), 0, Objective::deviation, 1);
    const Tensor<3> A = hessian<3>(identity<3>(), 0, Objective::squared, 1);
    const Mat<3> rotation = {{{0, 1, 2}, {-1, 0, 3}, {-2, -3, 0}}}, shear = {{{0, 1, 0}, {1, 0, 0}, {0, 0, 0}}};
    const Mat<3> scaling = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int l = 0; l < lanes; ++l) {
        CHECK(frobenius_squared<3>(apply<3>(zero, shear, l)) < 1e-26);
        CHECK(frobenius_squared<3>(apply<3>(A, rotation, l)) < 1e-26);
        CHECK(frobenius_squared<3>(apply<3>(A, scaling, l)) < 1e-26);
        CHECK(inner<3>(shear, apply<3>(A, shear, l)) > 1);
    }
}

TEST_CASE_TEMPLATE("in the coordinates of an element the second derivative is that along dJ A^{-1}", Dimension,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
    constexpr int n = Dimension::value;
    std::mt19937 random(13);
    Mat<n, Lanes> J, F, inverse_of_A;
    for (int l = 0; l < lanes; ++l) {
        const Mat<n> of_F = random_gradient<n>(random, 0.5), A = random_gradient<n>(random, 1);
        set_lane<n>(F, l, of_F);
        set_lane<n>(J, l, multiply<n>(of_F, A));
        set_lane<n>(inverse_of_A, l, inverse<n>(A));
    }
    const Power squared{Shape(), false};
    for (const double kept_negative : {1.0, 0.3, 0.0}) {
        const Tensor<n> in_F = density_hessian<n>(F, identity<n>(), in_all_lanes(1), squared, 0, kept_negative);
        const Tensor<n> in_J = density_hessian<n>(J, inverse_of_A, in_all_lanes(3), squared, 0, kept_negative);
        for (int l = 0; l < lanes; ++l) {
            const Mat<n> dJ = random_matrix<n>(random), dF = multiply<n>(dJ, lane_of<n>(inverse_of_A, l));
            CHECK(inner<n>(dJ, apply<n>(in_J, dJ, l)) ==
                  doctest::Approx(3 * inner<n>(dF, apply<n>(in_F, dF, l))).epsilon(1e-11));
        }
    }
}

TEST_CASE("the full Hessian has the same bits above and below its diagonal") {
    std::mt19937 random(29);
    Mat<3, Lanes> F;
    for (int l = 0; l < lanes; ++l) set_lane<3>(F, l, random_gradient<3>(random, 0.1));
    const Tensor<3> C = hessian<3>(F, 0, Objective::deviation, 1);
    for (int l = 0; l < lanes; ++l)
        for (int k = 0; k < 9; ++k)
            for (int i = 0; i < 9; ++i) CHECK(C[k / 3][i / 3][k % 3][i % 3][l] == C[i / 3][k / 3][i % 3][k % 3][l]);
}
