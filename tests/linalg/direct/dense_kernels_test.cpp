#include "linalg/direct/dense_kernels.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/parallel.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

// A random positive definite front: the panel as assembled, and what partial elimination must make of it.
struct Example {
    int m, k;
    Dense full;
    std::vector<double> panel, update, smallest;

    Example(int rows, int pivots) : m(rows), k(pivots), full{rows, std::vector<double>(rows * rows)} {
        const std::vector<double> random = random_vector(rows * rows, static_cast<unsigned>(rows + pivots));
        for (int i = 0; i < m; ++i)
            for (int j = 0; j <= i; ++j) full(i, j) = full(j, i) = random[i * m + j] + (i == j ? m : 0);
        for (int i = k; i < m; ++i)
            for (int j = k; j < m; ++j) full(i, j) = 0;
        panel.assign(panel_size(m, k), 0.0);
        for (int j = 0; j < k; ++j)
            for (int i = 0; i < m; ++i) panel[static_cast<std::size_t>(j) * front_ld(m) + i] = full(i, j);
        update.assign(update_size(m, k), 99.0);
        smallest.assign(k, 0.0);
    }

    Front front() { return {m, k, panel.data(), update.data()}; }
    double L(int i, int j) const { return panel[static_cast<std::size_t>(j) * front_ld(m) + i]; }
    double U(int i, int j) const {
        return update[static_cast<std::size_t>(j - k) * update_ld(m, k) + i - update_row(k)];
    }
};

// Largest error of the factored front against plain elimination.
double error(Example& example) {
    Dense& M = example.full;
    for (int j = 0; j < example.k; ++j) {
        const double root = std::sqrt(M(j, j));
        for (int i = j; i < M.n; ++i) M(i, j) /= root;
        for (int c = j + 1; c < M.n; ++c)
            for (int i = c; i < M.n; ++i) M(i, c) -= M(i, j) * M(c, j);
    }
    double largest = 0;
    for (int j = 0; j < M.n; ++j)
        for (int i = j; i < M.n; ++i)
            largest = std::max(largest, std::abs(M(i, j) - (j < example.k ? example.L(i, j) : example.U(i, j))));
    return largest;
}

}  // namespace

TEST_CASE("fronts of all shapes around the tile sizes are factored as by plain elimination") {
    for (int m = 1; m <= 34; ++m)
        for (int k = 1; k <= m; ++k) {
            Example example(m, k);
            CAPTURE(m);
            CAPTURE(k);
            REQUIRE(factor_front(example.front(), example.smallest.data(), false) == -1);
            CHECK(error(example) < 1e-12);
        }
}

TEST_CASE("large fronts: blocks of columns, packed operands") {
    const std::pair<int, int> shapes[] = {{129, 128}, {161, 3}, {250, 129}, {403, 200}, {420, 420}, {600, 77}};
    for (const auto& shape : shapes) {
        Example example(shape.first, shape.second);
        CAPTURE(shape.first);
        CAPTURE(shape.second);
        REQUIRE(factor_front(example.front(), example.smallest.data(), true) == -1);
        CHECK(error(example) < 1e-11);
    }
}

TEST_CASE("the first bad pivot is named: not positive, too small, not a number") {
    for (int column : {0, 5, 8, 63, 130, 199}) {
        Example example(230, 200);
        double& entry = example.panel[static_cast<std::size_t>(column) * front_ld(230) + column];
        entry = -1;
        const std::vector<double> assembled = example.panel;
        CHECK(factor_front(example.front(), example.smallest.data(), false) == column);
        example.panel = assembled;
        entry = NAN;
        CHECK(factor_front(example.front(), example.smallest.data(), true) == column);
        example.panel = assembled;
        entry = 230;
        example.smallest[column] = 230;
        CHECK(factor_front(example.front(), example.smallest.data(), false) == column);
    }
}

TEST_CASE("triangular solves with the columns of a front") {
    const std::pair<int, int> shapes[] = {{1, 1}, {9, 4}, {40, 40}, {77, 31}, {150, 67}, {700, 130}};
    for (const auto& [m, k] : shapes) {
        Example example(m, k);
        REQUIRE(factor_front(example.front(), example.smallest.data(), false) == -1);
        const std::vector<double> start = random_vector(m);
        std::vector<double> w = start;
        solve_forward(example.front(), w.data(), false);
        for (int i = 0; i < m; ++i) {  // L11 w1 = start1, w2 + L21 w1 = start2
            double sum = i < k ? 0 : w[i];
            for (int j = 0; j < std::min(i + 1, k); ++j) sum += example.L(i, j) * w[j];
            CHECK(sum == doctest::Approx(start[i]).epsilon(1e-12));
        }
        w = start;
        solve_backward(example.front(), w.data(), false);
        for (int j = 0; j < k; ++j) {  // L11' w1 + L21' w2 = start1
            double sum = 0;
            for (int i = j; i < m; ++i) sum += example.L(i, j) * w[i];
            CHECK(sum == doctest::Approx(start[j]).epsilon(1e-12));
        }
    }
}

TEST_CASE("the same bits alone and with any number of threads") {
    Example first(500, 300);
    REQUIRE(factor_front(first.front(), first.smallest.data(), false) == -1);
    const int before = max_threads();
    for (int threads : {1, 2, 3, 5}) {
        set_threads(threads);
        Example example(500, 300);
        REQUIRE(factor_front(example.front(), example.smallest.data(), true) == -1);
        for (int j = 0; j < 500; ++j)
            for (int i = j; i < 500; ++i) {
                const bool same = j < 300 ? example.L(i, j) == first.L(i, j) : example.U(i, j) == first.U(i, j);
                if (!same) FAIL_CHECK(i << ' ' << j);
            }
    }
    set_threads(before);
}

TEST_CASE("solves with a tall front: the same bits alone and with any number of threads") {
    Front front{3000, 133, nullptr, nullptr};
    std::vector<double> panel(panel_size(front.m, front.k)), start = random_vector(front.m);
    const std::vector<double> random = random_vector(static_cast<int>(panel.size()));
    for (std::size_t i = 0; i < panel.size(); ++i) panel[i] = random[i] / front.m;
    for (int j = 0; j < front.k; ++j) panel[static_cast<std::size_t>(j) * front_ld(front.m) + j] = 1.5;
    front.panel = panel.data();
    std::vector<double> forward = start, backward = start;
    solve_forward(front, forward.data(), false);
    solve_backward(front, backward.data(), false);
    const int before = max_threads();
    for (int threads : {1, 2, 3, 8}) {
        set_threads(threads);
        std::vector<double> w = start;
        solve_forward(front, w.data(), true);
        CHECK(w == forward);
        w = start;
        solve_backward(front, w.data(), true);
        CHECK(w == backward);
    }
    set_threads(before);
}
