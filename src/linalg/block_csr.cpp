// The pattern comes from the cells around each node, row by row; products keep the partial sums of a row in registers.
#include "linalg/block_csr.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

int BlockCsr::find(int i, int j) const {
    const auto begin = col.begin() + row[i], end = col.begin() + row[i + 1];
    const auto it = std::lower_bound(begin, end, j);
    return it != end && *it == j ? static_cast<int>(it - col.begin()) : -1;
}

namespace {

constexpr int row_block = 1024;  // rows whose columns a thread collects at a time

template <int d>
void multiply_blocks(const BlockCsr& A, int begin, int end, const double* x, double* y) {
    for (int i = begin; i < end; ++i) {
        SumOfProducts<d> sum;
        for (int k = A.row[i]; k < A.row[i + 1]; ++k) sum.add(A.block(k), x + offset(A.col[k], d));
        for (int r = 0; r < d; ++r) y[offset(i, d, r)] = sum.entry(r);
    }
}

}  // namespace

BlockCsr pattern_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes, LargeVector<int>* place) {
    const Groups around = sorted_by_group(cells, n);  // node i is cells[k] for the k of around.of(i)
    const auto cell_of = [&](int k) { return &cells[k / cell_nodes * cell_nodes]; };
    BlockCsr A{n, d, std::vector<int>(n + 1, 0)};
    const int blocks = (n + row_block - 1) / row_block;
    std::vector<std::vector<int>> columns(blocks);  // of each block of rows
    in_team(n >= parallel_work, [&] {
        std::vector<int> last_row(n, -1);  // row in which this thread met a column last
#pragma omp for schedule(static)
        for (int block = 0; block < blocks; ++block) {
            std::vector<int>& found = columns[block];
            for (int i = block * row_block, end = std::min(n, i + row_block); i < end; ++i) {
                const auto begin = static_cast<std::ptrdiff_t>(found.size());
                last_row[i] = i;
                found.push_back(i);
                for (int k : around.of(i)) {
                    const int* const cell = cell_of(k);
                    for (int b = 0; b < cell_nodes; ++b)
                        if (std::exchange(last_row[cell[b]], i) != i) found.push_back(cell[b]);
                }
                std::sort(found.begin() + begin, found.end());
                A.row[i + 1] = static_cast<int>(found.end() - found.begin() - begin);
            }
        }
    });
    for (int i = 0; i < n; ++i) A.row[i + 1] += A.row[i];
    A.col.resize(A.row[n]);
    parallel_for(blocks, [&](int block) {
        std::copy(columns[block].begin(), columns[block].end(), A.col.begin() + A.row[block * row_block]);
    }, 100.0 * row_block);
    if (!place) return A;
    place->resize(cells.size() * cell_nodes);
    in_team(n >= parallel_work, [&] {
        std::vector<int> place_of(n);  // of each column of the current row
#pragma omp for schedule(static)
        for (int i = 0; i < n; ++i) {
            for (int k = A.row[i]; k < A.row[i + 1]; ++k) place_of[A.col[k]] = k;
            for (int k : around.of(i))
                for (int b = 0; b < cell_nodes; ++b) (*place)[offset(k, cell_nodes, b)] = place_of[cell_of(k)[b]];
        }
    });
    return A;
}

BlockCsr joint_pattern(const std::vector<const BlockCsr*>& patterns, std::vector<LargeVector<int>>& place) {
    BlockCsr A{patterns.front()->n, patterns.front()->d, {0}};
    for (const BlockCsr* of : patterns) place.emplace_back(of->col.size());
    for (int i = 0; i < A.n; ++i) {
        for (const BlockCsr* of : patterns)
            A.col.insert(A.col.end(), of->col.begin() + of->row[i], of->col.begin() + of->row[i + 1]);
        const auto begin = A.col.begin() + A.row[i];
        std::sort(begin, A.col.end());
        A.col.erase(std::unique(begin, A.col.end()), A.col.end());
        A.row.push_back(A.blocks());
        for (std::size_t k = 0; k < patterns.size(); ++k)
            for (int b = patterns[k]->row[i], c = A.row[i]; b < patterns[k]->row[i + 1]; ++b) {
                while (A.col[c] < patterns[k]->col[b]) ++c;
                place[k][b] = c;
            }
    }
    return A;
}

void BlockCsr::set_zero() {
    if (in_half() && !below) below = std::make_shared<LargeVector<float>>(col.size() * d * d + 3, 0.0f);
    value.resize((in_half() ? n : col.size()) * d * d);
    parallel_for(n, [&](int i) {
        if (in_half()) std::fill(block_below(row[i]), block_below(row[i + 1]), 0.0f);
        std::fill(block(in_half() ? i : row[i]), block(in_half() ? i + 1 : row[i + 1]), 0.0);
    });
}

BlockCsr matrix_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes) {
    BlockCsr A = pattern_of_cells(n, d, cells, cell_nodes);
    A.set_zero();
    return A;
}

void multiply_rows(const BlockCsr& A, int begin, int end, const double* x, double* y) {
    with_block_size(A.d, [&](auto d) { multiply_blocks<d>(A, begin, end, x, y); });
}

