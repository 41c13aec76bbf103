#include "linalg/dense_solve.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace almesh;

TEST_CASE("diagonalise: A = V D V' with V orthogonal, double and zero eigenvalues included") {
    for (const int n : {1, 3, 6}) {
        CAPTURE(n);
        std::vector<double> A(n * n), V(n * n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) A[i * n + j] = n == 6 ? i == j : std::cos(1.3 * (i + j)) + (i == j ? i : 0);
        if (n == 6) A[1] = A[n] = 1;  // eigenvalues 0, 2 and four times 1
        std::vector<double> D = A;
        diagonalise(n, D.data(), V.data());
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                double product = 0, identity = 0;
                for (int k = 0; k < n; ++k) {
                    product += V[i * n + k] * D[k * n + k] * V[j * n + k];
                    identity += V[i * n + k] * V[j * n + k];
                }
                CHECK(product == doctest::Approx(A[i * n + j]).epsilon(1e-13).scale(1));
                CHECK(identity == doctest::Approx(i == j).epsilon(1e-13).scale(1));
            }
    }
}
