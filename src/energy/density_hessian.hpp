// Second derivatives of the energy densities f(eta(F)) with respect to J = F A in closed form, one point per lane.
//
// With S = |F|^2, D = det F and eta = S r(D), the chain rule gives the full Hessian
//
//     f'' eta_J eta_J^T + f' (r S_JJ + r' (S_J D_J^T + D_J S_J^T) + S r'' D_J D_J^T + S r' D_JJ),
//
// with S_JJ = 2 A^{-1} A^{-T} for each row of J, and the entries of J with signs in D_JJ. Its eigenvalues, of which
// negative ones are made smaller or zero, need a frame: with F = U diag(s) V^T the Hessian by F is nearly diagonal in
// the basis u_i v_j^T (Smith, de Goes, Kim, "Analytic eigensystems for isotropic distortion energies", ACM TOG 38,
// 2019, written without divisions by s_i - s_j):
//     flip modes   (u_i v_j^T + u_j v_i^T)/sqrt 2:  f' (2 r - S r' K_ij)     K_ij = product of s_k, k not i or j
//     twist modes  (u_i v_j^T - u_j v_i^T)/sqrt 2:  f' (2 r + S r' K_ij)
//     scaling modes u_i v_i^T: the n x n matrix  f'' eta_i eta_j + f' eta_ij
// So only the scaling matrix needs an eigensolver. The singular values are what costs: several times the full Hessian.
#pragma once
#include "energy/densities.hpp"
#include "energy/spectra.hpp"

namespace almesh {

// share f + (1 - share) eta^2: the objective with its damping (distortion_energy.hpp). Of a square it is one again,
// (eta - shift)^2 up to a constant.
template <class Density>
struct Damped {
    Density of;
    Lanes share;
    Measure measure = measure_of(of);
    Lanes f1(Lanes eta) const {
        if constexpr (requires { of.is_square; })
            if (of.is_square) return 2 * (eta - (of.from_one ? share : Lanes{}));
        return 2 * eta + share * (of.f1(eta) - 2 * eta);
    }
    Lanes f2(Lanes eta) const { return 2 + share * (of.f2(eta) - 2); }
};

template <class Density>
Damped<Density> damped(Density density, Lanes share) {
    return {density, share};
}

// d2f / dJ_ak dJ_bl in tensor[k][l][a][b].
template <int n>
using Tensor = Mat<n, Mat<n, Lanes>>;

// The full Hessian with respect to J = F A, F = J ideal_inverse, times `weight`. F must have finite distortion.
template <int n, class Density>
Tensor<n> full_hessian(const Mat<n, Lanes>& J, const Mat<n, Lanes>& ideal_inverse, Lanes weight,
                       const Density& density, double delta) {
    const Mat<n, Lanes> F = multiply<n>(J, ideal_inverse), transposed = transpose<n>(ideal_inverse);
    const Measure measure = measure_of(density);
    const Lanes S = squared_stretch<n>(F, measure);
    const auto [r, r1, r2] = measure.derivatives<n>(determinant(F), delta);
    const Lanes f1 = weight * density.f1(S * r), f2 = weight * density.f2(S * r), Sr1 = S * r1;
    const Mat<n, Lanes> D_J = multiply<n>(cofactor(F), transposed), metric = multiply<n>(ideal_inverse, transposed);
    Mat<n, Lanes> S_J = multiply<n>(F, transposed);
    for (auto& row : S_J)
        for (Lanes& entry : row) entry *= 2;
    // Of S_J S_J^T, S_J D_J^T + D_J S_J^T, D_J D_J^T; of the metric and D_JJ.
    const Lanes SS = f2 * r * r, SD = (f2 * Sr1 * r) + f1 * r1, DD = f2 * Sr1 * Sr1 + f1 * S * r2;
    const Lanes along = 2 * f1 * r, across = f1 * Sr1 * determinant(ideal_inverse);
    // d2D / dJ_ak dJ_bl = +-det A^{-1} J_cm, c and m the third indices, in 2D 1 for J_cm.
    const auto D_JJ = [&](int k, int l, int a, int b) {
        if constexpr (n == 2) return a < b ? across : -across;
        else return (b == (a + 1) % 3) == (l == (k + 1) % 3) ? across * J[3 - a - b][3 - k - l]
                                                             : -across * J[3 - a - b][3 - k - l];
    };
    Tensor<n> C;
    for (int l = 0; l < n; ++l)
        for (int b = 0; b < n; ++b) {
            const Lanes of_S = SS * S_J[b][l] + SD * D_J[b][l], of_D = SD * S_J[b][l] + DD * D_J[b][l];
            for (int k = 0; k <= l; ++k)
                for (int a = 0; a < (k == l ? b + 1 : n); ++a) {
                    Lanes entry = S_J[a][k] * of_S + D_J[a][k] * of_D;
                    if (a == b) entry += along * metric[k][l];
                    else if (k != l) entry += D_JJ(k, l, a, b);
                    C[k][l][a][b] = C[l][k][b][a] = entry;
                }
        }
    return C;
}

// A Hessian by F in the frame U, V: H[u_i v_i^T, u_j v_j^T] = scaling_ij, H[u_i v_j^T, u_i v_j^T] = mixed_ij,
// H[u_i v_j^T, u_j v_i^T] = crossed_ij (i not j); all other entries are zero.
template <int n>
struct FrameHessian {
    Mat<n, Lanes> U, V, scaling, mixed, crossed;
};

// The Hessian by F, its negative eigenvalues times kept_negative. F must have finite distortion.
template <int n, class Density>
FrameHessian<n> projected_in_frame(const Mat<n, Lanes>& F, const Density& density, double delta,
                                   double kept_negative) {
    FrameHessian<n> H;
    const SingularValues<n> svd = singular_values(F);
    H.U = svd.U;
    H.V = svd.V;
    const Vec<n, Lanes>& s = svd.s;
    const Measure measure = measure_of(density);
    const Lanes S = squared_stretch<n>(F, measure);
    const auto [r, r1, r2] = measure.derivatives<n>(determinant(F), delta);
    const Lanes f1 = density.f1(S * r), Sr1 = S * r1;
    const auto f2 = density.f2(S * r);
    const auto product_without = [&s](int i, int j) { return n == 2 ? in_all_lanes(1) : s[3 - i - j]; };  // i not j

    Vec<n, Lanes> D_i, eta_i;  // first derivatives with respect to the singular values
    for (int i = 0; i < n; ++i) {
        D_i[i] = n == 2 ? s[1 - i] : s[(i + 1) % n] * s[(i + 2) % n];
        eta_i[i] = 2 * s[i] * r + Sr1 * D_i[i];
    }
    for (int i = 0; i < n; ++i)
        for (int j = i; j < n; ++j) {
            Lanes eta_ij = 2 * r1 * (s[i] * D_i[j] + s[j] * D_i[i]) + S * r2 * D_i[i] * D_i[j];
            eta_ij += i == j ? 2 * r : Sr1 * product_without(i, j);
            H.scaling[i][j] = H.scaling[j][i] = f2 * eta_i[i] * eta_i[j] + f1 * eta_ij;
        }
    H.scaling = filtered(H.scaling, kept_negative);
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j) {
            const Lanes K = Sr1 * product_without(i, j);
            const Lanes flip = filtered(f1 * (2 * r - K), kept_negative);
            const Lanes twist = filtered(f1 * (2 * r + K), kept_negative);
            H.mixed[i][j] = H.mixed[j][i] = 0.5 * (flip + twist);
            H.crossed[i][j] = H.crossed[j][i] = 0.5 * (flip - twist);
        }
    return H;
}

