// Solutions of the exercises of lesson 1.
#include <cmath>

#include "lessons/exercises/01.hpp"

namespace almesh::lessons {

Mat<2> jacobian_of_map(const Triangle& ideal, const Triangle& physical) {
    const auto edges = [](const Triangle& t) {
        Mat<2> columns;
        for (int i = 0; i < 2; ++i) columns[i] = {t[1][i] - t[0][i], t[2][i] - t[0][i]};
        return columns;
    };
    const Mat<2> A = edges(physical), W_inverse = inverse<2>(edges(ideal));
    Mat<2> F{};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k) F[i][j] += A[i][k] * W_inverse[k][j];
    return F;
}

double eta_2d(const Mat<2>& F) {
    const double det = determinant(F);
    return det > 0 ? frobenius_squared<2>(F) / (2 * det) : INFINITY;
}

double eta_3d(const Mat<3>& F) {
    const double det = determinant(F);
    return det > 0 ? frobenius_squared<3>(F) / (3 * std::cbrt(det * det)) : INFINITY;
}

double eta_regularised(const Mat<2>& F, double delta) {
    const double det = determinant(F), root = std::sqrt(det * det + 4 * delta * delta);
    // det + root loses all digits where det < 0: there multiply and divide by root - det.
    const double sigma = det > 0 ? 0.5 * (det + root) : 2 * delta * delta / (root - det);
    return frobenius_squared<2>(F) / (2 * sigma);
}

double stretch_of(double eta) {
    return eta + std::sqrt(eta * eta - 1);  // eta = (s + 1/s) / 2
}

}  // namespace almesh::lessons
