// Deflation: the low-energy modes of a weakly constrained mesh are solved for on a coarse space, for preconditioners
// such as ILU(0) that only couple near nodes. Such a mesh moves almost as a rigid body, and without the coarse space
// conjugate gradients need an iteration for every layer of elements that this motion has to cross.
//
// The nodes are put into groups of neighbours, and the coarse space is that of vectors constant on each of them: Z has
// the d x d identity in block (i, group of i). Deflation (Nicolaides, SIAM J. Numer. Anal. 24, 1987) turns a
// preconditioner M^{-1} into
//     (I - Z E^{-1} Z'A) M^{-1} + Z E^{-1} Z',   E = Z'A Z
// ("A-DEF2" of Tang, Nabben, Vuik, Erlangga, J. Sci. Comput. 39, 2009, which is robust against rounding). It needs r,
// z = M^{-1} r and A z, which conjugate gradients need anyway: z + Z c with c = E^{-1} Z'(r - A z), and A z + (A Z) c,
// where A Z is A with the columns of each group added up.
// Conjugate gradients must start from an x with Z'(b - A x) = 0.
//
// A preconditioner that puts A z off (krylov.hpp) has Z'A z from (A Z)' z; the correction is then added to that A z.
//
// Cost: one pass over A to set up; in every iteration one over A Z, a sixth of A, or two where A z is put off, and the
// solve with E.
#pragma once
#include <memory>
#include <vector>

#include "linalg/direct/cholesky.hpp"
#include "linalg/krylov/krylov.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh {

class CoarseSpace {
public:
    // pattern: of all matrices to come, symmetric with both triangles and the diagonal, d = 1, 2, 3; near rows should
    // have near columns (cut_into_domains() in ordering/ordering.hpp). in_single: A Z is stored in single precision,
    // for preconditioners that have A itself in no other.
    explicit CoarseSpace(const BlockCsr& pattern, bool in_single = false);

    int groups() const { return E_.n; }
    int group(int node) const { return group_[node]; }

    // A: the values, on the pattern given to the constructor. not_positive_definite: E is not, and so A is not.
    FactorResult factor(const BlockCsr& A);

    // With c = E^{-1} Z'(r - A z): z += Z c and Az += A Z c; returns r'Z c. r, z, Az: n*d. Called by all threads of a
    // team; all have the results when it returns.
    double correct(const double* r, double* z, double* Az);

    // The same where A z is put off: to Az only (A Z) c is added, and of_z becomes that of the new z.
    void correct_put_off(const double* r, double* z, double* Az, Products& of_z);

    // The same for z = 0, added to x.
    double correct_start(const double* r, double* x);

private:
    static constexpr int parts = 16;  // of the nodes, for sums that do not depend on the number of threads

    template <int d, class Number>
    void add_up(const BlockCsr& A, Number* AZ);
    template <int d, class Number>
    void add_transposed(const Number* AZ, const double* z);
    void sum_up_parts();
    void sum_up_groups(const double* v, std::vector<double>& sums);
    void solve(const double* r);
    void add_to(double* z, double* Az) const;
    template <class Body>
    void with_values(const Body& body) const;

    std::vector<int> group_;         // of each node
    BlockCsr E_;
    Groups members_ = sorted_by_group(group_, groups());  // nodes of each group
    BlockCsr AZ_;                    // A Z: a block row per node, a block column per group; its values here or in
    LargeVector<float> single_;
    bool in_single_;
    std::vector<int> place_;         // block of A Z for every block of A
    std::vector<int> coarse_place_;  // block of E for every block of A Z
    Cholesky factor_{E_};
    std::vector<Four> part_sum_ = std::vector<Four>(offset(parts, groups()));     // parts x groups: of (A Z)' z
    std::vector<double> r_ = std::vector<double>(E_.size()), Az_ = r_, c_ = r_;  // groups*d: Z'r, Z'A z, c
    double rZc_ = 0, AzZc_ = 0;      // r'Z c, (A z)'Z c
};

// A preconditioner and a coarse space together.
class Deflated final : public Preconditioner {
public:
    Deflated(std::unique_ptr<Preconditioner> M, std::unique_ptr<CoarseSpace> coarse);

    FactorResult factor(const BlockCsr& A) override;
    double apply(const double* r, double* z) override { return apply_and_multiply(*A_, r, z, Az_.data()); }
    double apply_and_multiply(const BlockCsr& A, const double* r, double* z, double* Az) override;
    bool puts_off_products() const override { return M_->puts_off_products(); }
    Products apply_and_put_off(const double* r, double* z, double* Az) override;
    Products advance(double alpha, double beta, double* q, double* r, double* z, double* Az) override;
    double correct_start(const double* r, double* x) override;  // so that Z'(b - A x) = 0

private:
    std::unique_ptr<Preconditioner> M_;
    std::unique_ptr<CoarseSpace> coarse_;
    const BlockCsr* A_ = nullptr;   // of factor()
    std::vector<double> Az_;        // for apply()
};

}  // namespace almesh