// The same Hessian with respect to J = F A: u_i v_j^T becomes u_i w_j^T with W = A^{-1} V. Times `weight`.
template <int n>
Tensor<n> in_element_coordinates(const FrameHessian<n>& H, const Mat<n, Lanes>& ideal_inverse, Lanes weight) {
    const Mat<n, Lanes> W = multiply<n>(ideal_inverse, H.V), transposed = transpose<n>(H.U);
    Tensor<n> C;
    for (int k = 0; k < n; ++k)
        for (int l = k; l < n; ++l) {
            Mat<n, Lanes> Z;  // in the frame U
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    Z[i][j] = H.scaling[i][j] * (W[k][i] * W[l][j]);
                    if (i != j) Z[i][j] += H.crossed[i][j] * (W[k][j] * W[l][i]);
                }
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j)
                    if (i != j) Z[i][i] += H.mixed[i][j] * (W[k][j] * W[l][j]);
            for (auto& row : Z)
                for (Lanes& z : row) z *= weight;
            C[k][l] = multiply<n>(multiply<n>(H.U, Z), transposed);
            if (l > k) C[l][k] = transpose<n>(C[k][l]);
        }
    return C;
}

// The Hessian with respect to J = F A, times `weight`. kept_negative: by which its negative eigenvalues with respect to
// F are multiplied: 1 for the full Hessian, 0 for its positive semidefinite part.
template <int n, class Density>
Tensor<n> density_hessian(const Mat<n, Lanes>& J, const Mat<n, Lanes>& ideal_inverse, Lanes weight,
                          const Density& density, double delta, double kept_negative) {
    if (kept_negative == 1) return full_hessian<n>(J, ideal_inverse, weight, density, delta);
    const Mat<n, Lanes> F = multiply<n>(J, ideal_inverse);
    return in_element_coordinates<n>(projected_in_frame<n>(F, density, delta, kept_negative), ideal_inverse, weight);
}

}  // namespace almesh
