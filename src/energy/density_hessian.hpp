// Second derivatives of the energy densities f(eta(F)) in closed form, one point per lane.
//
// With F = U diag(s) V^T, S = |F|^2, D = det F and eta = S r(D), the Hessian of any density f(eta) is nearly diagonal
// in the basis u_i v_j^T (Smith, de Goes, Kim, "Analytic eigensystems for isotropic distortion energies", ACM TOG 38,
// 2019, written without divisions by s_i - s_j):
//     flip modes   (u_i v_j^T + u_j v_i^T)/sqrt 2:  f' (2 r - S r' K_ij)     K_ij = product of s_k, k not i or j
//     twist modes  (u_i v_j^T - u_j v_i^T)/sqrt 2:  f' (2 r + S r' K_ij)
//     scaling modes u_i v_i^T: the n x n matrix  f'' eta_i eta_j + f' eta_ij
// So projecting it to its positive semidefinite part costs no eigensolver but for the scaling matrix, and turning it
// into the coordinates of the element costs less than forming it from F would.
#pragma once
#include "energy/densities.hpp"
#include "energy/spectra.hpp"

namespace almesh {

// d2f / dJ_ak dJ_bl in tensor[k][l][a][b].
template <int n>
using Tensor = Mat<n, Mat<n, Lanes>>;

// The Hessian H in the frame U, V: H[u_i v_i^T, u_j v_j^T] = scaling_ij, H[u_i v_j^T, u_i v_j^T] = mixed_ij,
// H[u_i v_j^T, u_j v_i^T] = crossed_ij (i not j); all other entries are zero.
template <int n>
struct FrameHessian {
    Mat<n, Lanes> U, V, scaling, mixed, crossed;
};

// F must have finite distortion. projected: without the part that is not positive semidefinite.
template <int n, class Density>
FrameHessian<n> frame_hessian(const Mat<n, Lanes>& F, const Density& density, double delta, bool projected) {
    FrameHessian<n> H;
    const SingularValues<n> svd = singular_values(F);
    H.U = svd.U;
    H.V = svd.V;
    const Vec<n, Lanes>& s = svd.s;
    const Lanes S = frobenius_squared<n>(F);
    const auto [r, r1, r2] = Density::Measure::template derivatives<n>(determinant(F), delta);
    const Lanes f1 = density.f1(S * r), f2 = density.f2(S * r), Sr1 = S * r1;
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
    if (projected) H.scaling = positive_part(H.scaling);
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j) {
            const Lanes K = Sr1 * product_without(i, j);
            Lanes flip = f1 * (2 * r - K), twist = f1 * (2 * r + K);
            if (projected) {
                flip = max(flip, Lanes{});
                twist = max(twist, Lanes{});
            }
            H.mixed[i][j] = H.mixed[j][i] = 0.5 * (flip + twist);
            H.crossed[i][j] = H.crossed[j][i] = 0.5 * (flip - twist);
        }
    return H;
}

// The same with respect to J = F A: u_i v_j^T becomes u_i w_j^T with W = A^{-1} V. Times `weight`.
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

}  // namespace almesh
