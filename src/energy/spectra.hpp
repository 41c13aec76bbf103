// Singular values of 2x2 and 3x3 matrices, and symmetric ones with filtered negative eigenvalues, one matrix per lane.
// Closed forms in 2D, without angles; Jacobi's rotations in 3D, all lanes in step until none needs one more;
// one that needs none stays as it is, so that its bits do not depend on its neighbours.
#pragma once
#include "base/lanes.hpp"
#include "base/small_matrix.hpp"

namespace almesh {

// F = U diag(s) V^T.
template <int n>
struct SingularValues {
    Mat<n, Lanes> U, V;  // rotations, columns are the singular vectors
    Vec<n, Lanes> s;     // s_n < 0 where det F < 0
};

inline constexpr double tiny = 1e-300;  // keeps 0 / 0 at 0

struct Rotation {
    Lanes c, s;  // cosine and sine: p' = c p - s q, q' = s p + c q

    Rotation where(LaneBits turns) const { return {select(turns, c, in_all_lanes(1)), select(turns, s, Lanes{})}; }
};

// Makes the 2x2 matrix (app apq; apq aqq) diagonal by an angle of at most 45 degrees (Golub & Van Loan, Matrix
// Computations, sec. 8.5).
inline Rotation jacobi_rotation(Lanes app, Lanes apq, Lanes aqq) {
    const Lanes difference = aqq - app, twice = select(difference < 0, -2 * apq, 2 * apq);
    const Lanes tangent = twice / (abs(difference) + sqrt(difference * difference + twice * twice) + tiny);
    const Lanes cosine = 1 / sqrt(1 + tangent * tangent);
    return {cosine, cosine * tangent};
}

template <int n>
void rotate_columns(const Rotation& rotation, int p, int q, Mat<n, Lanes>& A) {
    for (int i = 0; i < n; ++i) {
        const Lanes ap = A[i][p], aq = A[i][q];
        A[i][p] = rotation.c * ap - rotation.s * aq;
        A[i][q] = rotation.s * ap + rotation.c * aq;
    }
}

template <int n>
Lanes column_product(const Mat<n, Lanes>& A, int p, int q) {
    Lanes sum = A[0][p] * A[0][q];
    for (int i = 1; i < n; ++i) sum += A[i][p] * A[i][q];
    return sum;
}

// F = Q rotation(alpha) + R reflection(beta), its conformal and anticonformal parts, has the singular values Q + R and
// Q - R and the frames rotation((alpha + beta) / 2) and rotation((beta - alpha) / 2): with a, b, u unit complex numbers
// for alpha, beta and the left frame, u = sqrt(a b), and the right one is b / u. Either root will do.
inline SingularValues<2> singular_values(const Mat<2, Lanes>& F) {
    const Lanes a_re = 0.5 * (F[0][0] + F[1][1]), a_im = 0.5 * (F[1][0] - F[0][1]);
    const Lanes b_re = 0.5 * (F[0][0] - F[1][1]), b_im = 0.5 * (F[1][0] + F[0][1]);
    const Lanes Q = sqrt(a_re * a_re + a_im * a_im), R = sqrt(b_re * b_re + b_im * b_im);
    // The angle of a part that vanishes is free: 0.
    const Lanes over_Q = 1 / (Q + tiny), over_R = 1 / (R + tiny), one = in_all_lanes(1);
    const Lanes a0 = select(Q > 0, a_re * over_Q, one), a1 = a_im * over_Q;
    const Lanes b0 = select(R > 0, b_re * over_R, one), b1 = b_im * over_R;
    // Half of an angle from its cosine x and sine y, by the formula that does not cancel.
    const Lanes x = a0 * b0 - a1 * b1, y = a0 * b1 + a1 * b0;
    const Lanes large = sqrt(0.5 * (1 + abs(x))), small = 0.5 * y / large;
    const Lanes u0 = select(x < 0, small, large), u1 = select(x < 0, large, small);
    const Lanes v0 = b0 * u0 + b1 * u1, v1 = b1 * u0 - b0 * u1;
    const Lanes s = Q + R;
    return {{{{u0, -u1}, {u1, u0}}}, {{{v0, -v1}, {v1, v0}}}, {s, determinant(F) / (s + tiny)}};
}

// Exchanges columns p and q where asked for, with the sign that keeps a rotation a rotation.
inline void exchange_columns(LaneBits where, int p, int q, Mat<3, Lanes>& A) {
    for (int i = 0; i < 3; ++i) {
        const Lanes ap = A[i][p], aq = A[i][q];
        A[i][p] = select(where, aq, ap);
        A[i][q] = select(where, -ap, aq);
    }
}

// v / length; `otherwise` where the length is zero.
inline Vec<3, Lanes> unit_vector(const Vec<3, Lanes>& v, Lanes length, const Vec<3, Lanes>& otherwise) {
    const Lanes factor = 1 / (length + tiny);
    Vec<3, Lanes> u;
    for (int i = 0; i < 3; ++i) u[i] = select(length > 0, v[i] * factor, otherwise[i]);
    return u;
}

// A unit vector orthogonal to the unit vector u: from its two larger components, or the first two of equal ones.
inline Vec<3, Lanes> orthogonal_to(const Vec<3, Lanes>& u) {
    const LaneBits flat = abs(u[2]) < 0.6;
    const Lanes a = select(flat, u[1], u[2]), factor = 1 / sqrt(u[0] * u[0] + a * a + tiny);
    const LaneBits usable = u[0] * u[0] + a * a > 0;
    const Lanes first = select(usable, -a * factor, in_all_lanes(1)), second = u[0] * factor;
    return {first, select(flat, second, Lanes{}), select(flat, Lanes{}, second)};
}

// One-sided Jacobi (Hestenes): rotations from the right make the columns of B = F V orthogonal; their lengths are the
// singular values. The last left vector is the cross product of the others, so U is a rotation.
inline SingularValues<3> singular_values(const Mat<3, Lanes>& F) {
    constexpr int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}}, most_sweeps = 30;
    constexpr double orthogonal = 1e-30;  // squared cosine
    const Lanes one = in_all_lanes(1), zero = {};
    Mat<3, Lanes> B = F, V = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
    LaneBits at_work = zero == zero;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        LaneBits rotated = {};
        for (const auto& [p, q] : pairs) {
            const Lanes a = column_product<3>(B, p, p), b = column_product<3>(B, q, q), c = column_product<3>(B, p, q);
            rotated |= c * c > orthogonal * a * b;
            const Rotation rotation = jacobi_rotation(a, c, b).where(at_work);
            rotate_columns<3>(rotation, p, q, B);
            rotate_columns<3>(rotation, p, q, V);
        }
        at_work &= rotated;
        if (!any(at_work)) break;
    }
    Vec<3, Lanes> squared;
    for (int j = 0; j < 3; ++j) squared[j] = column_product<3>(B, j, j);
    for (const auto& [p, q] : {std::array{0, 1}, std::array{1, 2}, std::array{0, 1}}) {  // largest first
        const LaneBits where = squared[p] < squared[q];
        exchange_columns(where, p, q, B);
        exchange_columns(where, p, q, V);
        const Lanes sp = squared[p], sq = squared[q];
        squared[p] = select(where, sq, sp);
        squared[q] = select(where, sp, sq);
    }
    const Lanes s0 = sqrt(squared[0]), s1 = sqrt(squared[1]);
    const Vec<3, Lanes> u0 = unit_vector({B[0][0], B[1][0], B[2][0]}, s0, {one, zero, zero});
    const Vec<3, Lanes> u1 = unit_vector({B[0][1], B[1][1], B[2][1]}, s1, orthogonal_to(u0)), u2 = cross(u0, u1);
    return {{{{u0[0], u1[0], u2[0]}, {u0[1], u1[1], u2[1]}, {u0[2], u1[2], u2[2]}}},
            V,
            {s0, s1, u2[0] * B[0][2] + u2[1] * B[1][2] + u2[2] * B[2][2]}};
}

