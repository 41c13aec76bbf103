// W(F) = eta^2 of a triangle with its derivatives, as lesson 2 derives them: what lesson 3 assembles.
#pragma once
#include "energy/densities.hpp"

namespace almesh::lessons {

inline double W(const Mat<2>& F) { return distortion<2>(F, 0) * distortion<2>(F, 0); }

// W_F = 2 eta eta_F.
inline Mat<2> W_F(const Mat<2>& F) { return density_gradient<2>(F, 0, Power{Shape(), false}); }

// W_FF H = 2 (eta_F : H) eta_F + 2 eta eta_FF H.
inline Mat<2> W_FF(const Mat<2>& F, const Mat<2>& H) {
    const auto product = [](const Mat<2>& A, const Mat<2>& B) {
        return A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[1][0] * B[1][0] + A[1][1] * B[1][1];
    };
    const Mat<2> C = cofactor(F), C_H = cofactor(H);
    const double D = determinant(F), S = product(F, F), D_H = product(C, H), S_H = 2 * product(F, H);
    const double eta = S / (2 * D), r = 1 / (2 * D), r1 = -1 / (2 * D * D), r2 = 1 / (D * D * D);
    const double eta_H = S_H * r + S * r1 * D_H;
    Mat<2> Q;
    for (int a = 0; a < 2; ++a)
        for (int k = 0; k < 2; ++k) {
            const double eta_F = 2 * r * F[a][k] + S * r1 * C[a][k];
            const double eta_FF =
                2 * r * H[a][k] + 2 * r1 * D_H * F[a][k] + (S_H * r1 + S * r2 * D_H) * C[a][k] + S * r1 * C_H[a][k];
            Q[a][k] = 2 * eta_H * eta_F + 2 * eta * eta_FF;
        }
    return Q;
}

}  // namespace almesh::lessons
