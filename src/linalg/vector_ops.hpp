// Vector operations of Krylov methods, on arrays of n doubles. Same bits for any number of threads: sums go through
// deterministic_sum() in chunks of 64 terms, each added up in eight partial sums.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.hpp"

namespace almesh {

// The dot product by the calling thread alone, for n of some hundred. Eight independent partial sums fit a vector
// register, and no addition waits for the one before it.
inline double dot_of_piece(int n, const double* x, const double* y) {
    constexpr int partial_sums = 8;
    double sum[partial_sums] = {};
    int i = 0;
    for (; i + partial_sums <= n; i += partial_sums)
        for (int l = 0; l < partial_sums; ++l) sum[l] += x[i + l] * y[i + l];
    for (int l = 0; i < n; ++i, ++l) sum[l] += x[i] * y[i];
    return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

inline double dot(int n, const double* x, const double* y) {
    constexpr int chunk = 64;
    return deterministic_sum((n + chunk - 1) / chunk, [=](int c) {
        return dot_of_piece(std::min(chunk, n - c * chunk), x + c * chunk, y + c * chunk);
    });
}

inline double norm_2(int n, const double* x) { return std::sqrt(dot(n, x, x)); }

// Calls body(i) for all entries, several of them in the time of a simple operation of other loops.
template <class Body>
void for_entries(int n, const Body& body) {
    constexpr double work = 1.5;
    parallel_for(n, body, work);
}

inline void axpy(int n, double a, const double* x, double* y) { for_entries(n, [=](int i) { y[i] += a * x[i]; }); }
inline void scale(int n, double a, double* x) { for_entries(n, [=](int i) { x[i] *= a; }); }
inline void copy(int n, const double* x, double* y) { for_entries(n, [=](int i) { y[i] = x[i]; }); }
inline void fill(int n, double a, double* x) { for_entries(n, [=](int i) { x[i] = a; }); }
inline void subtract(int n, const double* x, const double* y, double* z) {
    for_entries(n, [=](int i) { z[i] = x[i] - y[i]; });
}

inline double dot(const std::vector<double>& x, const std::vector<double>& y) {
    return dot(static_cast<int>(x.size()), x.data(), y.data());
}
inline double norm_2(const std::vector<double>& x) { return std::sqrt(dot(x, x)); }
inline void axpy(double a, const std::vector<double>& x, std::vector<double>& y) {
    axpy(static_cast<int>(x.size()), a, x.data(), y.data());
}

// 0 for n = 0; nan if any entry is.
inline double norm_inf(const std::vector<double>& x) {
    double largest = 0;
    for (double entry : x) {
        if (std::isnan(entry)) return entry;
        largest = std::max(largest, std::abs(entry));
    }
    return largest;
}

}  // namespace almesh
