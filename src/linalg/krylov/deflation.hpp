// The soft part of a symmetric positive definite matrix, solved exactly on a coarse space, for preconditioners such as
// ILU(0) that only see a few neighbours: a mesh that is hardly held moves almost as a rigid body, and without the
// coarse space conjugate gradients need an iteration for every layer of elements such a motion has to cross.
//
// The nodes are put into groups of neighbours, and the coarse space is that of vectors constant on each of them: Z has
// the d x d identity in block (i, group of i). Deflation (Nicolaides, SIAM J. Numer. Anal. 24, 1987) turns a
// preconditioner M^{-1} into
//     (I - Z E^{-1} Z'A) M^{-1} + Z E^{-1} Z',   E = Z'A Z
// ("A-DEF2" of Tang, Nabben, Vuik, Erlangga, J. Sci. Comput. 39, 2009, which is safe against rounding). It needs r and
// z = M^{-1} r only: z + Z c with c = E^{-1} Z'(r - A z), and Z'A is A with the rows of each group added up.
// Iterations must start from an x with Z'(b - A x) = 0.
//
// Cost: one pass over A to set up, and in every iteration one over Z'A, a sixth of A, beside the solve with E.
#pragma once
#include <vector>

#include "base/large_array.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/direct/cholesky.hpp"

namespace almesh {

class Deflation {
public:
    // pattern: of all matrices to come, symmetric with both triangles and the diagonal, d = 1, 2, 3; near rows should
    // have near columns (domains.hpp).
    explicit Deflation(const BlockCsr& pattern);

    int groups() const { return E_.n; }

    // A: the values, on the pattern given to the constructor. False where E, and with it A, is not positive definite.
    bool factor(const BlockCsr& A);

    // Makes c = E^{-1} Z'(r - A z), z = nullptr for zero, and returns r'Z c. r, z: n*d. Called by all threads of a
    // parallel region together; all have c when it returns.
    double solve_in_team(const double* r, const double* z);

    // The d entries of Z c at node i.
    const double* correction(int i) const { return c_.data() + static_cast<std::size_t>(group_[i]) * E_.d; }

private:
    template <int d>
    void add_up_rows(const BlockCsr& A);
    template <int d>
    void restrict_residual(const double* r, const double* z);

    std::vector<int> group_;                     // of each node
    std::vector<int> member_start_{0}, member_;  // nodes of group g: member_[member_start_[g] .. member_start_[g+1])
    std::vector<int> row_{0}, col_;              // pattern of Z'A: a block row per group, a block column per node
    LargeVector<double> value_;                  // d*d per block, row-major
    std::vector<int> place_;                     // block of Z'A for every block of A
    std::vector<int> coarse_place_;              // block of E for every block of Z'A
    BlockCsr E_;
    Cholesky factor_;
    std::vector<double> r_, c_;  // groups*d: Z'r, c
    double rZc_ = 0;
};

}  // namespace almesh
