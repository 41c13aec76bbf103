// Solutions of the exercises of lesson 6.
#include "lessons/exercises/06.hpp"

#include <algorithm>
#include <cmath>

namespace almesh::lessons {

double penalised_place(double k_1, double k_2, double g, double mu) {
    const double kappa = k_1 * k_2 / (k_1 + k_2);  // where y is at rest, k_1 y = k_2 (x - y), x feels k_1 y = kappa x
    return mu * g / (kappa + mu);
}

double penalty_for(double kappa, double g, double tolerance) {
    return std::max(0.0, kappa * (std::abs(g) / tolerance - 1));  // |x - g| = kappa |g| / (kappa + mu)
}

double without_penalty_error(double mu_1, double q_1, double mu_2, double q_2) {
    return (mu_2 * q_2 - mu_1 * q_1) / (mu_2 - mu_1);
}

double condition_with_penalty(const Mat<2>& K, const Vec<2>& a, double mu) {
    Mat<2> H = K;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) H[i][j] += mu * a[i] * a[j];
    const double mean = (H[0][0] + H[1][1]) / 2, radius = std::hypot((H[0][0] - H[1][1]) / 2, H[0][1]);
    const double large = mean + radius;
    // det H = det K + mu a' adj(K) a and large times small: no difference of large numbers.
    const double det =
        determinant(K) + mu * (K[1][1] * a[0] * a[0] - 2 * K[0][1] * a[0] * a[1] + K[0][0] * a[1] * a[1]);
    return large * large / det;
}

Penalised penalised_minimum(const Constrained& problem, double mu, Vec<2> x) {
    Vec<2> f1 = problem.f1(x), c1 = problem.c1(x);
    double y = -(f1[0] * c1[0] + f1[1] * c1[1]) / (c1[0] * c1[0] + c1[1] * c1[1]);
    for (;;) {
        const Vec<3> residual = {f1[0] + y * c1[0], f1[1] + y * c1[1], problem.c(x) - y / mu};
        if (std::max({std::abs(residual[0]), std::abs(residual[1]), std::abs(residual[2])}) <= 1e-10) return {x, y};
        const Mat<2> f2 = problem.f2(x), c2 = problem.c2(x);
        Mat<3> K = {{{0, 0, c1[0]}, {0, 0, c1[1]}, {c1[0], c1[1], -1 / mu}}};
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b) K[a][b] = f2[a][b] + y * c2[a][b];
        const Mat<3> inverted = inverse<3>(K);
        for (int a = 0; a < 2; ++a) x[a] -= dot(inverted[a], residual);
        y -= dot(inverted[2], residual);
        f1 = problem.f1(x);
        c1 = problem.c1(x);
    }
}

}  // namespace almesh::lessons
