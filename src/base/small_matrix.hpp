// Fixed-size n x n matrices, n = 2 or 3, for the deformation gradient F and its kin. Row-major: m[row][column].
#pragma once
#include <array>
#include <cmath>
#include <type_traits>

namespace almesh {

template <int n>
using Vec = std::array<double, n>;
template <int n>
using Mat = std::array<std::array<double, n>, n>;

// body(std::integral_constant<int, n>) for n = dim: turns the space dimension into a template argument.
template <class Body>
void with_dimension(int dim, const Body& body) {
    if (dim == 2) body(std::integral_constant<int, 2>());
    else body(std::integral_constant<int, 3>());
}

template <int n>
double frobenius_squared(const Mat<n>& m) {
    double s = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) s += m[i][j] * m[i][j];
    return s;
}

inline double determinant(const Mat<2>& m) { return m[0][0] * m[1][1] - m[0][1] * m[1][0]; }

inline double determinant(const Mat<3>& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// Cofactor matrix C = det(m) m^{-T}: the derivative of det(m), defined for singular m too.
inline Mat<2> cofactor(const Mat<2>& m) { return {{{m[1][1], -m[1][0]}, {-m[0][1], m[0][0]}}}; }

inline Mat<3> cofactor(const Mat<3>& m) {
    Mat<3> c;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    return c;
}

template <int n>
Mat<n> transpose(const Mat<n>& m) {
    Mat<n> t;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) t[i][j] = m[j][i];
    return t;
}

template <int n>
Mat<n> multiply(const Mat<n>& a, const Mat<n>& b) {
    Mat<n> c{};
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j) c[i][j] += a[i][k] * b[k][j];
    return c;
}

// m must not be singular: the caller has checked its determinant.
template <int n>
Mat<n> inverse(const Mat<n>& m) {
    const double inv = 1 / determinant(m);
    Mat<n> r = transpose<n>(cofactor(m));
    for (auto& row : r)
        for (double& v : row) v *= inv;
    return r;
}

}  // namespace almesh
