// The point-wise distortion of a map with Jacobian F = D phi (paper, Eqs. 1-3), and a variant that sees sizes too. Both
// have the form
//
//     eta(F) = |F|^2 r(D),   D = det F,   |F| the Frobenius norm,
//
// and a measure gives r with its derivatives:
//
//     Shape         r = 1 / (n sigma_delta^{2/n}),   sigma_delta = (D + sqrt(D^2 + 4 delta^2)) / 2     (Eqs. 1, 3)
//     ShapeAndSize  r = that of Shape times (sigma_delta + 1/sigma_delta) / 2
//
// Shape is 1 for a rotation times a scaling; with the size factor of Garanzha, Kaporin, Kudryavtseva, Protais, Ray,
// Sokolov ("Foldover-free maps in 50 lines of code", ACM TOG 40, 2021) only rotations have 1. Both grow without bound
// towards D = 0; with delta = 0 they are infinite for D <= 0, so that no line search accepts an inverted element.
// T is double or Lanes: the same formulas for one point or for one in each lane.
#pragma once
#include <limits>

#include "base/lanes.hpp"
#include "base/small_matrix.hpp"

namespace almesh {

// r(D) and its derivatives with respect to D.
template <class T>
struct DeterminantFactor {
    T r, r1, r2;
};

// sigma_delta, w = sqrt(D^2 + 4 delta^2): for D <= 0 in the equivalent form without cancellation.
template <class T>
T regularised_determinant(T D, T w, double delta) {
    return select(D > 0, 0.5 * (D + w), 2 * delta * delta / (w - D));
}

struct Shape {
    template <int n, class T>
    static T factor(T D, double delta) {
        const T sigma = regularised_determinant<T>(D, sqrt(D * D + 4 * delta * delta), delta);
        if constexpr (n == 2) return 0.5 / sigma;
        const T root = inverse_cbrt(sigma);
        return (1.0 / 3) * root * root;
    }

    // d sigma_delta / dD = sigma_delta / w.
    template <int n, class T>
    static DeterminantFactor<T> derivatives(T D, double delta) {
        const T w = sqrt(D * D + 4 * delta * delta), over_w = 1 / w;
        const T r = factor<n>(D, delta);
        const T r1 = -2.0 / n * r * over_w;
        return {r, r1, -2.0 / n * over_w * (r1 - r * D * over_w * over_w)};
    }
};

struct ShapeAndSize {
    template <int n, class T>
    static T factor(T D, double delta) {
        const T sigma = regularised_determinant<T>(D, sqrt(D * D + 4 * delta * delta), delta);
        return Shape::factor<n>(D, delta) * (0.5 * (sigma + 1 / sigma));
    }

    // Product rule with s = (sigma_delta + 1/sigma_delta) / 2.
    template <int n, class T>
    static DeterminantFactor<T> derivatives(T D, double delta) {
        const T w = sqrt(D * D + 4 * delta * delta), over_w = 1 / w;
        const T sigma = regularised_determinant<T>(D, w, delta), s = 0.5 * (sigma + 1 / sigma);
        const T s1 = 0.5 * (sigma - 1 / sigma) * over_w, s2 = (s - s1 * D) * over_w * over_w;
        const auto [r, r1, r2] = Shape::derivatives<n>(D, delta);
        return {r * s, r1 * s + r * s1, r2 * s + 2 * r1 * s1 + r * s2};
    }
};

// eta(F); infinite where delta = 0 and det F is not positive (nan included).
template <int n, class T = double, class Measure = Shape>
T distortion(const Mat<n, T>& F, double delta, Measure = {}) {
    const T D = determinant(F), eta = frobenius_squared<n>(F) * Measure::template factor<n>(D, delta);
    if (delta > 0) return eta;
    return select(D > 0, eta, T{} + std::numeric_limits<double>::infinity());
}

}  // namespace almesh
