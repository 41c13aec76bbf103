#include "linalg/block_csr.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/ordering.hpp"
#include "support/matrices.hpp"

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

TEST_CASE("the pattern of many rows is that of every pair of neighbours, for any number of threads") {
    const int k = 100, n = k * k;  // more rows than one thread takes at a time
    std::vector<int> cells;
    for (int j = 0; j + 1 < k; ++j)
        for (int i = 0; i + 1 < k; ++i)
            cells.insert(cells.end(), {j * k + i, j * k + i + 1, (j + 1) * k + i + 1, (j + 1) * k + i});
    const int before = max_threads();
    for (int threads : {1, 2, 3, 8}) {
        set_threads(threads);
        const BlockCsr A = pattern_of_cells(n, 2, cells, 4);
        LargeVector<int> place;
        const BlockCsr same = pattern_of_cells(n, 2, cells, 4, &place);
        CHECK(same.row == A.row);
        CHECK(same.col == A.col);
        bool found = place.size() == cells.size() * 4;
        for (std::size_t p = 0; found && p < place.size(); ++p)
            found = place[p] == A.find(cells[p / 4], cells[p / 16 * 4 + p % 4]);
        CHECK(found);
        CHECK(A.value.empty());
        CHECK(A.blocks() == (3 * k - 2) * (3 * k - 2));
        bool right = true;
        for (int i = 0; i < n; ++i)
            for (int m = A.row[i]; m < A.row[i + 1]; ++m) {
                const int j = A.col[m];
                right = right && std::abs(i % k - j % k) <= 1 && std::abs(i / k - j / k) <= 1 &&
                        (m == A.row[i] || A.col[m - 1] < j);
            }
        CHECK(right);
    }
    set_threads(before);
}

TEST_CASE("products and norms are those of the dense matrix, d = 1, 2, 3") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(30, d, random_edges(30, 60, 7));
        const Dense M = to_dense(A);
        const std::vector<double> x = random_vector(A.size());
        std::vector<double> y(A.size()), expected(A.size(), 0.0), row(A.size(), 0.0);
        multiply(A, x.data(), y.data());
        for (int i = 0; i < M.n; ++i)
            for (int j = 0; j < M.n; ++j) {
                expected[i] += M(i, j) * x[j];
                row[i] += std::abs(M(i, j));
            }
        CHECK(max_difference(y, expected) < 1e-13);
        CHECK(norm_inf(A) == doctest::Approx(*std::max_element(row.begin(), row.end())));
        CHECK(scaled_residual(A, x, y) == 0);
        y[0] += 1;
        CHECK(scaled_residual(A, x, y) > 1e-3);
    }
    CHECK(norm_inf(BlockCsr{}) == 0);
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

TEST_CASE("P A P' is the matrix in the other order: it multiplies reordered vectors as A does") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(120, d, grid(12, 10));
        const std::vector<int> order = reverse_cuthill_mckee(graph_of(A));
        REQUIRE(is_permutation(order));
        const BlockCsr B = reordered(A, row_order(order));
        for (int i = 0; i < B.n; ++i)
            for (int k = B.row[i]; k < B.row[i + 1]; ++k) {
                if (k > B.row[i]) CHECK(B.col[k - 1] < B.col[k]);
                const int source = A.find(order[i], order[B.col[k]]);
                REQUIRE(source >= 0);
                CHECK(std::equal(B.block(k), B.block(k) + d * d, A.block(source)));
            }
        const std::vector<double> x = random_vector(A.size());
        std::vector<double> Ax(A.size()), Px, BPx(A.size()), back;
        multiply(A, x.data(), Ax.data());
        to_rows(B, x, Px);
        multiply(B, Px.data(), BPx.data());
        to_nodes(B, BPx, back);
        CHECK(max_difference(back, Ax) < 1e-13);
        to_nodes(B, Px, back);
        CHECK(back == x);
    }
}

TEST_CASE("new values on the same pattern are copied to their places") {
    BlockCsr A = random_spd(20, 2, path(20));
    BlockCsr B = reordered(A, row_order(reverse_cuthill_mckee(graph_of(A))));
    CHECK(norm_inf(B) == doctest::Approx(norm_inf(A)));
    for (double& v : A.value) v *= 2;
    LargeVector<int> place;
    ordered_pattern(A, B.order, place);
    copy_values(A, place, B);
    CHECK(norm_inf(B) == doctest::Approx(norm_inf(A)));
}
