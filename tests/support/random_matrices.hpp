// Random 2x2 and 3x3 matrices for the tests of energy/.
#pragma once
#include <cmath>
#include <random>

#include "base/lanes.hpp"
#include "base/small_matrix.hpp"

namespace almesh::test {

template <int n>
Mat<n> random_matrix(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    Mat<n> m;
    for (auto& row : m)
        for (double& v : row) v = uniform(random);
    return m;
}

// Gram and Schmidt on the rows of a random matrix, the last one turned so that the determinant is 1.
template <int n>
Mat<n> random_rotation(std::mt19937& random) {
    Mat<n> R = random_matrix<n>(random);
    for (int i = 0; i < n; ++i) {
        for (int pass = 0; pass < 2; ++pass)  // twice is enough
            for (int k = 0; k < i; ++k) {
                double product = 0;
                for (int j = 0; j < n; ++j) product += R[i][j] * R[k][j];
                for (int j = 0; j < n; ++j) R[i][j] -= product * R[k][j];
            }
        double squared = 0;
        for (int j = 0; j < n; ++j) squared += R[i][j] * R[i][j];
        for (int j = 0; j < n; ++j) R[i][j] /= std::sqrt(squared);
    }
    if (determinant(R) < 0)
        for (double& v : R[n - 1]) v = -v;
    return R;
}

// rotation diag(s) rotation
template <int n>
Mat<n> with_singular_values(std::mt19937& random, const Vec<n>& s) {
    Mat<n> F = random_rotation<n>(random);
    for (int i = 0; i < n; ++i)
        for (double& v : F[i]) v *= s[i];
    return multiply<n>(random_rotation<n>(random), F);
}

// Singular values 0.7, 1, 1.3, the last times `thin`: small for nearly inverted, negative for inverted.
template <int n>
Mat<n> random_gradient(std::mt19937& random, double thin) {
    Vec<n> s;
    for (int k = 0; k < n; ++k) s[k] = 0.7 + 0.3 * k;
    s[n - 1] *= thin;
    return with_singular_values<n>(random, s);
}

template <int n>
Mat<n> shifted(Mat<n> F, const Mat<n>& dF, double t) {
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) F[i][j] += t * dF[i][j];
    return F;
}

template <int n>
double inner(const Mat<n>& a, const Mat<n>& b) {
    double s = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) s += a[i][j] * b[i][j];
    return s;
}

// Matrix number `lane` of a batch.
template <int n>
Mat<n> lane_of(const Mat<n, Lanes>& m, int lane) {
    Mat<n> single;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) single[i][j] = m[i][j][lane];
    return single;
}

template <int n>
void set_lane(Mat<n, Lanes>& m, int lane, const Mat<n>& single) {
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) m[i][j][lane] = single[i][j];
}

}  // namespace almesh::test
