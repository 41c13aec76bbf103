// What tests of energies ask of them, whatever their elements are.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "energy/distortion_energy.hpp"

namespace almesh::test {

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

}  // namespace almesh::test
