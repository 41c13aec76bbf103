// Vector operations of Krylov methods, on arrays of n doubles. Same bits for any number of threads: sums go through
// deterministic_sum() in chunks of 64 terms, each added up in eight partial sums.
#pragma once
#include <vector>

namespace almesh {

double dot(int n, const double* x, const double* y);
double dot_of_piece(int n, const double* x, const double* y);  // by the calling thread alone: for n of some hundred
double norm_2(int n, const double* x);
double norm_inf(int n, const double* x);                     // 0 for n = 0; nan if any entry is
void axpy(int n, double a, const double* x, double* y);      // y += a x
void scale(int n, double a, double* x);                      // x *= a
void copy(int n, const double* x, double* y);                // y = x
void fill(int n, double a, double* x);                       // x_i = a
void subtract(int n, const double* x, const double* y, double* z);  // z = x - y

inline double dot(const std::vector<double>& x, const std::vector<double>& y) {
    return dot(static_cast<int>(x.size()), x.data(), y.data());
}
inline double norm_2(const std::vector<double>& x) { return norm_2(static_cast<int>(x.size()), x.data()); }
inline double norm_inf(const std::vector<double>& x) { return norm_inf(static_cast<int>(x.size()), x.data()); }
inline void axpy(double a, const std::vector<double>& x, std::vector<double>& y) {
    axpy(static_cast<int>(x.size()), a, x.data(), y.data());
}

}  // namespace almesh
