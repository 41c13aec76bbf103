#include "linalg/dense_solve.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

TEST_CASE("solve_dense: all columns at once to the bits of each alone, a singular system is told") {
    constexpr int k = 5, columns = 3;
    std::vector<double> A, b, s, column(k), alone;
    for (int i = 0; i < k * k; ++i) A.push_back(std::sin(3.0 * i * i));
    for (int i = 0; i < k * columns; ++i) b.push_back(std::cos(7.0 * i));
    REQUIRE(solve_dense(A, b, s));
    for (int c = 0; c < columns; ++c) {
        for (int i = 0; i < k; ++i) column[i] = b[i * columns + c];
        REQUIRE(solve_dense(A, column, alone));
        for (int i = 0; i < k; ++i) {
            CHECK(s[i * columns + c] == alone[i]);
            double sum = 0;
            for (int j = 0; j < k; ++j) sum += A[i * k + j] * alone[j];
            CHECK(sum == doctest::Approx(column[i]).epsilon(1e-12));
        }
    }
    std::copy_n(A.begin(), k, A.begin() + k);
    CHECK_FALSE(solve_dense(A, b, s));
}
