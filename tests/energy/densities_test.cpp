#include "energy/densities.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "energy/density_hessian.hpp"
#include "support/random_matrices.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// (eta - 1)^4: a density that is no quadratic, as a user of densities.hpp would add it.
template <class MeasureOf>
struct Quartic {
    using Measure = MeasureOf;
    template <class T> T f(T eta) const { return (eta - 1) * (eta - 1) * (eta - 1) * (eta - 1); }
    template <class T> T f1(T eta) const { return 4 * (eta - 1) * (eta - 1) * (eta - 1); }
    template <class T> T f2(T eta) const { return 12 * (eta - 1) * (eta - 1); }
    double half_slope(double f) const { return 2 * std::pow(f, 0.75); }
};

template <int n>
Mat<n, Lanes> in_all(const Mat<n>& F) {
    Mat<n, Lanes> all;
    for (int l = 0; l < lanes; ++l) set_lane<n>(all, l, F);
    return all;
}

template <int n>
Mat<n, Lanes> identity() {
    Mat<n> I{};
    for (int i = 0; i < n; ++i) I[i][i] = 1;
    return in_all<n>(I);
}

// Of a density that may exist in lanes only: in the last lane.
template <int n, class Density>
Mat<n> gradient(const Mat<n>& F, double delta, Density density) {
    return lane_of<n>(density_gradient<n, Lanes>(in_all<n>(F), delta, density), lanes - 1);
}

// Its Hessian applied to dF.
template <int n, class Density>
Mat<n> hessian_times(const Mat<n>& F, double delta, Density density, const Mat<n>& dF) {
    const Tensor<n> C =
        density_hessian<n>(in_all<n>(F), identity<n>(), in_all_lanes(1), density, delta, 1);
    Mat<n> result{};
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l)
            for (int a = 0; a < n; ++a)
                for (int b = 0; b < n; ++b) result[a][k] += C[k][l][a][b][lanes - 1] * dF[b][l];
    return result;
}

template <int n>
double norm(const Mat<n>& F) {
    return std::sqrt(frobenius_squared<n>(F));
}

// How the error of central differences falls when their step is halved: 2 for derivatives that belong together.
double order(double of_step, double of_half) { return std::log2(of_step / of_half); }

template <int n, class Density>
void check_gradient(const Mat<n>& F, double delta, Density density, const Mat<n>& dF, double step) {
    const auto f = [&](double t) {
        return density.f(distortion<n>(shifted<n>(F, dF, t), delta, measure_of(density)));
    };
    const double exact = inner<n>(density_gradient<n>(F, delta, density), dF);
    const auto error = [&](double t) { return std::abs((f(t) - f(-t)) / (2 * t) - exact); };
    CHECK(order(error(step), error(step / 2)) == doctest::Approx(2).epsilon(0.05));
}

template <int n, class Density>
void check_hessian(const Mat<n>& F, double delta, Density density, const Mat<n>& dF, double step) {
    const Mat<n> exact = hessian_times<n>(F, delta, density, dF);
    const auto error = [&](double t) {
        Mat<n> difference = shifted<n>(gradient<n>(shifted<n>(F, dF, t), delta, density),
                                       gradient<n>(shifted<n>(F, dF, -t), delta, density), -1);
        for (auto& row : difference)
            for (double& v : row) v /= 2 * t;
        return norm<n>(shifted<n>(difference, exact, -1));
    };
    CHECK(order(error(step), error(step / 2)) == doctest::Approx(2).epsilon(0.05));
}

// share a + (1 - share) b against c, to the rounding of the terms.
template <int n>
void check_mixture(const Mat<n>& a, const Mat<n>& b, double share, const Mat<n>& c) {
    const Mat<n> mixture = shifted<n>(shifted<n>(Mat<n>{}, a, share), b, 1 - share);
    CHECK(norm<n>(shifted<n>(c, mixture, -1)) < 1e-14 * (norm<n>(a) + norm<n>(b)));
}

// The gradient and the Hessian of share f + (1 - share) eta^2 from those of both.
template <int n, class Density>
void check_damped(const Mat<n>& F, Density density, double share, const Mat<n>& dF) {
    const auto of_damped = damped(density, in_all_lanes(share));
    const Power squared{measure_of(density), false};
    for (const double delta : {0.0, 0.3}) {
        check_mixture<n>(gradient<n>(F, delta, density), gradient<n>(F, delta, squared), share,
                         gradient<n>(F, delta, of_damped));
        check_mixture<n>(hessian_times<n>(F, delta, density, dF), hessian_times<n>(F, delta, squared, dF), share,
                         hessian_times<n>(F, delta, of_damped, dF));
    }
}

template <int n, class Measure>
void check_quartic() {
    std::mt19937 random(17);
    const Quartic<Measure> density;
    for (int trial = 0; trial < 5; ++trial) {
        const Mat<n> dF = random_matrix<n>(random), thin = random_gradient<n>(random, 0.1),
                     inverted = random_gradient<n>(random, -0.5);
        check_gradient<n>(thin, 0, density, dF, 1e-3);
        check_gradient<n>(inverted, 0.3, density, dF, 1e-3);
        check_hessian<n>(thin, 0, density, dF, 1e-3);
        check_hessian<n>(inverted, 0.3, density, dF, 1e-3);
        check_hessian<n>(thin, 0, damped(density, in_all_lanes(0.3)), dF, 1e-3);
        for (double share : {0.0, 0.3, 1.0}) {
            check_damped<n>(thin, density, share, dF);
            check_damped<n>(thin, Power{Measure(), true}, share, dF);
            check_damped<n>(thin, Power{Measure(), false}, share, dF);
        }
    }
}

}  // namespace

