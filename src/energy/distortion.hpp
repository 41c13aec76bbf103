// The point-wise shape distortion of a map with Jacobian F = D phi (paper, Eqs. 1-3) and the energy densities made
// of it, with first derivatives with respect to F; second ones are in density_hessian.hpp.
//
//     eta(F) = |F|^2 / (n sigma_delta^{2/n}),   sigma_delta = (sigma + sqrt(sigma^2 + 4 delta^2)) / 2,  sigma = det F
//
// eta is 1 for a rotation times a scaling and grows without bound towards sigma = 0; with delta = 0 it is infinite
// for sigma <= 0. The densities are eta^2 (the objective of the paper's tables) and (eta - 1)^2 (Eq. 5).
// T is double or Lanes: the same formulas for one point or for one in each lane.
#pragma once
#include <limits>

#include "base/lanes.hpp"
#include "base/small_matrix.hpp"

namespace almesh {

enum class Objective { squared, deviation };  // integral of eta^2, integral of (eta - 1)^2

// r(D) = sigma_delta(D)^{-2/n} / n, so that eta = |F|^2 r, with derivatives with respect to D = det F.
template <class T>
struct DeterminantFactor {
    T r, r1, r2;
};

template <int n, class T>
T determinant_factor_value(T D, double delta) {
    const T w = sqrt(D * D + 4 * delta * delta);
    const T sigma = select(D > 0, 0.5 * (D + w), 2 * delta * delta / (w - D));  // the same without cancellation
    if constexpr (n == 2) return 0.5 / sigma;
    const T root = inverse_cbrt(sigma);
    return (1.0 / 3) * root * root;
}

template <int n, class T>
DeterminantFactor<T> determinant_factor(T D, double delta) {
    const T w = sqrt(D * D + 4 * delta * delta), over_w = 1 / w;
    const T r = determinant_factor_value<n>(D, delta);
    const T r1 = -2.0 / n * r * over_w;
    return {r, r1, -2.0 / n * over_w * (r1 - r * D * over_w * over_w)};
}

// eta(F); infinite where delta = 0 and det F is not positive (nan included).
template <int n, class T = double>
T distortion(const Mat<n, T>& F, double delta) {
    const T D = determinant(F), eta = frobenius_squared<n>(F) * determinant_factor_value<n>(D, delta);
    if (delta > 0) return eta;
    return select(D > 0, eta, T{} + std::numeric_limits<double>::infinity());
}

template <class T>
T density(T eta, Objective objective) {
    const T t = objective == Objective::squared ? eta : eta - 1;
    return t * t;
}

// f'(eta); f'' = 2 for both objectives.
template <class T>
T density_derivative(T eta, Objective objective) {
    return 2 * (objective == Objective::squared ? eta : eta - 1);
}

// df/dF. F must have finite distortion.
template <int n, class T = double>
Mat<n, T> density_gradient(const Mat<n, T>& F, double delta, Objective objective) {
    const T S = frobenius_squared<n>(F);
    const auto [r, r1, r2] = determinant_factor<n>(determinant(F), delta);
    const T f1 = density_derivative(S * r, objective), along_F = 2 * f1 * r, along_C = f1 * S * r1;
    const Mat<n, T> C = cofactor(F);
    Mat<n, T> P;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) P[i][j] = along_F * F[i][j] + along_C * C[i][j];
    return P;
}

}  // namespace almesh
