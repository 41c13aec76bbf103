// The energy densities f(eta): what the objectives integrate over the ideal mesh.
//
// A density is a struct with the distortion measure that it is a function of, f with two derivatives, and f'/2 at the eta
// where f has a given value (which scales the damping of Newton's method). To add one: the struct, its enumerator, its line in with_density(), its word among the values of the
// deck's key `objective` (app/deck_keys.cpp). Plain and SIMD assembly, Newton's method and its damping need no more.
// f must be increasing and convex for eta >= 1.
#pragma once
#include <cmath>

#include "energy/distortion.hpp"

namespace almesh {

// squared: eta^2, the objective of the paper's tables. deviation: (eta - 1)^2, its Eq. 5. size_shape: (eta - 1)^2 of the
// distortion of shape and size.
enum class Objective { squared, deviation, size_shape };

// (eta - 1)^2, or eta^2 where `from_one` is false.
template <class MeasureOf>
struct Quadratic {
    using Measure = MeasureOf;
    bool from_one;
    template <class T> T root(T eta) const { return from_one ? eta - 1 : eta; }
    template <class T> T f(T eta) const { return root(eta) * root(eta); }
    template <class T> T f1(T eta) const { return 2 * root(eta); }
    template <class T> T f2(T) const { return T{} + 2; }
    double half_slope(double f) const { return std::sqrt(f); }
};

// body(density) for the one that the objective names.
template <class Body>
auto with_density(Objective objective, const Body& body) {
    if (objective == Objective::size_shape) return body(Quadratic<ShapeAndSize>{true});
    return body(Quadratic<Shape>{objective == Objective::deviation});
}

// share f + (1 - share) eta^2: the objective with its damping (distortion_energy.hpp).
template <class Density>
struct Damped {
    using Measure = typename Density::Measure;
    Density of;
    Lanes share;
    Lanes f1(Lanes eta) const { return 2 * eta + share * (of.f1(eta) - 2 * eta); }
    Lanes f2(Lanes eta) const { return 2 + share * (of.f2(eta) - 2); }
};

template <class Density>
Damped<Density> damped(Density density, Lanes share) {
    return {density, share};
}

// Of a quadratic again one, (eta - shift)^2 up to a constant.
template <class MeasureOf>
struct ShiftedQuadratic {
    using Measure = MeasureOf;
    Lanes shift;
    Lanes f1(Lanes eta) const { return 2 * (eta - shift); }
    Lanes f2(Lanes) const { return in_all_lanes(2); }
};

template <class Measure>
ShiftedQuadratic<Measure> damped(Quadratic<Measure> density, Lanes share) {
    return {density.from_one ? share : Lanes{}};
}

// df/dF. F must have finite distortion.
template <int n, class T = double, class Density>
Mat<n, T> density_gradient(const Mat<n, T>& F, double delta, Density density) {
    const T S = frobenius_squared<n>(F);
    const auto [r, r1, r2] = Density::Measure::template derivatives<n>(determinant(F), delta);
    const T f1 = density.f1(S * r), along_F = 2 * f1 * r, along_C = f1 * S * r1;
    const Mat<n, T> C = cofactor(F);
    Mat<n, T> P;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) P[i][j] = along_F * F[i][j] + along_C * C[i][j];
    return P;
}

}  // namespace almesh