TEST_CASE("a density that is no quadratic: slopes of gradient and Hessian, and its damping") {
    check_quartic<2, Shape>();
    check_quartic<2, ShapeAndSize>();
    check_quartic<3, Shape>();
    check_quartic<3, ShapeAndSize>();
    check_quartic<2, Tangled>();
    check_quartic<3, Tangled>();
}

TEST_CASE("powers: slopes of gradient and Hessian, their damping, and the square among them") {
    std::mt19937 random(23);
    const Power of_deviation{Shape(), true, 4, 1.7, 0.01}, of_distortion{Shape(), false, 3, 0.5, 0};
    const Mat<2> F = random_gradient<2>(random, 0.1), dF = random_matrix<2>(random);
    const Mat<3> F3 = random_gradient<3>(random, 0.1), dF3 = random_matrix<3>(random);
    for (const auto& density : {of_deviation, of_distortion}) {
        check_gradient<2>(F, 0, density, dF, 1e-3);
        check_hessian<2>(F, 0, density, dF, 1e-3);
        check_gradient<3>(F3, 0, density, dF3, 1e-3);
        check_hessian<3>(F3, 0, density, dF3, 1e-3);
        for (double share : {0.0, 0.3, 1.0}) check_damped<3>(F3, density, share, dF3);
    }
    for (const double eta : {1.0, 1.5, 7.0}) {
        const Power square{Shape(), true, 2, 3, 0};
        CHECK(square.f(eta) == doctest::Approx((eta - 1) * (eta - 1)));
        CHECK(square.f1(eta) == doctest::Approx(2 * (eta - 1)));
        CHECK(square.f2(eta) == doctest::Approx(2));
    }
    CHECK(Power{Shape(), true, 64, 2, 0}.f(3.0) == doctest::Approx(4));  // M^2 where eta - 1 = M
    CHECK(with_density({.objective = Objective::deviation, .power = {5, 1, 0}},
                       [](auto density) { return density.f(3.0); }) == 32);
}

TEST_CASE("of a density that is no quadratic too the projected Hessian has no negative part") {
    std::mt19937 random(19);
    int lifted = 0;
    for (int trial = 0; trial < 50; ++trial) {
        const Mat<3> F = random_gradient<3>(random, 0.1), dF = random_matrix<3>(random);
        double form[2];
        for (int projected = 0; projected < 2; ++projected) {
            const Tensor<3> C =
                density_hessian<3>(in_all<3>(F), identity<3>(), in_all_lanes(1), Quartic<Shape>(), 0, 1 - projected);
            form[projected] = 0;
            for (int k = 0; k < 3; ++k)
                for (int l = 0; l < 3; ++l)
                    for (int a = 0; a < 3; ++a)
                        for (int b = 0; b < 3; ++b) form[projected] += dF[a][k] * C[k][l][a][b][0] * dF[b][l];
        }
        const double scale = norm<3>(hessian_times<3>(F, 0, Quartic<Shape>(), dF));
        CHECK(form[1] >= -1e-14 * scale);
        CHECK(form[1] >= form[0] - 1e-13 * scale);
        lifted += form[1] > form[0] + 1e-6 * scale;
    }
    CHECK(lifted > 0);
}

TEST_CASE("half_slope is f'/2 at the eta where f has the given value") {
    const auto check = [](auto density) {
        for (double eta : {1.0, 1.25, 3.0, 40.0})
            CHECK(density.half_slope(density.f(eta)) == doctest::Approx(0.5 * density.f1(eta)).epsilon(1e-13));
    };
    for (const Objective objective : {Objective::squared, Objective::deviation, Objective::size_shape})
        with_density({.objective = objective}, check);
    check(Quartic<Shape>());
    check(Power{Shape(), true, 8, 2.5, 0});
}

TEST_CASE("each objective has the density of its formula") {
    const auto f = [](Objective objective, double eta) {
        return with_density({.objective = objective}, [eta](auto density) { return density.f(eta); });
    };
    const auto eta = [](Objective objective) {  // of a scaling by 2 in 2D
        return with_density({.objective = objective}, [](auto density) {
            return distortion<2>({{{2, 0}, {0, 2}}}, 0, measure_of(density));
        });
    };
    CHECK(f(Objective::squared, 3) == 9);
    CHECK(f(Objective::deviation, 3) == 4);
    CHECK(f(Objective::size_shape, 3) == 4);
    CHECK(eta(Objective::squared) == 1);
    CHECK(eta(Objective::deviation) == 1);
    CHECK(eta(Objective::size_shape) == 2.125);  // (4 + 1/4) / 2
}

TEST_CASE("the regularised determinant of Eq. 3, for inverted elements in another form") {
    for (const double delta : {1e-3, 0.3, 10.0})
        for (const double D : {-2.0, -0.1, -1e-3, 0.0, 1e-3, 0.1, 2.0}) {
            const double w = std::sqrt(D * D + 4 * delta * delta), sigma = regularised_determinant(D, w, delta);
            CHECK(sigma == doctest::Approx(0.5 * (D + w)).epsilon(1e-9));
            CHECK(sigma * (sigma - D) == doctest::Approx(delta * delta).epsilon(1e-9));
        }
}
