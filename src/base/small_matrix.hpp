// Vectors of n and n x n matrices, n = 2 or 3: points, the deformation gradient F and its derivatives. Row-major:
// m[row][column]. T is double, or Lanes (base/lanes.hpp) for as many matrices as a SIMD register has lanes.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace almesh {

template <int n, class T = double>
using Vec = std::array<T, n>;
template <int n, class T = double>
using Mat = std::array<std::array<T, n>, n>;

// body(std::integral_constant<int, n>) for n = dim: turns the space dimension into a template argument.
template <class Body>
void with_dimension(int dim, const Body& body) {
    if (dim == 2) body(std::integral_constant<int, 2>());
    else body(std::integral_constant<int, 3>());
}

// The k-th of n x n matrices, row by row.
template <int n, class Numbers>
Mat<n> matrix_at(const Numbers& numbers, std::size_t k) {
    Mat<n> m;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) m[i][j] = numbers[(k * n + i) * n + j];
    return m;
}

template <class T>
T dot(const Vec<3, T>& a, const Vec<3, T>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

template <class T>
Vec<3, T> cross(const Vec<3, T>& a, const Vec<3, T>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline Vec<3> operator+(const Vec<3>& a, const Vec<3>& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec<3> operator-(const Vec<3>& a, const Vec<3>& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec<3> operator*(double s, const Vec<3>& a) { return {s * a[0], s * a[1], s * a[2]}; }

template <int n, class T = double>
T frobenius_squared(const Mat<n, T>& m) {
    T s{};
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) s += m[i][j] * m[i][j];
    return s;
}

// Inlined so that they share their products with cofactor().
template <class T>
[[gnu::always_inline]] inline T determinant(const Mat<2, T>& m) { return m[0][0] * m[1][1] - m[0][1] * m[1][0]; }

template <class T>
[[gnu::always_inline]] inline T determinant(const Mat<3, T>& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// Cofactor matrix C = det(m) m^{-T}: the derivative of det(m), defined for singular m too.
template <class T>
Mat<2, T> cofactor(const Mat<2, T>& m) {
    return {{{m[1][1], -m[1][0]}, {-m[0][1], m[0][0]}}};
}

template <class T>
Mat<3, T> cofactor(const Mat<3, T>& m) {
    Mat<3, T> c;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    return c;
}

template <int n, class T = double>
Mat<n, T> transpose(const Mat<n, T>& m) {
    Mat<n, T> t;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) t[i][j] = m[j][i];
    return t;
}

// Inlined: a call would pass the matrices through memory.
template <int n, class T = double>
[[gnu::always_inline]] inline Mat<n, T> multiply(const Mat<n, T>& a, const Mat<n, T>& b) {
    Mat<n, T> c{};
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j) c[i][j] += a[i][k] * b[k][j];
    return c;
}

// m must not be singular: the caller has checked its determinant.
template <int n, class T = double>
Mat<n, T> inverse(const Mat<n, T>& m) {
    const T inv = 1.0 / determinant(m);
    Mat<n, T> r = transpose<n>(cofactor(m));
    for (auto& row : r)
        for (T& v : row) v *= inv;
    return r;
}

}  // namespace almesh
