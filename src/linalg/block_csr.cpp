#include "linalg/block_csr.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"

namespace almesh {

int BlockCsr::find(int i, int j) const {
    const auto begin = col.begin() + row[i], end = col.begin() + row[i + 1];
    const auto it = std::lower_bound(begin, end, j);
    return it != end && *it == j ? static_cast<int>(it - col.begin()) : -1;
}

BlockCsr matrix_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes) {
    const int cell_count = cell_nodes ? static_cast<int>(cells.size()) / cell_nodes : 0;
    std::vector<int> start(n + 1, 0), cell_of(cells.size());  // cells around each node, in CSR form
    for (int node : cells) ++start[node + 1];
    for (int i = 0; i < n; ++i) start[i + 1] += start[i];
    std::vector<int> next(start.begin(), start.end() - 1);
    for (int c = 0; c < cell_count; ++c)
        for (int a = 0; a < cell_nodes; ++a) cell_of[next[cells[c * cell_nodes + a]]++] = c;

    BlockCsr A;
    A.n = n;
    A.d = d;
    A.row.assign(n + 1, 0);
    std::vector<int> last_row(n, -1);  // last_row[j] == i: column j already stands in row i
    for (int i = 0; i < n; ++i) {
        const int begin = static_cast<int>(A.col.size());
        A.col.push_back(i);
        last_row[i] = i;
        for (int k = start[i]; k < start[i + 1]; ++k)
            for (int a = 0; a < cell_nodes; ++a) {
                const int j = cells[cell_of[k] * cell_nodes + a];
                if (last_row[j] != i) A.col.push_back(j);
                last_row[j] = i;
            }
        std::sort(A.col.begin() + begin, A.col.end());
        A.row[i + 1] = static_cast<int>(A.col.size());
    }
    A.value.assign(A.col.size() * d * d, 0.0);
    return A;
}

namespace {

template <int d>
void multiply_blocks(const BlockCsr& A, const double* x, double* y) {
    parallel_for(A.n, [&](int i) {
        double sum[d] = {};
        for (int k = A.row[i]; k < A.row[i + 1]; ++k) {
            const double* block = A.block(k);
            const double* xj = x + static_cast<std::size_t>(A.col[k]) * d;
            for (int r = 0; r < d; ++r)
                for (int c = 0; c < d; ++c) sum[r] += block[r * d + c] * xj[c];
        }
        for (int r = 0; r < d; ++r) y[static_cast<std::size_t>(i) * d + r] = sum[r];
    });
}

}  // namespace

void multiply(const BlockCsr& A, const double* x, double* y) {
    if (A.d == 1) multiply_blocks<1>(A, x, y);
    if (A.d == 2) multiply_blocks<2>(A, x, y);
    if (A.d == 3) multiply_blocks<3>(A, x, y);
}

double norm_1(const BlockCsr& A) {
    std::vector<double> column(A.size(), 0.0);
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            for (int r = 0; r < A.d; ++r)
                for (int c = 0; c < A.d; ++c) column[A.col[k] * A.d + c] += std::abs(A.block(k)[r * A.d + c]);
    return column.empty() ? 0.0 : *std::max_element(column.begin(), column.end());
}

double scaled_residual(const BlockCsr& A, const std::vector<double>& x, const std::vector<double>& b) {
    std::vector<double> r(b.size());
    multiply(A, x.data(), r.data());
    double residual = 0, x_max = 0, b_max = 0;
    bool finite = true;
    for (std::size_t i = 0; i < b.size(); ++i) {
        finite = finite && std::isfinite(r[i]) && std::isfinite(x[i]);
        residual = std::max(residual, std::abs(r[i] - b[i]));
        x_max = std::max(x_max, std::abs(x[i]));
        b_max = std::max(b_max, std::abs(b[i]));
    }
    const double scale = norm_1(A) * x_max + b_max;
    if (!finite || !std::isfinite(scale)) return std::numeric_limits<double>::quiet_NaN();
    return scale > 0 ? residual / scale : residual;
}

}  // namespace almesh
