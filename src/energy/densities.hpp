// The point-wise distortion eta of a map with Jacobian F = D phi (paper, Eqs. 1-3), and the densities f(eta) that the
// objectives integrate over the ideal mesh.
//
// A measure of distortion has the form
//
//     eta(F) = S r(D),   S = |F|^2,   D = det F,   |F| the Frobenius norm,
//
// and gives r with its derivatives:
//
//     Shape         r = 1 / (n sigma_delta^{2/n}),   sigma_delta = (D + sqrt(D^2 + 4 delta^2)) / 2     (Eqs. 1, 3)
//     ShapeAndSize  r = that of Shape times (sigma_delta + 1/sigma_delta) / 2
//     Tangled       r = that of Shape,   S = |F|^2 + n
//
// Shape is 1 for a rotation times a scaling; ShapeAndSize, with the size factor of Garanzha, Kaporin, Kudryavtseva,
// Protais, Ray, Sokolov ("Foldover-free maps in 50 lines of code", ACM TOG 40, 2021), for rotations only. Both tend to
// infinity as D falls to 0; with delta = 0 they are infinite for D <= 0, so that no line search accepts an inverted
// element. With delta > 0, Shape is 0 for an element that is a point; Tangled is large there, as in that reference.
//
// A density is a struct with the measure that it is a function of, f with two derivatives, and f'/2 at the eta where f
// has a given value (which scales the damping of Newton's method). f must be increasing and convex for eta >= 1. To
// add one: the struct, its line in with_density(), its enumerator in options.hpp, its word among the values of the
// deck's key `objective` (deck/deck_keys.cpp). Plain and SIMD assembly, Newton's method and its damping need no more.
//
// T is a double, or one in each lane of a register: the same formulas for one point or for several.
#pragma once
#include <cmath>
#include <limits>

#include "base/lanes.hpp"
#include "base/small_matrix.hpp"
#include "energy/options.hpp"

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

// Which one is told at run time: there are kernels for one only.
struct Measure {
    bool of_size = false;
    bool adds_n = false;  // to |F|^2

    template <int n, class T>
    T factor(T D, double delta) const {
        const T sigma = regularised_determinant<T>(D, sqrt(D * D + 4 * delta * delta), delta);
        const T r = of_shape<n>(sigma);
        return of_size ? r * (0.5 * (sigma + 1 / sigma)) : r;
    }

    // d sigma_delta / dD = sigma_delta / w; of the size factor s = (sigma_delta + 1/sigma_delta) / 2 the product rule.
    template <int n, class T>
    DeterminantFactor<T> derivatives(T D, double delta) const {
        const T w = sqrt(D * D + 4 * delta * delta), over_w = 1 / w;
        const T sigma = regularised_determinant<T>(D, w, delta), r = of_shape<n>(sigma);
        const T r1 = -2.0 / n * r * over_w, r2 = -2.0 / n * over_w * (r1 - r * D * over_w * over_w);
        if (!of_size) return {r, r1, r2};
        const T s = 0.5 * (sigma + 1 / sigma), s1 = 0.5 * (sigma - 1 / sigma) * over_w,
                s2 = (s - s1 * D) * over_w * over_w;
        return {r * s, r1 * s + r * s1, r2 * s + 2 * r1 * s1 + r * s2};
    }

private:
    template <int n, class T>
    static T of_shape(T sigma) {
        if constexpr (n == 2) return 0.5 / sigma;
        const T root = inverse_cbrt(sigma);
        return (1.0 / 3) * root * root;
    }
};

struct Shape : Measure {};
struct ShapeAndSize : Measure { ShapeAndSize() : Measure{.of_size = true} {} };
struct Tangled : Measure { Tangled() : Measure{.adds_n = true} {} };

// That of a density, which has it as a member or, where it is always the same, by its type.
template <class Density>
Measure measure_of(const Density& density) {
    if constexpr (requires { density.measure; }) return density.measure;
    else return typename Density::Measure();
}

// S
template <int n, class T>
T squared_stretch(const Mat<n, T>& F, const Measure& measure) {
    const T S = frobenius_squared<n>(F);
    return measure.adds_n ? S + n : S;
}

// eta(F); infinite where delta = 0 and det F is not positive (nan included).
template <int n, class T = double>
T distortion(const Mat<n, T>& F, double delta, const Measure& measure = {}) {
    const T D = determinant(F), eta = squared_stretch<n>(F, measure) * measure.factor<n>(D, delta);
    if (delta > 0) return eta;
    return select(D > 0, eta, std::numeric_limits<double>::infinity());
}

// x^k by squaring, k >= 0.
template <class T>
T integer_power(T x, int k) {
    T result = T{} + 1;
    for (; k > 0; k /= 2) {
        if (k % 2) result *= x;
        x *= x;
    }
    return result;
}

// M^2 (s^p + kappa s^2), s = (eta - 1) / M, or eta / M where `from_one` is false; p >= 2. By default the square.
struct Power {
    Measure measure;
    bool from_one;
    int p = 2;
    double M = 1, kappa = 0;
    bool is_square = p == 2 && M == 1 && kappa == 0;
    auto root(auto eta) const { return from_one ? eta - 1 : eta; }
    auto f(auto eta) const {
        const auto s = is_square ? root(eta) : root(eta) / M;
        return is_square ? s * s : M * M * (integer_power(s, p) + kappa * s * s);
    }
    auto f1(auto eta) const {
        const auto s = is_square ? root(eta) : root(eta) / M;
        return is_square ? 2 * s : M * (p * integer_power(s, p - 1) + 2 * kappa * s);
    }
    auto f2(auto eta) const { return p * (p - 1) * integer_power(root(eta) / M, p - 2) + 2 * kappa; }
    double half_slope(double f) const {  // kappa left out
        if (is_square) return std::sqrt(f);
        return 0.5 * M * p * std::pow(std::max(f, 0.0) / (M * M), (p - 1.0) / p);
    }
};

// body(density) for the one that the parameters name.
template <class Body>
auto with_density(const DistortionParams& params, const Body& body) {
    const auto& [p, M, kappa] = params.power;
    if (params.objective == Objective::tangled) return body(Power{Tangled(), false});
    if (params.objective == Objective::size_shape) return body(Power{ShapeAndSize(), true, p, M, kappa});
    return body(Power{Shape(), params.objective != Objective::squared, p, M, kappa});
}

// df/dF. F must have finite distortion.
template <int n, class T = double, class Density>
Mat<n, T> density_gradient(const Mat<n, T>& F, double delta, Density density) {
    const Measure measure = measure_of(density);
    const T S = squared_stretch<n>(F, measure);
    const auto [r, r1, r2] = measure.derivatives<n>(determinant(F), delta);
    const T f1 = density.f1(S * r), along_F = 2 * f1 * r, along_C = f1 * S * r1;
    const Mat<n, T> C = cofactor(F);
    Mat<n, T> P;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) P[i][j] = along_F * F[i][j] + along_C * C[i][j];
    return P;
}

}  // namespace almesh
