// The pattern comes from the cells around each node, row by row; products keep the partial sums of a row in registers.
#include "linalg/block_csr.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

int BlockCsr::find(int i, int j) const {
    const auto begin = col.begin() + row[i], end = col.begin() + row[i + 1];
    const auto it = std::lower_bound(begin, end, j);
    return it != end && *it == j ? static_cast<int>(it - col.begin()) : -1;
}

namespace {

// The inverse of `cells`: node i is cells[at[k]] for k = start[i] .. start[i+1]-1, at ascending.
struct NodeCells {
    std::vector<int> start, at;
};

NodeCells cells_of_nodes(int n, const std::vector<int>& cells) {
    NodeCells around{std::vector<int>(n + 1, 0), std::vector<int>(cells.size())};
    for (int node : cells) ++around.start[node + 1];
    for (int i = 0; i < n; ++i) around.start[i + 1] += around.start[i];
    std::vector<int> next(around.start.begin(), around.start.end() - 1);
    for (std::size_t k = 0; k < cells.size(); ++k) around.at[next[cells[k]]++] = static_cast<int>(k);
    return around;
}

constexpr int row_block = 1024;  // rows whose columns a thread collects at a time

BlockCsr pattern_of(int n, int d, const std::vector<int>& cells, int cell_nodes, const NodeCells& around) {
    BlockCsr A;
    A.n = n;
    A.d = d;
    A.row.assign(n + 1, 0);
    const int blocks = (n + row_block - 1) / row_block;
    std::vector<std::vector<int>> columns(blocks);  // of each block of rows
#pragma omp parallel if (n >= parallel_work)
    {
        std::vector<int> last_row(n, -1);  // row in which this thread met a column last
#pragma omp for schedule(static)
        for (int block = 0; block < blocks; ++block) {
            std::vector<int>& found = columns[block];
            for (int i = block * row_block, end = std::min(n, i + row_block); i < end; ++i) {
                const auto begin = static_cast<std::ptrdiff_t>(found.size());
                last_row[i] = i;
                found.push_back(i);
                for (int k = around.start[i]; k < around.start[i + 1]; ++k) {
                    const int* const cell = &cells[around.at[k] / cell_nodes * cell_nodes];
                    for (int b = 0; b < cell_nodes; ++b)
                        if (std::exchange(last_row[cell[b]], i) != i) found.push_back(cell[b]);
                }
                std::sort(found.begin() + begin, found.end());
                A.row[i + 1] = static_cast<int>(found.end() - found.begin() - begin);
            }
        }
    }
    for (int i = 0; i < n; ++i) A.row[i + 1] += A.row[i];
    A.col.resize(A.row[n]);
    parallel_for(blocks, [&](int block) {
        std::copy(columns[block].begin(), columns[block].end(), A.col.begin() + A.row[block * row_block]);
    }, 100.0 * row_block);
    return A;
}

}  // namespace

BlockCsr pattern_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes) {
    return pattern_of(n, d, cells, cell_nodes, cells_of_nodes(n, cells));
}

CellPattern pattern_and_places_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes) {
    const NodeCells around = cells_of_nodes(n, cells);
    CellPattern result{pattern_of(n, d, cells, cell_nodes, around), LargeVector<int>(cells.size() * cell_nodes)};
    const BlockCsr& A = result.pattern;
#pragma omp parallel if (n >= parallel_work)
    {
        std::vector<int> place_of(n);  // of each column of the current row
#pragma omp for schedule(static)
        for (int i = 0; i < n; ++i) {
            for (int k = A.row[i]; k < A.row[i + 1]; ++k) place_of[A.col[k]] = k;
            for (int k = around.start[i]; k < around.start[i + 1]; ++k) {
                const int* const cell = &cells[around.at[k] / cell_nodes * cell_nodes];
                int* const place = &result.place[offset(around.at[k], cell_nodes)];
                for (int b = 0; b < cell_nodes; ++b) place[b] = place_of[cell[b]];
            }
        }
    }
    return result;
}

BlockCsr matrix_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes) {
    BlockCsr A = pattern_of_cells(n, d, cells, cell_nodes);
    A.value.assign(A.col.size() * d * d, 0.0);
    return A;
}

namespace {

template <int d>
void multiply_blocks(const BlockCsr& A, int begin, int end, const double* x, double* y) {
    for (int i = begin; i < end; ++i) {
        SumOfProducts<d> sum;
        for (int k = A.row[i]; k < A.row[i + 1]; ++k) sum.add(A.block(k), x + offset(A.col[k], d));
        for (int r = 0; r < d; ++r) y[offset(i, d, r)] = sum.entry(r);
    }
}

}  // namespace

void multiply_rows(const BlockCsr& A, int begin, int end, const double* x, double* y) {
    if (A.d == 1) multiply_blocks<1>(A, begin, end, x, y);
    if (A.d == 2) multiply_blocks<2>(A, begin, end, x, y);
    if (A.d == 3) multiply_blocks<3>(A, begin, end, x, y);
}

void multiply(const BlockCsr& A, const double* x, double* y) {
    constexpr int rows = 128;
    parallel_for((A.n + rows - 1) / rows,
                 [&](int b) { multiply_rows(A, b * rows, std::min(A.n, (b + 1) * rows), x, y); }, 10 * rows);
}

// The largest of several numbers does not depend on their order, so the reduction gives the same bits for any number of
// threads.
double norm_inf(const BlockCsr& A) {
    double largest = 0;
#pragma omp parallel for schedule(static) reduction(max : largest)
    for (int i = 0; i < A.n; ++i)
        for (int r = 0; r < A.d; ++r) {
            double sum = 0;
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                for (int c = 0; c < A.d; ++c) sum += std::abs(A.block(k)[r * A.d + c]);
            largest = std::max(largest, sum);
        }
    return largest;
}

double scaled_residual(const BlockCsr& A, const std::vector<double>& x, const std::vector<double>& b) {
    std::vector<double> r(b.size());
    multiply(A, x.data(), r.data());
    subtract(A.size(), b.data(), r.data(), r.data());
    const double residual = norm_inf(r), scale = norm_inf(A) * norm_inf(x) + norm_inf(b);
    if (!std::isfinite(residual) || !std::isfinite(scale)) return std::numeric_limits<double>::quiet_NaN();
    return scale > 0 ? residual / scale : residual;
}

}  // namespace almesh
