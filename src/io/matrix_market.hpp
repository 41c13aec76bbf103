// Symmetric sparse matrices and right-hand sides in the Matrix Market exchange format (Boisvert, Pozo & Remington, The
// Matrix Market Exchange Formats: Initial Design, NISTIR 5935, 1996).
//
//   %%MatrixMarket matrix coordinate real symmetric
//   3 3 4          rows, columns, entries
//   1 1 2.5        row and column from 1, value; the lower triangle
#pragma once
#include <string>
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

// The lower triangle of the symmetric A, zeros of its pattern included, each number with 17 digits.
std::string matrix_market_text(const BlockCsr& A);
std::string matrix_market_text(const std::vector<double>& b);  // a column

}  // namespace almesh
