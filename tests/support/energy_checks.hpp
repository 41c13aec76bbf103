// What tests of energies ask of them, whatever their elements are.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "energy/distortion_energy.hpp"
#include "support/assemblies.hpp"

namespace almesh::test {

inline constexpr Objective all_objectives[] = {Objective::squared, Objective::deviation, Objective::size_shape,
                                    Objective::minimax};

inline AssembledParams with(Objective objective, Assembly assembly = Assembly::simd, double alpha = 0.5) {
    AssembledParams params{{.objective = objective, .weight_exponent = alpha}, assembly};
    if (objective == Objective::minimax) params.power = {.p = 6, .M = 0.8, .kappa = 0.1};
    return params;
}

// 2x in the first direction, then turned: eta = 5/4 in 2D.
inline std::vector<double> stretched(std::vector<double> x, int dim = 2) {
    for (std::size_t i = 0; i < x.size(); i += dim) {
        const double a = 2 * x[i], b = x[i + 1];
        x[i] = 0.6 * a - 0.8 * b;
        x[i + 1] = 0.8 * a + 0.6 * b;
    }
    return x;
}

inline std::vector<double> gradient(DistortionEnergy& E, const std::vector<double>& x) {
    std::vector<double> g(x.size(), 0.0);
    E.add_gradient(x, g);
    return g;
}

// max |a - b| in units of max |b|.
template <class Values>
double relative_difference(const Values& a, const Values& b) {
    REQUIRE(a.size() == b.size());
    double most = 0, of_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        most = std::max(most, std::abs(a[i] - b[i]));
        of_b = std::max(of_b, std::abs(b[i]));
    }
    return most / of_b;
}

// tolerance: of gradient and Hessians.
inline void check_same(DistortionEnergy& a, DistortionEnergy& b, const std::vector<double>& x,
                       double tolerance = 1e-12) {
    REQUIRE(std::isfinite(b.energy(x)));
    CHECK(a.energy(x) == doctest::Approx(b.energy(x)).epsilon(1e-12));
    CHECK(relative_difference(gradient(a, x), gradient(b, x)) <= tolerance);
    for (const HessianKind kind : {HessianKind::full, HessianKind::projected, HessianKind::damping}) {
        BlockCsr A = a.hessian_pattern(), B = b.hessian_pattern();
        REQUIRE(A.col == B.col);
        a.add_hessian(x, kind, A, {.damping = 0.2});
        b.add_hessian(x, kind, B, {.damping = 0.2});
        CHECK(relative_difference(A.value, B.value) <= tolerance);
    }
    const DistortionStatistics of_a = a.statistics(x), of_b = b.statistics(x);
    CHECK(of_a.relative_quality == doctest::Approx(of_b.relative_quality).epsilon(1e-13));
    CHECK(relative_difference(of_a.element_max, of_b.element_max) <= 1e-12);
    CHECK(a.hessian_work() == b.hessian_work());
    CHECK(a.refined_elements() == b.refined_elements());
}

// Gradient and Hessian against central differences of energy and gradient.
inline void check_slopes(DistortionEnergy& E, const std::vector<double>& x) {
    std::vector<double> d(x.size()), Hd(x.size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(1.0 + 7 * static_cast<double>(i));
    const auto along = [&](double t) {
        std::vector<double> y = x;
        for (std::size_t i = 0; i < y.size(); ++i) y[i] += t * d[i];
        return y;
    };
    BlockCsr H = E.hessian_pattern();
    E.add_hessian(x, HessianKind::full, H);
    multiply(H, d.data(), Hd.data());
    const std::vector<double> g = gradient(E, x);
    double slope = 0;
    for (std::size_t i = 0; i < d.size(); ++i) slope += g[i] * d[i];
    double of_energy[2], of_gradient[2] = {};
    for (int k = 0; k < 2; ++k) {
        const double t = k == 0 ? 4e-4 : 2e-4;
        const std::vector<double> there = gradient(E, along(t)), back = gradient(E, along(-t));
        of_energy[k] = std::abs((E.energy(along(t)) - E.energy(along(-t))) / (2 * t) - slope);
        for (std::size_t i = 0; i < d.size(); ++i)
            of_gradient[k] = std::max(of_gradient[k], std::abs((there[i] - back[i]) / (2 * t) - Hd[i]));
    }
    CHECK(std::log2(of_energy[0] / of_energy[1]) == doctest::Approx(2).epsilon(0.1));
    CHECK(std::log2(of_gradient[0] / of_gradient[1]) == doctest::Approx(2).epsilon(0.1));
}

}  // namespace almesh::test
