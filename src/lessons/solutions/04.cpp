// Solutions of the exercises of lesson 4.
#include <algorithm>
#include <cmath>

#include "lessons/exercises/04.hpp"

namespace almesh::lessons {

double order_of_convergence(const std::vector<double>& size) {
    const double* const last = &size.back();
    return std::log(last[0] / last[-1]) / std::log(last[-1] / last[-2]);
}

double first_inversion(const std::array<Vec<2>, 3>& x, const std::array<Vec<2>, 3>& d) {
    const auto cross = [](const Vec<2>& u, const Vec<2>& v) { return u[0] * v[1] - u[1] * v[0]; };
    const auto edge = [](const auto& p, int k) { return Vec<2>{p[k][0] - p[0][0], p[k][1] - p[0][1]}; };
    // Twice the area is c + b t + a t^2.
    const double c = cross(edge(x, 1), edge(x, 2)), a = cross(edge(d, 1), edge(d, 2));
    const double b = cross(edge(x, 1), edge(d, 2)) + cross(edge(d, 1), edge(x, 2)), discriminant = b * b - 4 * a * c;
    if (discriminant < 0) return INFINITY;
    const double root = std::sqrt(discriminant);
    if (b < 0) return 2 * c / (root - b);  // no difference of numbers that are nearly equal
    return a < 0 ? -(b + root) / (2 * a) : INFINITY;
}

Mat<2> positive_part(const Mat<2>& A) {
    const double mean = (A[0][0] + A[1][1]) / 2, half = (A[0][0] - A[1][1]) / 2, radius = std::hypot(half, A[0][1]);
    const double larger = std::max(mean + radius, 0.0), smaller = std::max(mean - radius, 0.0);
    if (radius == 0) return {{{larger, 0}, {0, larger}}};
    // A = mean I + radius R with R R = I, so (I + R) / 2 and (I - R) / 2 project onto the eigenvectors.
    const double sum = (larger + smaller) / 2, difference = (larger - smaller) / 2;
    const double c = half / radius, s = A[0][1] / radius;
    return {{{sum + difference * c, difference * s}, {difference * s, sum - difference * c}}};
}

void fix_nodes(BlockCsr& H, std::vector<double>& g, const std::vector<char>& fixed) {
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            const int j = H.col[k];
            if (!fixed[i] && !fixed[j]) continue;
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) H.block(k)[2 * a + b] = i == j && a == b;
        }
    for (int i = 0; i < H.n; ++i)
        if (fixed[i]) g[2 * i] = g[2 * i + 1] = 0;
}

double minimise(const std::function<double(double)>& f, const std::function<double(double)>& f1,
                const std::function<double(double)>& f2, double x) {
    while (std::abs(f1(x)) > 1e-7) {
        const double curvature = std::abs(f2(x)), d = -f1(x) / (curvature > 0 ? curvature : 1);
        const double start = f(x), slope = f1(x) * d;
        double t = 1;
        while (!(f(x + t * d) <= start + 1e-4 * t * slope)) t /= 2;  // true of nan too
        x += t * d;
    }
    return x;
}

namespace {

struct Stretches {
    double s1, s2;  // s1 >= s2
    Mat<2> U, V;    // F = U diag(s1, s2) V'
};

// F is a matrix (a, -b; b, a), which turns and scales, plus a matrix (c, d; d, -c), which reflects and scales.
Stretches singular_values(const Mat<2>& F) {
    const double a = (F[0][0] + F[1][1]) / 2, b = (F[1][0] - F[0][1]) / 2, c = (F[0][0] - F[1][1]) / 2,
                 d = (F[1][0] + F[0][1]) / 2, s1 = std::hypot(a, b) + std::hypot(c, d);
    const double turn = std::atan2(b, a), tilt = std::atan2(d, c), u = (turn + tilt) / 2, v = (tilt - turn) / 2;
    return {s1, determinant(F) / s1, {{{std::cos(u), -std::sin(u)}, {std::sin(u), std::cos(u)}}},
            {{{std::cos(v), -std::sin(v)}, {std::sin(v), std::cos(v)}}}};
}

// The second derivatives of f(eta) by s1 and s2: eta = cosh(x) with x = log(s1 / s2).
Mat<2> by_stretches(double s1, double s2, double f1, double f2) {
    const double cosh = (s1 / s2 + s2 / s1) / 2, sinh = (s1 / s2 - s2 / s1) / 2;
    const double first = f1 * sinh, second = f2 * sinh * sinh + f1 * cosh, mixed = -second / (s1 * s2);
    return {{{(second - first) / (s1 * s1), mixed}, {mixed, (second + first) / (s2 * s2)}}};
}

}  // namespace

std::array<double, 4> curvatures(const Mat<2>& F, double f1, double f2) {
    const auto [s1, s2, U, V] = singular_values(F);
    const Mat<2> A = by_stretches(s1, s2, f1, f2);
    const double D = s1 * s2, eta = (s1 / s2 + s2 / s1) / 2;
    const double larger = (A[0][0] + A[1][1]) / 2 + std::hypot((A[0][0] - A[1][1]) / 2, A[0][1]);
    const double product = -f1 * f1 * (eta * eta - 1) / (D * D);  // det A
    return {-f1 * (eta - 1) / D, f1 * (eta + 1) / D, larger > 0 ? product / larger : 0, larger};
}

std::array<std::array<double, 4>, 4> projected_second(const Mat<2>& F, double f1, double f2) {
    const auto [s1, s2, U, V] = singular_values(F);
    const auto [twist, flip, smaller, larger] = curvatures(F, f1, f2);
    const Mat<2> A = by_stretches(s1, s2, f1, f2);
    const double scale = larger > smaller ? larger / (larger - smaller) : 0;  // A+ = scale (A - smaller I)
    std::array<std::array<double, 4>, 4> W;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const auto of = [&, &u = U, &v = V](int k, int l, int m) { return u[m / 2][k] * v[m % 2][l]; };  // u_k v_l'
            W[i][j] = flip / 2 * (of(0, 1, i) + of(1, 0, i)) * (of(0, 1, j) + of(1, 0, j));
            for (int k = 0; k < 2; ++k)
                for (int l = 0; l < 2; ++l)
                    W[i][j] += scale * (A[k][l] - (k == l ? smaller : 0)) * of(k, k, i) * of(l, l, j);
        }
    return W;
}

}  // namespace almesh::lessons
