// Solutions of the exercises of lesson 10.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "lessons/exercises/10.hpp"

namespace almesh::lessons {

Vector multiply_symmetric(const BlockCsr& lower, const Vector& x) {
    Vector y(x.size());
    for (int i = 0; i < lower.n; ++i)
        for (int k = lower.row[i]; k < lower.row[i + 1]; ++k) {
            const int j = lower.col[k];
            y[i] += lower.value[k] * x[j];
            if (j != i) y[j] += lower.value[k] * x[i];
        }
    return y;
}

int factor_entries(const Graph& graph) {
    std::vector<std::set<int>> later(graph.size());
    for (int v = 0; v < graph.size(); ++v)
        for (const int w : graph.neighbours(v))
            if (w > v) later[v].insert(w);
    int entries = 0;
    for (const std::set<int>& of_column : later) {
        entries += 1 + static_cast<int>(of_column.size());
        if (of_column.empty()) continue;
        const int first = *of_column.begin();  // it is joined to the others; they to each other when it is eliminated
        later[first].insert(std::next(of_column.begin()), of_column.end());
    }
    return entries;
}

std::vector<int> order_of_tree(const Graph& tree) {
    std::vector<int> order = {0};
    std::vector<char> reached(tree.size());
    reached[0] = 1;
    for (std::size_t i = 0; i < order.size(); ++i)
        for (const int w : tree.neighbours(order[i]))
            if (!reached[w]) {
                reached[w] = 1;
                order.push_back(w);
            }
    std::reverse(order.begin(), order.end());  // children before their parents
    return order;
}

void cg_step(const BlockCsr& A, CgState& state) {
    auto& [x, r, p] = state;
    Vector Ap(x.size());
    multiply(A, p.data(), Ap.data());
    const double rr = std::inner_product(r.begin(), r.end(), r.begin(), 0.0);
    const double alpha = rr / std::inner_product(p.begin(), p.end(), Ap.begin(), 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * Ap[i];
    }
    const double beta = std::inner_product(r.begin(), r.end(), r.begin(), 0.0) / rr;
    for (std::size_t i = 0; i < x.size(); ++i) p[i] = r[i] + beta * p[i];
}

int sufficient_steps(double kappa, double factor) {
    const double rate = (std::sqrt(kappa) - 1) / (std::sqrt(kappa) + 1);
    return static_cast<int>(std::ceil(std::log(factor / 2) / std::log(rate)));
}

namespace {

// The points (row + i, column + j) of a grid with `stride` columns.
void dissect(int row, int rows, int column, int columns, int stride, std::vector<int>& order) {
    if (rows == 0 || columns == 0) return;
    const int half = std::max(rows, columns) / 2;
    if (rows >= columns) {
        dissect(row, half, column, columns, stride, order);
        dissect(row + half + 1, rows - half - 1, column, columns, stride, order);
        for (int j = 0; j < columns; ++j) order.push_back((row + half) * stride + column + j);
    } else {
        dissect(row, rows, column, half, stride, order);
        dissect(row, rows, column + half + 1, columns - half - 1, stride, order);
        for (int i = 0; i < rows; ++i) order.push_back((row + i) * stride + column + half);
    }
}

// across: how many of the two sides of length `columns` have later points behind them; along: of those of length `rows`.
double entries(int rows, int columns, int across, int along) {
    if (rows < columns) return entries(columns, rows, along, across);
    if (columns == 0) return 0;
    const double s = columns, b = columns * across + rows * along;
    const int half = rows / 2, rest = rows - half - 1;
    // A half has the separator on one side, and on the other what the piece had there.
    return s * s / 2 + s * b + entries(half, columns, 1 + (across > 0), along) +
           entries(rest, columns, 1 + (across > 1), along);
}

}  // namespace

std::vector<int> dissection_of_grid(int rows, int columns) {
    std::vector<int> order;
    dissect(0, rows, 0, columns, columns, order);
    return order;
}

double entries_foretold(int rows, int columns) { return entries(rows, columns, 0, 0); }

}  // namespace almesh::lessons
