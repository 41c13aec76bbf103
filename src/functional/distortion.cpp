#include "functional/distortion.hpp"

#include <numbers>

namespace almesh {
namespace {

// Eigenvalues (ascending order not implied) and eigenvectors (columns of Q) of a symmetric matrix: cyclic Jacobi
// (Golub & Van Loan, Matrix Computations, sec. 8.5).
template <int n>
void jacobi_eigen(Mat<n> A, Vec<n>& lambda, Mat<n>& Q) {
    Q = {};
    for (int i = 0; i < n; ++i) Q[i][i] = 1;
    for (int sweep = 0; sweep < 30; ++sweep) {
        double off = 0, diagonal = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) (i == j ? diagonal : off) += A[i][j] * A[i][j];
        if (off <= 1e-32 * diagonal || off == 0) break;
        for (int p = 0; p < n; ++p)
            for (int q = p + 1; q < n; ++q) {
                if (A[p][q] == 0) continue;
                const double tau = (A[q][q] - A[p][p]) / (2 * A[p][q]);
                const double t = (tau >= 0 ? 1 : -1) / (std::abs(tau) + std::sqrt(1 + tau * tau));
                const double c = 1 / std::sqrt(1 + t * t), s = t * c;
                for (int k = 0; k < n; ++k) {
                    const double akp = A[k][p], akq = A[k][q];
                    A[k][p] = c * akp - s * akq;
                    A[k][q] = s * akp + c * akq;
                }
                for (int k = 0; k < n; ++k) {
                    const double apk = A[p][k], aqk = A[q][k];
                    A[p][k] = c * apk - s * aqk;
                    A[q][k] = s * apk + c * aqk;
                    const double qkp = Q[k][p], qkq = Q[k][q];
                    Q[k][p] = c * qkp - s * qkq;
                    Q[k][q] = s * qkp + c * qkq;
                }
            }
    }
    for (int i = 0; i < n; ++i) lambda[i] = A[i][i];
}

Vec<3> column(const Mat<3>& m, int j) { return {m[0][j], m[1][j], m[2][j]}; }

Vec<3> cross(const Vec<3>& a, const Vec<3>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

void set_column(Mat<3>& m, int j, const Vec<3>& v, double scale) {
    for (int i = 0; i < 3; ++i) m[i][j] = scale * v[i];
}

// A unit vector orthogonal to the unit vector u.
Vec<3> orthogonal_to(const Vec<3>& u) {
    const int small = std::abs(u[0]) < 0.6 ? 0 : (std::abs(u[1]) < 0.6 ? 1 : 2);
    Vec<3> e{};
    e[small] = 1;
    Vec<3> v = cross(u, e);
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (double& c : v) c /= length;
    return v;
}

}  // namespace

// F = rotation(phi) diag(Q + R, Q - R) rotation(theta): the conformal and anticonformal parts of F.
SingularValues<2> singular_values(const Mat<2>& F) {
    const double e = 0.5 * (F[0][0] + F[1][1]), h = 0.5 * (F[1][0] - F[0][1]);
    const double f = 0.5 * (F[0][0] - F[1][1]), g = 0.5 * (F[1][0] + F[0][1]);
    const double Q = std::hypot(e, h), R = std::hypot(f, g);
    const double conformal = std::atan2(h, e), anticonformal = std::atan2(g, f);
    const double phi = 0.5 * (conformal + anticonformal), theta = 0.5 * (conformal - anticonformal);
    SingularValues<2> svd;
    svd.s = {Q + R, Q - R};
    svd.U = {{{std::cos(phi), -std::sin(phi)}, {std::sin(phi), std::cos(phi)}}};
    svd.V = {{{std::cos(theta), std::sin(theta)}, {-std::sin(theta), std::cos(theta)}}};
    return svd;
}

// One-sided Jacobi (Hestenes): rotations from the right make the columns of B = F V orthogonal; their lengths are
// the singular values. The last left vector is the cross product of the others, so U is a rotation.
SingularValues<3> singular_values(const Mat<3>& F) {
    Mat<3> B = F, V{};
    for (int i = 0; i < 3; ++i) V[i][i] = 1;
    for (int sweep = 0; sweep < 30; ++sweep) {
        bool rotated = false;
        for (int p = 0; p < 3; ++p)
            for (int q = p + 1; q < 3; ++q) {
                double a = 0, b = 0, c = 0;
                for (int i = 0; i < 3; ++i) {
                    a += B[i][p] * B[i][p];
                    b += B[i][q] * B[i][q];
                    c += B[i][p] * B[i][q];
                }
                if (c * c <= 1e-32 * a * b) continue;
                rotated = true;
                const double zeta = (b - a) / (2 * c);
                const double t = (zeta >= 0 ? 1 : -1) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
                const double cs = 1 / std::sqrt(1 + t * t), sn = cs * t;
                for (int i = 0; i < 3; ++i) {
                    const double bp = B[i][p], bq = B[i][q], vp = V[i][p], vq = V[i][q];
                    B[i][p] = cs * bp - sn * bq;
                    B[i][q] = sn * bp + cs * bq;
                    V[i][p] = cs * vp - sn * vq;
                    V[i][q] = sn * vp + cs * vq;
                }
            }
        if (!rotated) break;
    }
    std::array<int, 3> order = {0, 1, 2};
    Vec<3> length;
    for (int j = 0; j < 3; ++j) length[j] = std::sqrt(B[0][j] * B[0][j] + B[1][j] * B[1][j] + B[2][j] * B[2][j]);
    std::sort(order.begin(), order.end(), [&](int i, int j) { return length[i] > length[j]; });

    SingularValues<3> svd;
    set_column(svd.V, 0, column(V, order[0]), 1);
    set_column(svd.V, 1, column(V, order[1]), 1);
    set_column(svd.V, 2, cross(column(svd.V, 0), column(svd.V, 1)), 1);
    svd.s[0] = length[order[0]];
    svd.s[1] = length[order[1]];
    if (svd.s[0] > 0) set_column(svd.U, 0, column(B, order[0]), 1 / svd.s[0]);
    else set_column(svd.U, 0, {1, 0, 0}, 1);
    if (svd.s[1] > 1e-300) set_column(svd.U, 1, column(B, order[1]), 1 / svd.s[1]);
    else set_column(svd.U, 1, orthogonal_to(column(svd.U, 0)), 1);
    set_column(svd.U, 2, cross(column(svd.U, 0), column(svd.U, 1)), 1);
    svd.s[2] = 0;  // u_3 . F v_3, with the sign of det F
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) svd.s[2] += svd.U[i][2] * F[i][j] * svd.V[j][2];
    return svd;
}

