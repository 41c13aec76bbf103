// Incomplete factorisation without fill of a symmetric positive definite matrix, ILU(0) on its d x d blocks in the
// symmetric form
//     P A P' ~ C (I + L) (I + L') C',   L strictly lower triangular with the pattern of P A P', C block diagonal
// (Saad, Iterative Methods for Sparse Linear Systems, 2003, sections 10.3 and 10.6), with half the storage of L U.
//
// P numbers the nodes domain by domain, separators last (domains.hpp), so that domains are factored and swept in
// parallel, with one wait before and one after the separators; inside, reverse Cuthill-McKee keeps the factor accurate.
// C carries the units of A, so L is of order one and is kept in single precision: the sweeps move half the bytes.
// Cost: O(sum over rows of neighbours^2 d^3) to factor, two passes over L to solve.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"
#include "linalg/domains.hpp"

namespace almesh {

enum class Ilu0Status {
    factored,
    not_positive_definite  // a pivot block is not, or is not finite; A may be positive definite all the same
};

struct Ilu0Result {
    Ilu0Status status;
    int bad_row;  // block row of the first such pivot in elimination order, -1 if factored
};

class Ilu0 {
public:
    // Orders the nodes and sets up the pattern of L. pattern: symmetric with both triangles and the diagonal, d = 1, 2, 3.
    explicit Ilu0(const BlockCsr& pattern);

    // The same in an order of the caller's: no edge may join two domains.
    Ilu0(const BlockCsr& pattern, Domains domains);

    // A: the values, on the pattern given to the constructor. Afterwards solve() may be called if the status is factored.
    Ilu0Result factor(const BlockCsr& A);

    // z = (C (I + L) (I + L') C')^{-1} r in the numbering of A; r, z: n*d, and they may be the same array.
    void solve(const double* r, double* z);

    // The same, called by all threads of a parallel region together; all have z when it returns.
    void solve_in_team(const double* r, double* z);

private:
    template <int d>
    int factor_rows(const BlockCsr& A, int begin, int end, double* T);
    template <int d>
    void factor_blocks(const BlockCsr& A);
    template <int d>
    void sweep_forward(int begin, int end, const double* r);
    template <int d>
    void sweep_backward(int begin, int end, double* z);
    template <int d>
    void sweep(const double* r, double* z);

    int d_;
    Domains domains_;
    std::vector<int> row_{0};            // n + 1 offsets into col_
    std::vector<int> col_;               // block columns of L, new numbers, ascending within a row
    std::vector<int> source_;            // block of A for each block of L
    std::vector<int> diagonal_;          // block (i, i) of A for each new row
    std::vector<float> L_;               // d*d per block, row-major
    std::vector<double> C_inverse_;      // d*d per row, lower triangular
    std::vector<double> y_;              // n*d, new numbers: the vector between the sweeps
    std::vector<double> row_of_;         // d*d per block of the longest row, for each domain and the separators
    std::vector<int> bad_;               // first bad row of each domain and of the separators, or -1
    int longest_ = 0;                    // blocks of the longest row
};

}  // namespace almesh
