// Sparse matrices in compressed sparse row format with dense d x d blocks, one block row per mesh node and
// d = space dimension (d = 1 is ordinary CSR).
//
// Block row i holds the blocks k = row[i] .. row[i+1]-1 in the block columns col[k], ascending and without repeats;
// block k is value[k*d*d .. (k+1)*d*d), row-major. Symmetric matrices store both triangles.
#pragma once
#include <cstddef>
#include <vector>

#include "base/large_array.hpp"

namespace almesh {

struct BlockCsr {
    int n = 0;                  // block rows = block columns
    int d = 1;                  // block size
    std::vector<int> row;       // n + 1 offsets into col
    std::vector<int> col;       // block columns, ascending within a row
    LargeVector<double> value;  // d*d per block

    int blocks() const { return static_cast<int>(col.size()); }
    int size() const { return n * d; }
    double* block(int k) { return value.data() + static_cast<std::size_t>(k) * d * d; }
    const double* block(int k) const { return value.data() + static_cast<std::size_t>(k) * d * d; }

    // Place of block (i, j), or -1 where the pattern has none.
    int find(int i, int j) const;
};

// Pattern in which all nodes of a cell are neighbours: the union over all cells of cell x cell, plus the diagonal.
// cells: cell_count x cell_nodes node indices in [0, n). Without values: A.value is empty.
BlockCsr pattern_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes);

// The same, with the place of every block of each cell: place[(c cell_nodes + a) cell_nodes + b] is that of block
// (node a of cell c, node b of cell c).
struct CellPattern {
    BlockCsr pattern;
    LargeVector<int> place;  // cell x cell node x cell node
};
CellPattern pattern_and_places_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes);

// The pattern with all values zero.
BlockCsr matrix_of_cells(int n, int d, const std::vector<int>& cells, int cell_nodes);

// y = A x (x, y: n*d). Same bits for any number of threads.
void multiply(const BlockCsr& A, const double* x, double* y);

// Block rows begin .. end-1 of it, by the calling thread alone.
void multiply_rows(const BlockCsr& A, int begin, int end, const double* x, double* y);

double norm_1(const BlockCsr& A);  // largest column sum of absolute values

// |Ax - b|_inf / (|A|_1 |x|_inf + |b|_inf): a few machine epsilons for a backward-stable solve (CSparse); nan
// where a number is not finite.
double scaled_residual(const BlockCsr& A, const std::vector<double>& x, const std::vector<double>& b);

}  // namespace almesh
