// Incomplete LU factorisation without fill, ILU(0), on the d x d blocks of a BlockCsr: A ~ (L + I)(D + U) with the
// pattern of A (Saad, Iterative Methods for Sparse Linear Systems, 2003, section 10.3, row by row (IKJ)).
//
// Quality hangs on the numbering: number the nodes by reverse_cuthill_mckee() first. Cost: O(sum over rows of
// neighbours^2 d^3) to factor, one pass over the matrix to solve.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

enum class Ilu0Status { factored, zero_pivot };

struct Ilu0Result {
    Ilu0Status status;
    int bad_row;  // first block row whose pivot block is singular or not finite, -1 if factored
};

class Ilu0 {
public:
    // Sets up the pattern of A; every diagonal block must be in it. d = 1, 2, 3.
    explicit Ilu0(const BlockCsr& pattern);

    // A: the values, on the pattern given to the constructor. After zero_pivot, solve() must not be called.
    Ilu0Result factor(const BlockCsr& A);

    // x <- (D + U)^{-1} (L + I)^{-1} x, x: n*d.
    void solve(double* x) const;

private:
    template <int d>
    Ilu0Result factor_blocks(const BlockCsr& A);
    template <int d>
    void solve_blocks(double* x) const;

    BlockCsr LU_;                // L below the diagonal, U above it, the inverse of D on it
    std::vector<int> diagonal_;  // place of block (i, i)
    std::vector<int> place_;     // place of block (i, j) in the row i being factored, -1 where there is none
};

}  // namespace almesh
