// Sparse matrices in compressed sparse row format with dense d x d blocks, one block row per mesh node and
// d = space dimension (d = 1 is ordinary CSR).
//
// Block row i holds the blocks k = row[i] .. row[i+1]-1 in the block columns col[k], ascending and without repeats;
// block k is value[k*d*d .. (k+1)*d*d), row-major. Symmetric matrices store both triangles; or half of it, in a quarter
// of the memory: the blocks below the diagonal in single precision, and the diagonal.
#pragma once
#include <algorithm>
#include <memory>
#include <type_traits>
#include <vector>

#include "base/index.hpp"
#include "base/lanes.hpp"
#include "base/large_array.hpp"

namespace almesh {

// An interpolation P from few unknowns, the columns, to those of a matrix's rows: row i has weight[k] times the d x d
// identity in the columns col[k], k = row[i] .. row[i+1]-1.
struct Interpolation {
    int columns = 0;
    std::vector<int> row{0}, col;
    std::vector<double> weight;

    int rows() const { return static_cast<int>(row.size()) - 1; }
};

// An order of the block rows other than that of the mesh's nodes: the one in which a solver sweeps over them.
//
// A mesh generator's numbering has the neighbours of a node anywhere in memory. Iterative solvers pass over the matrix
// dozens of times, so they want one in which rows that are near have near columns, and domains for several threads to
// sweep over: no edge joins two of them, and only the separators, numbered last, have to wait for all.
struct RowOrder {
    std::vector<int> node;   // of each row
    std::vector<int> row;    // of each node
    std::vector<int> start;  // domain k has the rows start[k] .. start[k+1]-1; the separators those from the last on
    // From the vertices to the rows, and the domains of the vertices; no columns where all nodes are vertices.
    Interpolation of_vertices = {};
    std::vector<int> vertex_start = {};
    bool in_half = false;  // of matrices in this order half is stored
};

// node: a permutation. Without `start`, all rows are one domain.
RowOrder row_order(std::vector<int> node, std::vector<int> start = {});

struct BlockCsr {
    int n = 0;                  // block rows = block columns
    int d = 1;                  // block size
    std::vector<int> row = {};       // n + 1 offsets into col
    std::vector<int> col = {};       // block columns, ascending within a row
    LargeVector<double> value = {};  // d*d per block
    std::shared_ptr<const RowOrder> order = {};  // none: row i is that of node i
    // Where half is stored the blocks of the pattern, those below the diagonal, and three numbers more; value has the
    // diagonal. Copies share it, and the preconditioner, which puts its factor there.
    std::shared_ptr<LargeVector<float>> below = {};

    int row_of(int node) const { return order ? order->row[node] : node; }
    int node_of(int row_) const { return order ? order->node[row_] : row_; }
    int blocks() const { return static_cast<int>(col.size()); }
    int size() const { return n * d; }
    double* block(int k) { return value.data() + offset(k, d * d); }
    const double* block(int k) const { return value.data() + offset(k, d * d); }
    bool in_half() const { return order && order->in_half; }
    float* block_below(int k) const { return below->data() + offset(k, d * d); }
    double* diagonal(int i) { return block(in_half() ? i : find(i, i)); }
    const double* diagonal(int i) const { return block(in_half() ? i : find(i, i)); }
    void set_zero();  // all values, for which it makes room

    // change(block (i, j) of the pattern); nothing above the diagonal where half is stored.
    template <class Change>
    void change_block(int i, int j, const Change& change) {
        if (i == j || !in_half()) return change(i == j ? diagonal(i) : block(find(i, j)));
        if (i < j) return;
        float* const stored = block_below(find(i, j));
        double values[9];
        std::copy_n(stored, d * d, values);
        change(values);
        std::transform(values, values + d * d, stored, [](double entry) { return static_cast<float>(entry); });
    }

