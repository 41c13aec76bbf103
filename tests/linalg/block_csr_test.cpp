#include "linalg/block_csr.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "matrices.hpp"

using namespace almesh;

TEST_CASE("the pattern of two triangles: rows ascending, without repeats, the diagonal included") {
    const BlockCsr A = matrix_of_cells(5, 2, {2, 0, 1, 1, 3, 2}, 3);  // node 4 is in no cell
    CHECK(A.row == std::vector<int>{0, 3, 7, 11, 14, 15});
    CHECK(A.col == std::vector<int>{0, 1, 2, 0, 1, 2, 3, 0, 1, 2, 3, 1, 2, 3, 4});
    CHECK(A.value.size() == 15 * 4);
    CHECK(A.find(0, 3) == -1);
    CHECK(A.find(1, 3) == 6);
    CHECK(A.find(4, 4) == 14);
    CHECK(matrix_of_cells(0, 2, {}, 3).blocks() == 0);
}

TEST_CASE("products and norms are those of the dense matrix, d = 1, 2, 3") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(30, d, random_edges(30, 60, 7));
        const Dense M = to_dense(A);
        const std::vector<double> x = random_vector(A.size());
        std::vector<double> y(A.size()), expected(A.size(), 0.0), column(A.size(), 0.0);
        multiply(A, x.data(), y.data());
        for (int i = 0; i < M.n; ++i)
            for (int j = 0; j < M.n; ++j) {
                expected[i] += M(i, j) * x[j];
                column[j] += std::abs(M(i, j));
            }
        CHECK(max_difference(y, expected) < 1e-13);
        CHECK(norm_1(A) == doctest::Approx(*std::max_element(column.begin(), column.end())));
        CHECK(scaled_residual(A, x, y) == 0);
        y[0] += 1;
        CHECK(scaled_residual(A, x, y) > 1e-3);
    }
    CHECK(norm_1(BlockCsr{}) == 0);
}

TEST_CASE("products have the same bits for any number of threads") {
    const BlockCsr A = random_spd(2500, 2, grid(50, 50));
    const std::vector<double> x = random_vector(A.size());
    std::vector<double> first(A.size()), y(A.size());
    const int before = max_threads();
    set_threads(1);
    multiply(A, x.data(), first.data());
    for (int threads : {2, 3, 5}) {
        set_threads(threads);
        multiply(A, x.data(), y.data());
        CHECK(y == first);
    }
    set_threads(before);
}

TEST_CASE("the scaled residual does not take what is not a number for a solution") {
    BlockCsr A = matrix_of_cells(2, 1, {0, 1}, 2);
    A.value = {2, 1, 1, 2};
    CHECK(scaled_residual(A, {1, 1}, {3, 3}) == 0);
    CHECK(std::isnan(scaled_residual(A, {NAN, 1}, {3, 3})));
    CHECK(std::isnan(scaled_residual(A, {1, 1}, {INFINITY, 3})));
    CHECK(std::isnan(scaled_residual(A, {1e308, 1e308}, {3, 3})));
}
