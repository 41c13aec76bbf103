// The point-wise shape distortion of a map with Jacobian F = D phi (paper, Eqs. 1-3) and the energy densities made
// of it, with first and second derivatives with respect to F.
//
//     eta(F) = |F|^2 / (n sigma_delta^{2/n}),   sigma_delta = (sigma + sqrt(sigma^2 + 4 delta^2)) / 2,  sigma = det F
//
// eta is 1 for a rotation times a scaling and grows without bound towards sigma = 0; with delta = 0 it is infinite
// for sigma <= 0. The densities are eta^2 (the objective of the paper's tables) and (eta - 1)^2 (Eq. 5).
//
// Second derivatives come from the singular values: with F = U diag(s) V^T, U and V rotations (s_n takes the sign of
// det F), S = |F|^2 and D = det F, any density f(eta) with eta = S r(D) is diagonalised in the frame U, V by
//     flip modes   (u_i v_j^T + u_j v_i^T)/sqrt 2:  f' (2 r - S r' K_ij)     K_ij = product of s_k, k not i or j
//     twist modes  (u_i v_j^T - u_j v_i^T)/sqrt 2:  f' (2 r + S r' K_ij)
//     scaling modes u_i v_i^T: the n x n matrix  f'' eta_i eta_j + f' eta_ij
// (Smith, de Goes, Kim, "Analytic eigensystems for isotropic distortion energies", ACM TOG 38, 2019, written without
// divisions by s_i - s_j). So the n*n eigenvalues and eigenvectors of the Hessian are known in closed form but for the
// small scaling matrix; with the negative eigenvalues dropped it is the projected, positive semidefinite one.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/small_matrix.hpp"

namespace almesh {

enum class Objective { squared, deviation };  // integral of eta^2, integral of (eta - 1)^2

template <int n>
struct SingularValues {
    Mat<n> U, V;  // rotations, columns are the singular vectors
    Vec<n> s;     // s_n < 0 where det F < 0
};

SingularValues<2> singular_values(const Mat<2>& F);
SingularValues<3> singular_values(const Mat<3>& F);

// r(D) = sigma_delta(D)^{-2/n} / n, so that eta = |F|^2 r, with derivatives with respect to D = det F.
template <int n>
struct DeterminantFactor {
    double r, r1, r2;
};

template <int n>
double determinant_factor_value(double D, double delta) {
    const double w = std::sqrt(D * D + 4 * delta * delta);
    const double sigma = D > 0 ? 0.5 * (D + w) : 2 * delta * delta / (w - D);  // the same without cancellation
    if constexpr (n == 2) return 1 / (2 * sigma);
    const double root = std::cbrt(sigma);
    return 1 / (3 * root * root);
}

template <int n>
DeterminantFactor<n> determinant_factor(double D, double delta) {
    const double w = std::sqrt(D * D + 4 * delta * delta);
    const double r = determinant_factor_value<n>(D, delta);
    const double r1 = -2.0 / n * r / w;
    return {r, r1, -2.0 / n * (r1 / w - r * D / (w * w * w))};
}

// eta(F); infinite where delta = 0 and det F is not positive (nan included).
template <int n>
double distortion(const Mat<n>& F, double delta) {
    const double D = determinant(F);
    if (!(D > 0) && !(delta > 0)) return std::numeric_limits<double>::infinity();
    return frobenius_squared<n>(F) * determinant_factor_value<n>(D, delta);
}

inline double density(double eta, Objective objective) {
    const double t = objective == Objective::squared ? eta : eta - 1;
    return t * t;
}

// f'(eta); f'' = 2 for both objectives.
inline double density_derivative(double eta, Objective objective) {
    return 2 * (objective == Objective::squared ? eta : eta - 1);
}

// df/dF. F must have finite distortion.
template <int n>
Mat<n> density_gradient(const Mat<n>& F, double delta, Objective objective) {
    const double S = frobenius_squared<n>(F);
    const auto [r, r1, r2] = determinant_factor<n>(determinant(F), delta);
    const double f1 = density_derivative(S * r, objective);
    const Mat<n> C = cofactor(F);
    Mat<n> P;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) P[i][j] = f1 * (2 * r * F[i][j] + S * r1 * C[i][j]);
    return P;
}

// Spectral form of the density's Hessian: d2f / dF_ij dF_kl = sum over m of value[m] mode[m]_ij mode[m]_kl, with
// orthonormal modes.
template <int n>
struct DensityHessian {
    std::array<double, n * n> value;
    std::array<Mat<n>, n * n> mode;
};

// F must have finite distortion.
template <int n>
DensityHessian<n> density_hessian(const Mat<n>& F, double delta, Objective objective);

}  // namespace almesh
