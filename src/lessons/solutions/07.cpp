// Solutions of the exercises of lesson 7.
#include "lessons/exercises/07.hpp"

#include <cmath>

namespace almesh::lessons {

double exact_multiplier(double lambda, double mu, double c_1, double c_2) {
    return lambda - mu * c_1 / (1 - c_2 / c_1);  // lambda - mu (c_1 + c_2 + c_3 + ...), a geometric series
}

Vector wall_forces(const std::vector<std::array<int, 2>>& edges, const Vector& lambda) {
    Vector f(lambda.size(), 0.0);
    const double one = std::sqrt(static_cast<double>(edges.size()));
    for (const auto& [i, j] : edges)
        for (int a = 0; a < 2; ++a) {
            f[2 * i + a] += (2 * lambda[2 * i + a] + lambda[2 * j + a]) / (6 * one);
            f[2 * j + a] += (lambda[2 * i + a] + 2 * lambda[2 * j + a]) / (6 * one);
        }
    return f;
}

double penalty_for(double kappa, double q) {
    return kappa > 0 ? kappa * (q - 1) : -kappa * (q + 1);  // |kappa / (kappa + mu)| = 1 / q, kappa + mu > 0
}

Multiplier method_of_multipliers(const Mat<2>& K, const Vec<2>& b, const Vec<2>& a, double g, double mu) {
    Multiplier result;
    while (true) {
        Mat<2> A = K;  // (K + mu a a') x = b + (lambda + mu g) a
        Vec<2> right = b, x{};
        for (int i = 0; i < 2; ++i) {
            right[i] += (result.lambda + mu * g) * a[i];
            for (int j = 0; j < 2; ++j) A[i][j] += mu * a[i] * a[j];
        }
        const Mat<2> inverted = inverse<2>(A);
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) x[i] += inverted[i][j] * right[j];
        const double c = a[0] * x[0] + a[1] * x[1] - g;
        result.lambda -= mu * c;
        ++result.updates;
        if (std::abs(c) <= 1e-10 || result.updates == 10000) return result;
    }
}

}  // namespace almesh::lessons
