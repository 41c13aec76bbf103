#include "linalg/ilu0.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "matrices.hpp"

using namespace almesh;

TEST_CASE("ILU(0) of a block tridiagonal and of a dense matrix is its LU: one solve gives the solution") {
    for (int d = 1; d <= 3; ++d)
        for (const Edges& edges : {path(40), complete(40)}) {
            const BlockCsr A = random_spd(40, d, edges);
            const std::vector<double> x = random_vector(A.size());
            std::vector<double> y(A.size());
            multiply(A, x.data(), y.data());
            Ilu0 ilu(A);
            CHECK(ilu.factor(A).status == Ilu0Status::factored);
            ilu.solve(y.data());
            CHECK(max_difference(x, y) < 1e-12);
        }
}

TEST_CASE("on its pattern, the product of the factors is the matrix") {
    // M = (L + I)(D + U): M^{-1} applied to the columns of A on a grid differs from I only where LU fills in.
    const BlockCsr A = random_spd(25, 2, grid(5, 5), 2.0);
    Ilu0 ilu(A);
    REQUIRE(ilu.factor(A).status == Ilu0Status::factored);
    const int n = A.size();
    Dense inverse{n, std::vector<double>(static_cast<std::size_t>(n) * n, 0.0)};
    for (int j = 0; j < n; ++j) {
        std::vector<double> e(n, 0.0);
        e[j] = 1;
        ilu.solve(e.data());
        for (int i = 0; i < n; ++i) inverse(i, j) = e[i];
    }
    // M itself, by Gauss-Jordan on its inverse.
    Dense M{n, std::vector<double>(static_cast<std::size_t>(n) * n, 0.0)};
    for (int i = 0; i < n; ++i) M(i, i) = 1;
    for (int k = 0; k < n; ++k) {
        const double pivot = inverse(k, k);
        for (int j = 0; j < n; ++j) inverse(k, j) /= pivot, M(k, j) /= pivot;
        for (int i = 0; i < n; ++i) {
            const double factor = inverse(i, k);
            for (int j = 0; j < n && i != k; ++j) inverse(i, j) -= factor * inverse(k, j), M(i, j) -= factor * M(k, j);
        }
    }
    const Dense expected = to_dense(A);
    double on_pattern = 0, elsewhere = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            double& worst = A.find(i / 2, j / 2) >= 0 ? on_pattern : elsewhere;
            worst = std::max(worst, std::abs(M(i, j) - expected(i, j)));
        }
    CHECK(on_pattern < 1e-12);
    CHECK(elsewhere > 1e-3);
}

TEST_CASE("factor() refills the pattern, and names the row of a bad pivot block") {
    BlockCsr A = random_spd(10, 2, path(10));
    Ilu0 ilu(A);
    CHECK(ilu.factor(A).status == Ilu0Status::factored);
    BlockCsr B = A;
    for (int k = B.row[4]; k < B.row[5]; ++k) std::fill_n(B.block(k), 4, 0.0);
    CHECK(ilu.factor(B).status == Ilu0Status::zero_pivot);
    CHECK(ilu.factor(B).bad_row == 4);
    B = A;
    B.block(B.find(7, 7))[0] = std::numeric_limits<double>::quiet_NaN();
    CHECK(ilu.factor(B).bad_row == 7);
    B.block(B.find(7, 7))[0] = std::numeric_limits<double>::infinity();
    CHECK(ilu.factor(B).bad_row == 7);
    CHECK(ilu.factor(A).bad_row == -1);
}

TEST_CASE("blocks are inverted with row exchanges") {
    BlockCsr A = random_spd(1, 3, {});
    A.value = {0, 2, 0, 0, 0, 4, 5, 0, 0};
    Ilu0 ilu(A);
    REQUIRE(ilu.factor(A).status == Ilu0Status::factored);
    std::vector<double> x{2, 4, 5};
    ilu.solve(x.data());
    CHECK(max_difference(x, {1, 1, 1}) < 1e-15);
}

TEST_CASE("an empty matrix") {
    const BlockCsr A = matrix_of_cells(0, 2, {}, 2);
    CHECK(Ilu0(A).factor(A).status == Ilu0Status::factored);
}