template <int n>
DensityHessian<n> density_hessian(const Mat<n>& F, double delta, Objective objective) {
    const SingularValues<n> svd = singular_values(F);
    const Vec<n>& s = svd.s;
    double S = 0, D = 1;
    for (double v : s) {
        S += v * v;
        D *= v;
    }
    const auto [r, r1, r2] = determinant_factor<n>(D, delta);
    const double f1 = density_derivative(S * r, objective), f2 = 2;

    const auto product_without = [&s](int i, int j) {
        double K = 1;
        for (int k = 0; k < n; ++k)
            if (k != i && k != j) K *= s[k];
        return K;
    };
    Vec<n> D_i, eta_i;  // first derivatives with respect to the singular values
    for (int i = 0; i < n; ++i) {
        D_i[i] = product_without(i, i);
        eta_i[i] = 2 * s[i] * r + S * r1 * D_i[i];
    }
    Mat<n> scaling;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            double eta_ij = 2 * r1 * (s[i] * D_i[j] + s[j] * D_i[i]) + S * r2 * D_i[i] * D_i[j];
            eta_ij += i == j ? 2 * r : S * r1 * product_without(i, j);
            scaling[i][j] = f2 * eta_i[i] * eta_i[j] + f1 * eta_ij;
        }

    DensityHessian<n> H;
    Vec<n> value;
    Mat<n> Q;
    jacobi_eigen<n>(scaling, value, Q);
    int m = 0;
    for (int k = 0; k < n; ++k, ++m) {  // sum over i of Q_ik u_i v_i^T
        H.value[m] = value[k];
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) {
                H.mode[m][a][b] = 0;
                for (int i = 0; i < n; ++i) H.mode[m][a][b] += Q[i][k] * svd.U[a][i] * svd.V[b][i];
            }
    }
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j, m += 2) {
            const double K = product_without(i, j);
            H.value[m] = f1 * (2 * r - S * r1 * K);
            H.value[m + 1] = f1 * (2 * r + S * r1 * K);
            for (int a = 0; a < n; ++a)
                for (int b = 0; b < n; ++b) {
                    const double ij = svd.U[a][i] * svd.V[b][j], ji = svd.U[a][j] * svd.V[b][i];
                    H.mode[m][a][b] = std::numbers::sqrt2 / 2 * (ij + ji);
                    H.mode[m + 1][a][b] = std::numbers::sqrt2 / 2 * (ij - ji);
                }
        }
    return H;
}

template DensityHessian<2> density_hessian<2>(const Mat<2>&, double, Objective);
template DensityHessian<3> density_hessian<3>(const Mat<3>&, double, Objective);

}  // namespace almesh
