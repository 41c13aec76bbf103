// Solutions of the exercises of lesson 1.
#include <algorithm>
#include <cmath>

#include "lessons/exercises/01.hpp"

namespace almesh::lessons {

// Heron's formula; not a number where there is no triangle.
static double area(const Lengths& l) {
    return std::sqrt((l[0] + l[1] + l[2]) * (l[1] + l[2] - l[0]) * (l[2] + l[0] - l[1]) * (l[0] + l[1] - l[2])) / 4;
}

double eta_of_lengths(const Lengths& ideal, const Lengths& physical) {
    // |F|^2 |ideal| = 1/2 sum_i cot(a_i) physical_i^2, a_i the ideal angle opposite to edge i; by the law of cosines
    // cot(a_i) = (the squares of the other two edges - its own) / (4 |ideal|). det F = |physical| / |ideal|.
    const double A = area(ideal), B = area(physical);
    if (!(B > 0)) return INFINITY;
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const double own = ideal[i], second = ideal[(i + 1) % 3], third = ideal[(i + 2) % 3];
        sum += (second * second + third * third - own * own) * physical[i] * physical[i];
    }
    return sum / (16 * A * B);
}

Circle level_set(const Vec<2>& apex, double eta) {
    // F = (1, (x - apex_x) / apex_y; 0, y / apex_y): eta = 1 + |x - apex|^2 / (2 y apex_y), and complete the square.
    return {{apex[0], apex[1] * eta}, apex[1] * std::sqrt(eta * eta - 1)};
}

double eta_3d(const Mat<3>& F) {
    double size = 0;  // the largest entry: eta of F / size is the same, and its products stay within double's range
    for (const auto& row : F)
        for (const double entry : row) size = std::max(size, std::abs(entry));
    Mat<3> G = F;
    for (auto& row : G)
        for (double& entry : row) entry /= size;
    const double det = determinant(G);  // no number where F = 0
    return det > 0 ? frobenius_squared<3>(G) / (3 * std::cbrt(det * det)) : INFINITY;
}

double eta_regularised(const Mat<2>& F, double delta) {
    const double det = determinant(F), root = std::sqrt(det * det + 4 * delta * delta);
    if (delta == 0 && !(det > 0)) return INFINITY;
    // det + root loses all digits where det < 0: there multiply and divide by root - det.
    const double sigma = det > 0 ? 0.5 * (det + root) : 2 * delta * delta / (root - det);
    return frobenius_squared<2>(F) / (2 * sigma);
}

double stretch_of(double eta) {
    return eta + std::sqrt(eta * eta - 1);  // eta = (s + 1/s) / 2
}

// The scalar products of the three edges from vertex 0.
static Mat<3> gram(const SixLengths& length) {
    const int opposite[3][3] = {{-1, 3, 4}, {3, -1, 5}, {4, 5, -1}};  // the edge between the ends of two of them
    Mat<3> G{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const double between = i == j ? 0 : length[opposite[i][j]];
            G[i][j] = (length[i] * length[i] + length[j] * length[j] - between * between) / 2;
        }
    return G;
}

// Of a matrix whose eigenvalues are real: the largest root of the characteristic polynomial, by Viete's cosine.
static double largest_eigenvalue(const Mat<3>& M) {
    const double mean = (M[0][0] + M[1][1] + M[2][2]) / 3;
    Mat<3> D = M;
    for (int i = 0; i < 3; ++i) D[i][i] -= mean;
    const Mat<3> DD = multiply<3>(D, D);
    const double p = std::sqrt(std::max(0.0, (DD[0][0] + DD[1][1] + DD[2][2]) / 6));
    if (p == 0) return mean;
    return mean + 2 * p * std::cos(std::acos(std::clamp(determinant(D) / (2 * p * p * p), -1.0, 1.0)) / 3);
}

Measured measure_tetrahedron(const SixLengths& ideal, const SixLengths& physical) {
    const Mat<3> G = gram(physical);
    if (!(determinant(G) > 0 && G[0][0] * G[1][1] > G[0][1] * G[0][1])) return {INFINITY, INFINITY};
    // A' F'F A = B'B, so inverse(A'A) B'B is similar to F'F.
    const Mat<3> C = multiply<3>(inverse<3>(gram(ideal)), G);
    const double eta = (C[0][0] + C[1][1] + C[2][2]) / (3 * std::cbrt(determinant(C)));
    return {eta, std::sqrt(largest_eigenvalue(C) * largest_eigenvalue(inverse<3>(C)))};
}

double largest_stretch(double eta) {
    const double half = std::pow(eta, 1.5);  // of s + 1/s
    return half + std::sqrt(half * half - 1);
}

}  // namespace almesh::lessons
