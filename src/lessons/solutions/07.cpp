// Solutions of the exercises of lesson 7.
#include "lessons/exercises/07.hpp"

#include <cmath>

namespace almesh::lessons {
namespace {

// Gaussian elimination of the first `count` unknowns of a symmetric matrix. What is left of the others is their Schur
// complement; false where a pivot is not positive.
bool eliminate(std::vector<Vector>& A, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
        if (!(A[k][k] > 0)) return false;
        for (std::size_t i = k + 1; i < A.size(); ++i) {
            const double factor = A[i][k] / A[k][k];
            if (factor == 0) continue;
            for (std::size_t j = k; j < A.size(); ++j) A[i][j] -= factor * A[k][j];
        }
    }
    return true;
}

}  // namespace

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
        if (std::abs(c) <= 1e-10) return result;
    }
}

double stiffest_mode(std::vector<Vector> K, const std::vector<Vector>& M, double one_squared) {
    const std::size_t inside = K.size() - M.size(), boundary = M.size();
    eliminate(K, inside);
    // kappa M / |1|^2 - S is positive definite where kappa is above all modes.
    const auto above = [&](double kappa) {
        std::vector<Vector> A(boundary, Vector(boundary));
        for (std::size_t i = 0; i < boundary; ++i)
            for (std::size_t j = 0; j < boundary; ++j)
                A[i][j] = kappa * M[i][j] / one_squared - K[inside + i][inside + j];
        return eliminate(A, boundary);
    };
    double low = 0, high = 1;
    while (!above(high)) low = high, high *= 2;
    while (high - low > 1e-10 * high) {
        const double middle = 0.5 * (low + high);
        (above(middle) ? high : low) = middle;
    }
    return high;
}

}  // namespace almesh::lessons
