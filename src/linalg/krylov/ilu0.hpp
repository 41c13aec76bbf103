// Incomplete factorisation without fill of a symmetric positive definite matrix, ILU(0) on its d x d blocks in the
// symmetric form
//     A ~ C (I + L) (I + L') C',   L strictly lower triangular with the pattern of A, C block diagonal
// (Saad, Iterative Methods for Sparse Linear Systems, 2003, sections 10.3 and 10.6), with half the storage of L U.
//
// The matrix is ordered by domains, separators last (ordering/ordering.hpp), so that domains are factored and swept in
// parallel, with one barrier before and one after the separators; inside a domain, reverse Cuthill-McKee keeps the
// factor accurate. The blocks of a separator's row in the columns of a domain are swept with that domain, which leaves
// little work to a single thread.
// SSOR is the same without the products: C_i C_i' = A_ii, L_ij = C_i^{-1} A_ij C_j^{-T}, so that with A = D + T + T', T
// strictly lower triangular, the preconditioner is (D + T) D^{-1} (D + T') (Saad, section 10.2). It exists and is
// positive definite whenever the diagonal blocks are, for every stretched or nearly singular matrix of the projected
// Hessian; it costs one pass over A to set up, and needs no list of products. As A consists of the same parts,
// conjugate gradients need no product with it: A z takes part in the next forward sweep (puts_off_products()). A
// correction by fewer unknowns can stand between its two sweeps (coarse_correction.hpp). With deflation it takes up to
// 40 % more iterations than ILU(0) on tetrahedra, the fewer the larger the mesh, each at half the traffic.
//
// C carries the units of A, so the entries of L are of order one and are stored in single precision: the sweeps move
// half the bytes.
// Cost: O(sum over rows of neighbours^2 d^3) to factor, two passes over L to apply. Memory: L, half a matrix in single
// precision, and 8 bytes per triangle (3-clique) of the graph: little for linear elements, more than the matrix for
// those of degree 6 and 7. Of a matrix of which half is stored SSOR makes L in the place of
// the blocks below the diagonal.
#pragma once
#include <memory>
#include <vector>

#include "linalg/krylov/coarse_correction.hpp"
#include "linalg/krylov/krylov.hpp"

namespace almesh {

enum class Sweeps {
    ilu0,
    ssor,
    ilu0_or_ssor  // SSOR where no shift gives ILU(0) positive pivots
};

// z = (C (I + L) (I + L') C')^{-1} r; r'z is the squared norm of the vector between the sweeps, and r and z may be the
// same array. With SSOR A z comes with the pass over L that the next forward sweep makes anyway (puts_off_products()).
// Its factor() ends as indefinite_preconditioner where a pivot block is not positive definite or not finite, with every
// shift; as not_positive_definite where the correction's matrix is not, and so A is not.
//
// pattern: symmetric with both triangles and the diagonal, d = 1, 2, 3; or half of it, with Sweeps::ssor, which
// must outlive this. start: domain k has the rows start[k] .. start[k+1]-1 and the separators those from start.back()
// on; no edge may join two domains. Empty: all is one domain. diagonal_shifts: what is factored is A with its diagonal
// blocks times 1 + shift, for the first of these shifts that gives positive pivots; SSOR takes none. correction:
// between the sweeps of Sweeps::ssor, or null.
std::unique_ptr<Preconditioner> make_ilu0(const BlockCsr& pattern, std::vector<int> start = {},
                                          std::vector<double> diagonal_shifts = {0}, Sweeps sweeps = Sweeps::ilu0,
                                          std::unique_ptr<CoarseCorrection> correction = nullptr);

}  // namespace almesh
