// A two-level p-multigrid: SSOR for elements of degree p, with a correction by displacements of degree 1 between its
// two sweeps. Sweeps go from neighbour to neighbour and are slow where A has low energy; what is left of the error
// after them is smooth, and seen by few unknowns. As in a V-cycle with a Gauss-Seidel sweep forward before the
// correction and one back after it (Trottenberg, Oosterlee, Schuller, Multigrid, 2001, section 2.4; degrees in place of
// meshes: Ronquist & Patera, J. Sci. Comput. 2, 1987), with the interpolation P from the vertices to all nodes, and
// z_1 = (D + T)^{-1} r the result of the first sweep,
//     E c = P'(r - A z_1),   E = P'A P,
// and the sweep back starts from z_1 + P c. E c = ... is solved by a few iterations of conjugate gradients with a
// preconditioner of its own, so the preconditioner made of all this is not quite the same in every iteration: conjugate
// gradients have to be flexible (krylov.hpp).
//
// SSOR has A = C (I + L + L') C' (ilu0.hpp) and z_1 = C^{-T} y. With V = C^{-1} A P
//     P'(r - A z_1) = P'r - V'y,   (I + L') w = y - V c,   z = C^{-T} w + P c,
//     r'z = |y|^2 + c'P'(r - A z_1),   z'A z = 2 w'y - w'w + c'E c,   A z = C (L w + y),
// so the correction adds two passes over V to those over L, and A z comes with the next sweep as without it. A row of V
// has eight blocks in degree 2 and six in degree 4, one of L fourteen and forty.
//
// Cost: one pass over A to set up, in which every block is multiplied by a row of P. Memory: V in single precision.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "linalg/krylov/krylov.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh {

class CoarseCorrection {
public:
    // Makes the preconditioner for matrices on the pattern E.
    using MakePreconditioner = std::function<std::unique_ptr<Preconditioner>(const BlockCsr& E)>;

    // pattern: of all matrices to come, symmetric with both triangles and the diagonal. P: pattern.n rows.
    CoarseCorrection(const BlockCsr& pattern, const Interpolation& P, const MakePreconditioner& make);

    // Where half of A is stored, before factor(), which then asks for the diagonal of A only: adds up A P in the rows
    // begin .. end-1 and, as far as these take part, in those before them, which have had their turn.
    void multiply_half(const BlockCsr& A, int begin, int end);

    // C_inverse: d x d per row, lower triangular. not_positive_definite: a pivot of E is not positive, and so A is not
    // positive definite.
    FactorResult factor(const BlockCsr& A, const double* C_inverse);

    // c as above and w = y - V c; returns c'P'(r - A z_1) as rz and c'E c as zAz, and whether E turned out not to be
    // positive definite. r: n*d. y, w: n, zeros in the pads of y. Called by all threads of a team; all have the results
    // when it returns.
    Products correct(const double* r, const Four* y, Four* w);

    // z += P c.
    void add_to(double* z) const;

private:
    static constexpr int parts = 16;  // of the rows, for sums that do not depend on the number of threads

    using Columns = std::vector<std::vector<int>>;  // of each row of A P

    CoarseCorrection(const Columns& AP, const Interpolation& P, int d, const MakePreconditioner& make);
    template <int d>
    void multiply_out(const BlockCsr& A, const double* C_inverse, int part);
    template <int d>
    void add_up_coarse(int row);
    template <int d>
    void restrict_part(const double* r, const Four* y, int part);
    template <int d>
    void prolong_part(const Four* y, Four* w, int part);
    int begin_of(int part) const { return static_cast<int>(static_cast<long long>(P_.rows()) * part / parts); }
    int touched(int part) const { return touched_start_[part + 1] - touched_start_[part]; }

    Interpolation P_;
    BlockCsr E_;
    std::unique_ptr<Preconditioner> M_;       // of E
    ConjugateGradients iteration_;
    // A part touches few of the coarse unknowns, and numbers them by itself: 0, 1, ... are those in coarse_ from
    // touched_start_[part] on.
    std::vector<int> touched_start_{0}, coarse_;
    std::vector<int> P_local_;                // the columns of P as the part of the row numbers them
    std::vector<int> V_row_{0}, V_local_;     // offsets of the rows of V; its columns, ascending, in the same way
    LargeVector<float> V_;                    // d*d per block, row-major
    std::vector<std::size_t> E_start_;        // for each place in coarse_: its row in E_part_
    LargeVector<double> E_part_;              // what the rows of a part add to E
    Groups touching_;                         // places in coarse_ of each coarse unknown
    std::vector<Four> sum_, c_part_;          // for each place in coarse_: P'r - V'y of the part; c
    std::vector<double> r_ = std::vector<double>(E_.size()), c_ = r_;  // of the coarse unknowns
    TeamSum rc_{E_.size()};
};

}  // namespace almesh