void multiply(const BlockCsr& A, const double* x, double* y) {
    constexpr int rows = 128;
    parallel_for((A.n + rows - 1) / rows,
                 [&](int b) { multiply_rows(A, b * rows, std::min(A.n, (b + 1) * rows), x, y); }, 10 * rows);
}

// The largest of several numbers does not depend on their order, so the reduction gives the same bits for any number of
// threads.
double norm_inf(const BlockCsr& A) {
    const auto of_row = [&A](int i) {
        double largest = 0;
        for (int r = 0; r < A.d; ++r) {
            double sum = 0;
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                for (int c = 0; c < A.d; ++c) sum += std::abs(A.block(k)[r * A.d + c]);
            largest = std::max(largest, sum);
        }
        return largest;
    };
    double largest = 0;
    if (!team_helps(A.value.size() >= 10.0 * parallel_work)) {
        for (int i = 0; i < A.n; ++i) largest = std::max(largest, of_row(i));
        return largest;
    }
#pragma omp parallel for schedule(static) reduction(max : largest)
    for (int i = 0; i < A.n; ++i) largest = std::max(largest, of_row(i));
    return largest;
}

double scaled_residual(const BlockCsr& A, double A_norm, const std::vector<double>& x, const std::vector<double>& b,
                       std::vector<double>& residual) {
    multiply(A, x.data(), residual.data());
    subtract(A.size(), b.data(), residual.data(), residual.data());
    const double largest = norm_inf(residual), scale = A_norm * norm_inf(x) + norm_inf(b);
    if (!std::isfinite(largest) || !std::isfinite(scale)) return std::numeric_limits<double>::quiet_NaN();
    return scale > 0 ? largest / scale : largest;
}

double scaled_residual(const BlockCsr& A, const std::vector<double>& x, const std::vector<double>& b) {
    std::vector<double> residual(b.size());
    return scaled_residual(A, norm_inf(A), x, b, residual);
}

RowOrder row_order(std::vector<int> node, std::vector<int> start) {
    if (start.empty()) start = {0, static_cast<int>(node.size())};
    std::vector<int> row = inverse(node);
    return {std::move(node), std::move(row), std::move(start)};
}

BlockCsr ordered_pattern(const BlockCsr& pattern, std::shared_ptr<const RowOrder> order, LargeVector<int>& place) {
    const std::vector<int>&node = order->node, &row = order->row;
    BlockCsr A{pattern.n, pattern.d, {0}};
    const auto is_stored = [&](int v, int u) { return !order->in_half || row[u] < row[v]; };
    place.resize(pattern.col.size());
    for (int v : node) {
        A.row.push_back(A.row.back());
        for (int k = pattern.row[v]; k < pattern.row[v + 1]; ++k) A.row.back() += is_stored(v, pattern.col[k]);
    }
    A.col.resize(A.row.back());
    std::vector<int> source(A.col.size());  // block of the pattern for each block of A
    parallel_for(A.n, [&](int i) {
        const auto begin = source.begin() + A.row[i], end = source.begin() + A.row[i + 1];
        for (int k = pattern.row[node[i]], at = A.row[i]; k < pattern.row[node[i] + 1]; ++k)
            if (is_stored(node[i], pattern.col[k])) source[at++] = k;
            else place[k] = -1;
        std::sort(begin, end, [&](int a, int b) { return row[pattern.col[a]] < row[pattern.col[b]]; });
        std::transform(begin, end, A.col.begin() + A.row[i], [&](int k) { return row[pattern.col[k]]; });
        for (int k = A.row[i]; k < A.row[i + 1]; ++k) place[source[k]] = k;
    }, 500);
    A.order = std::move(order);
    return A;
}

void copy_values(const BlockCsr& A, const LargeVector<int>& place, BlockCsr& ordered) {
    ordered.value.resize(A.value.size());
    with_block_size(A.d, [&](auto d) {
        parallel_for(A.blocks(), [&](int k) { std::copy_n(A.block(k), d * d, ordered.block(place[k])); });
    });
}

BlockCsr reordered(const BlockCsr& A, const RowOrder& order) {
    LargeVector<int> place;
    BlockCsr B = ordered_pattern(A, std::make_shared<RowOrder>(order), place);
    copy_values(A, place, B);
    return B;
}

void to_rows(const BlockCsr& A, const std::vector<double>& of_nodes, std::vector<double>& of_rows) {
    of_rows.resize(A.size());
    parallel_for(A.n, [&](int i) { std::copy_n(&of_nodes[offset(A.node_of(i), A.d)], A.d, &of_rows[offset(i, A.d)]); });
}

void to_nodes(const BlockCsr& A, const std::vector<double>& of_rows, std::vector<double>& of_nodes) {
    of_nodes.resize(A.size());
    parallel_for(A.n, [&](int i) { std::copy_n(&of_rows[offset(i, A.d)], A.d, &of_nodes[offset(A.node_of(i), A.d)]); });
}

}  // namespace almesh
