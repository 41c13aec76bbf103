// Incomplete factorisation without fill of a symmetric positive definite matrix, ILU(0) on its d x d blocks in the
// symmetric form
//     A ~ C (I + L) (I + L') C',   L strictly lower triangular with the pattern of A, C block diagonal
// (Saad, Iterative Methods for Sparse Linear Systems, 2003, sections 10.3 and 10.6), with half the storage of L U.
//
// The matrix is ordered by domains, separators last (ordering/domains.hpp), so that domains are factored and swept in
// parallel, with one barrier before and one after the separators; inside a domain, reverse Cuthill-McKee keeps the
// factor accurate. The blocks of a separator's row in the columns of a domain are swept with that domain, which leaves
// little work to a single thread.
// C carries the units of A, so the entries of L are of order one and are stored in single precision: the sweeps move
// half the bytes.
// Cost: O(sum over rows of neighbours^2 d^3) to factor, two passes over L to apply. Memory: L, half a matrix in single
// precision, and 8 bytes per triangle (3-clique) of the graph: little for linear elements, more than the matrix for
// those of degree 6 and 7.
#pragma once
#include <cstddef>
#include <vector>

#include "base/lanes.hpp"
#include "base/large_array.hpp"
#include "linalg/krylov/preconditioner.hpp"

namespace almesh {

class Ilu0 final : public Preconditioner {
public:
    // Sets up the pattern of L. pattern: symmetric with both triangles and the diagonal, d = 1, 2, 3. start: domain k
    // has the rows start[k] .. start[k+1]-1 and the separators those from start.back() on; no edge may join two
    // domains. diagonal_shifts: what is factored is A with its diagonal blocks times 1 + shift, for the first of these
    // shifts that gives positive pivots.
    Ilu0(const BlockCsr& pattern, std::vector<int> start, std::vector<double> diagonal_shifts = {0});

    // The same as one domain.
    explicit Ilu0(const BlockCsr& pattern);

    // indefinite_preconditioner: a pivot block is not positive definite or not finite, with every shift.
    FactorResult factor(const BlockCsr& A) override;

    // z = (C (I + L) (I + L') C')^{-1} r; r'z is the squared norm of the vector between the sweeps. r and z may be the
    // same array.
    double apply(const double* r, double* z) override;

private:
    template <int d>
    int factor_rows(const BlockCsr& A, double diagonal_shift, int begin, int end, double* T);
    template <int d>
    int factor_blocks(const BlockCsr& A, double diagonal_shift);
    template <int d>
    void multiply_row(int begin, int end, Four& product) const;
    template <int d>
    double solve_row(int i, const double* r, const Four& sum);
    template <int d>
    void subtract_transposed(int begin, int end, const Four& y);
    template <int d>
    void finish_row(int i, double* z) const;
    template <int d>
    double sweep_forward(int domain, const double* r);
    template <int d>
    void sweep_backward(int domain, double* z);
    template <int d>
    double sweep_separators(const double* r, double* z);
    template <int d>
    double sweep(const double* r, double* z);

    void find_links();
    int rows() const { return static_cast<int>(row_.size()) - 1; }
    int domains() const { return static_cast<int>(start_.size()) - 1; }

    int d_;
    std::vector<int> start_;
    std::vector<double> diagonal_shifts_;
    std::vector<int> row_{0};            // n + 1 offsets into col_
    std::vector<int> col_;               // block columns of L, ascending within a row: the first ones of the row of A
    struct Term {
        int left, right;  // of a product T_ij' L_kj': its block of the row of T, from 0, and of L
    };
    std::vector<std::size_t> term_start_{0};  // the terms of block k: term_start_[k] .. term_start_[k+1]
    std::vector<Term> term_;
    // The blocks of a separator's row in the columns of one domain.
    struct Link {
        int row, begin, end;
    };
    std::vector<Link> link_;             // those of domain k: link_start_[k] .. link_start_[k+1]
    std::vector<int> link_start_{0};
    std::vector<Four> link_product_;     // of its blocks with y
    struct SeparatorRow {
        int first_link;                  // its links: link_of_row_[first_link] .. up to those of the next row
        int begin;                       // its blocks in columns of separators: begin .. up to the next row
    };
    std::vector<SeparatorRow> separator_row_;  // one more than rows
    std::vector<int> link_of_row_;
    LargeVector<float> L_;               // d*d per block, row-major
    std::vector<double> C_inverse_;      // d*d per row, lower triangular
    std::vector<Four> y_;                // n: the vector between the sweeps, d entries each and zeros
    std::vector<double> row_of_;         // d*d per block of the longest row, for each domain and the separators
    std::vector<double> squares_;        // of y over each domain and the separators
    std::vector<int> bad_;               // first bad row of each domain, or -1
    int longest_ = 0;                    // blocks of the longest row
};

}  // namespace almesh