// part: in [0, 1].
inline Lanes filtered(Lanes eigenvalue, double part) { return max(eigenvalue, part * eigenvalue); }

// The symmetric matrix A with its negative eigenvalues times `part`: with 0 its positive semidefinite part.
inline Mat<2, Lanes> filtered(const Mat<2, Lanes>& A, double part) {
    // A = mean I + R, R without trace and with eigenvalues +-radius: of A mean +- radius.
    const Lanes mean = 0.5 * (A[0][0] + A[1][1]), half = 0.5 * (A[0][0] - A[1][1]), off = A[0][1];
    const Lanes radius = sqrt(half * half + off * off);
    const Lanes larger = filtered(mean + radius, part), smaller = filtered(mean - radius, part);
    const Lanes middle = 0.5 * (larger + smaller), along = 0.5 * (larger - smaller) / (radius + tiny);
    return {{{middle + along * half, along * off}, {along * off, middle - along * half}}};
}

inline Mat<3, Lanes> filtered(Mat<3, Lanes> A, double part) {
    const Lanes minor = A[0][0] * A[1][1] - A[0][1] * A[0][1];
    // Most often there is nothing to do: all leading minors are positive.
    const LaneBits is_positive = (A[0][0] > 0) & (minor > 0) & (determinant(A) > 0);
    if (!any(!is_positive)) return A;
    const Mat<3, Lanes> given = A;

    constexpr int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}}, most_sweeps = 30;
    constexpr double diagonal = 1e-32;  // squared sum off the diagonal over that on it
    const Lanes one = in_all_lanes(1), zero = {};
    Mat<3, Lanes> Q = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}};
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        const Lanes on = A[0][0] * A[0][0] + A[1][1] * A[1][1] + A[2][2] * A[2][2];
        const Lanes off = A[0][1] * A[0][1] + A[0][2] * A[0][2] + A[1][2] * A[1][2];
        const LaneBits at_work = off > diagonal * on;
        if (!any(at_work)) break;
        for (const auto& [p, q] : pairs) {
            const int r = 3 - p - q;
            const Rotation rotation = jacobi_rotation(A[p][p], A[p][q], A[q][q]).where(at_work);
            rotate_columns<3>(rotation, p, q, A);
            const Lanes app = rotation.c * A[p][p] - rotation.s * A[q][p];
            A[q][q] = rotation.s * A[p][q] + rotation.c * A[q][q];
            A[p][p] = app;
            A[p][q] = A[q][p] = zero;
            A[p][r] = A[r][p];
            A[q][r] = A[r][q];
            rotate_columns<3>(rotation, p, q, Q);
        }
    }
    Mat<3, Lanes> result{};
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) result[i][j] += filtered(A[k][k], part) * Q[i][k] * Q[j][k];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) result[i][j] = select(is_positive, given[i][j], result[i][j]);
    return result;
}

}  // namespace almesh
