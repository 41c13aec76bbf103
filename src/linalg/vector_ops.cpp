#include "linalg/vector_ops.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

namespace almesh {

namespace {

constexpr int chunk = 64, partial_sums = 8;

// Short vectors are not worth starting a team.
template <class Body>
void for_all(int n, const Body& body) {
    if (n > 16384) return parallel_for(n, body);
    for (int i = 0; i < n; ++i) body(i);
}

}  // namespace

// Eight independent partial sums: they fit a vector register, and the additions do not wait for each other.
double dot_of_piece(int n, const double* x, const double* y) {
    double sum[partial_sums] = {};
    int i = 0;
    for (; i + partial_sums <= n; i += partial_sums)
        for (int l = 0; l < partial_sums; ++l) sum[l] += x[i + l] * y[i + l];
    for (int l = 0; i < n; ++i, ++l) sum[l] += x[i] * y[i];
    return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

double dot(int n, const double* x, const double* y) {
    return deterministic_sum((n + chunk - 1) / chunk, [=](int c) {
        return dot_of_piece(std::min(chunk, n - c * chunk), x + c * chunk, y + c * chunk);
    });
}

double norm_2(int n, const double* x) { return std::sqrt(dot(n, x, x)); }

double norm_inf(int n, const double* x) {
    double largest = 0;
    for (int i = 0; i < n; ++i) {
        if (std::isnan(x[i])) return x[i];
        largest = std::max(largest, std::abs(x[i]));
    }
    return largest;
}

void axpy(int n, double a, const double* x, double* y) {
    for_all(n, [=](int i) { y[i] += a * x[i]; });
}

void scale(int n, double a, double* x) {
    for_all(n, [=](int i) { x[i] *= a; });
}

void copy(int n, const double* x, double* y) {
    for_all(n, [=](int i) { y[i] = x[i]; });
}

void fill(int n, double a, double* x) {
    for_all(n, [=](int i) { x[i] = a; });
}

void subtract(int n, const double* x, const double* y, double* z) {
    for_all(n, [=](int i) { z[i] = x[i] - y[i]; });
}

}  // namespace almesh