    // Place of block (i, j), or -1 where the pattern has none.
    int find(int i, int j) const;
};

// Calls body(std::integral_constant<int, d>()) for d = 1, 2 or 3: loops over a block have a length known when compiled.
template <class Body>
void with_block_size(int d, const Body& body) {
    if (d == 1) body(std::integral_constant<int, 1>());
    if (d == 2) body(std::integral_constant<int, 2>());
    if (d == 3) body(std::integral_constant<int, 3>());
}

// Pattern in which all nodes of a cell are neighbours: the union over all cells of cell x cell, plus the diagonal.
// cells: cell_count x cell_nodes node indices in [0, n). A.value is empty. place: on return, block (node a of cell c,
// node b of cell c) is block place[(c cell_nodes + a) cell_nodes + b] of A.
BlockCsr pattern_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes,
                          LargeVector<int>* place = nullptr);

// The union of patterns of one size; place[k][b]: where block b of pattern k is in it.
BlockCsr joint_pattern(const std::vector<const BlockCsr*>& patterns, std::vector<LargeVector<int>>& place);

// The pattern with all values zero.
BlockCsr matrix_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes);

// The pattern with rows and columns in the given order, without values; place[k]: where block k is then, -1 for those
// that are not stored.
BlockCsr ordered_pattern(const BlockCsr& pattern, std::shared_ptr<const RowOrder> order, LargeVector<int>& place);

// The values of A to their places in the pattern made of A's.
void copy_values(const BlockCsr& A, const LargeVector<int>& place, BlockCsr& ordered);

// Both: P A P' for the permutation P of the nodes.
BlockCsr reordered(const BlockCsr& A, const RowOrder& order);

// A vector with the entries of A's rows, from one with those of the nodes, and back.
void to_rows(const BlockCsr& A, const std::vector<double>& of_nodes, std::vector<double>& of_rows);
void to_nodes(const BlockCsr& A, const std::vector<double>& of_rows, std::vector<double>& of_nodes);

// y = A x (x, y: n*d). Same bits for any number of threads.
void multiply(const BlockCsr& A, const double* x, double* y);

// Block rows begin .. end-1 of it, by the calling thread alone.
void multiply_rows(const BlockCsr& A, int begin, int end, const double* x, double* y);

// The sum over k of B_k x_k, B_k d x d row-major, of doubles or floats, for d = 1, 2, 3. One partial sum per column of
// the blocks, so that no addition waits for the one before it.
template <int d>
class SumOfProducts {
public:
    template <class Number>
    void add(const Number* B, const double* x) {
        for (int r = 0; r < d; ++r)
            for (int c = 0; c < d; ++c) sum_[r][c] += B[r * d + c] * x[c];
    }
    double entry(int r) const {
        double sum = 0;
        for (int c = 0; c < d; ++c) sum += sum_[r][c];
        return sum;
    }

private:
    double sum_[d][d] = {};
};

// A row of three in a register of four: rows 0 and 1 with the number after, row 2 with the number before it, so that
// nothing outside B is read. That number is multiplied by a zero pad.
template <>
class SumOfProducts<3> {
public:
    template <class Number>
    void add(const Number* B, const double* x) {
        const Four first = {x[0], x[1], x[2], 0}, last = {0, x[0], x[1], x[2]};
        Four row[3];
        load(B, row[0]);
        load(B + 3, row[1]);
        load(B + 5, row[2]);
        sum_[0] += row[0] * first;
        sum_[1] += row[1] * first;
        sum_[2] += row[2] * last;
    }
    double entry(int r) const { return sum_[r][r / 2] + sum_[r][r / 2 + 1] + sum_[r][r / 2 + 2]; }

private:
    Four sum_[3] = {};
};

double norm_inf(const BlockCsr& A);  // largest row sum of absolute values; |A|_1 of a symmetric A

// |b - A x|_inf / (|A|_inf |x|_inf + |b|_inf): a few machine epsilons for a backward-stable solve (CSparse); nan
// where a number is not finite. A_norm: |A|_inf. residual <- b - A x.
double scaled_residual(const BlockCsr& A, double A_norm, const std::vector<double>& x, const std::vector<double>& b,
                       std::vector<double>& residual);
double scaled_residual(const BlockCsr& A, const std::vector<double>& x, const std::vector<double>& b);

}  // namespace almesh
