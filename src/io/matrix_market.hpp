// Symmetric sparse matrices and right-hand sides in the Matrix Market exchange format (Boisvert, Pozo & Remington, The
// Matrix Market Exchange Formats: Initial Design, NISTIR 5935, 1996).
//
//   %%MatrixMarket matrix coordinate real symmetric
//   % comments
//   3 3 4          rows, columns, entries
//   1 1 2.5        row and column from 1, value; of a symmetric matrix the lower triangle
//
// Cost of reading: a sort of the entries.
#pragma once
#include <string>
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

// Reads `coordinate real|integer symmetric|general`; a general matrix must have A_ij = A_ji exactly. d in 1..3
// consecutive rows become one block row; all diagonal blocks are in the pattern. Throws InputError "path:line: message"
// for everything that is not such a matrix (repeated entries and numbers that are not finite included), UsageError
// where d does not divide the number of rows.
BlockCsr read_matrix_market(const std::string& path, int d = 1);

// Reads `array real|integer general`, rows x 1. Throws InputError as above, also for another number of rows.
std::vector<double> read_matrix_market_vector(const std::string& path, int rows);

// The lower triangle of the symmetric A, zeros of its pattern included; reads back to the same bits.
std::string matrix_market_text(const BlockCsr& A);
std::string matrix_market_text(const std::vector<double>& b);  // a column

}  // namespace almesh
