// Krylov methods: conjugate gradients and GMRES, what they share, and the interface of preconditioners z = M^{-1} r
// with M near A, symmetric positive definite for conjugate gradients and nonsingular for GMRES.
//
// A Krylov method runs in one team of threads, all of which call apply() together. Its loops are therefore work-sharing
// loops, `#pragma omp for` without a `parallel` around them, which a thread that calls it outside of a team runs alone.
// To add a preconditioner, derive from Preconditioner and construct it in make_preconditioner() of linear_solver.cpp.
#pragma once
#include <algorithm>
#include <vector>

#include "base/index.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/solve_status.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

struct KrylovResult {
    SolveStatus status;
    int iterations;            // products with A
    double relative_residual;  // |b - A x|_2 / |b|_2, computed from the x returned
};

// An iteration stagnates if the residual norm has not halved in the last twenty iterations. At that rate a reduction by
// 1e-8 takes more than five hundred, in which time a direct solver is done. As residual norms may oscillate, the
// smallest one counts.
struct StagnationTest {
    static constexpr int window = 20;
    double best;  // initially the residual norm before the first iteration
    double best_before = best;
    int count = 0;

    // residual: its norm after one more iteration.
    bool stagnates(double residual) {
        best = std::min(best, residual);
        if (++count % window != 0) return false;
        const bool stagnated = best > 0.5 * best_before;
        best_before = best;
        return stagnated;
    }
};

// What conjugate gradients need of r before an iteration and of z = M^{-1} r.
struct Products {
    double rr = 0, rz = 0, zAz = 0;  // r'r, r'z, z'A z
    bool is_indefinite = false;      // M has come across a direction in which A is not positive
};

class Preconditioner {
public:
    virtual ~Preconditioner() = default;

    // Sets M up for the values of A, whose pattern and order of the unknowns are those of the constructor. Not called
    // by a team; apply() needs a success.
    virtual FactorResult factor(const BlockCsr& A) = 0;

    // z = M^{-1} r; returns r'z, which sweeps often give for free. r, z: A.size(), different arrays. When it returns on
    // one thread, all of z is written: the last loop ends in a barrier. All threads get the same r'z, with the same
    // bits for any number of threads.
    virtual double apply(const double* r, double* z) = 0;

    // apply(), and Az = A z. A: that of factor().
    virtual double apply_and_multiply(const BlockCsr& A, const double* r, double* z, double* Az);

    // Preconditioners made of the parts of A know z'A z without A z, and have A z for little in their next sweep. Where
    // this holds, conjugate gradients call, instead of apply_and_multiply(),
    // - at first apply_and_put_off(): apply(), with r'z and z'A z (rr is undefined). In Az is what is to be added to
    //   the A z that is put off, such as what a coarse space changes z by;
    // - then advance(): q <- A z + beta q, r <- r - alpha q for the z of the call before, and the same for the new r,
    //   with r'r. z, Az: those that the call before left.
    virtual bool puts_off_products() const { return false; }
    virtual Products apply_and_put_off(const double* /*r*/, double* /*z*/, double* /*Az*/) { return {}; }
    virtual Products advance(double /*alpha*/, double /*beta*/, double* /*q*/, double* /*r*/, double* /*z*/,
                             double* /*Az*/) {
        return {};
    }

    // For those that require it of the x from which conjugate gradients start: x += y, given r = b - A x; returns r'y.
    // Called like apply(). By default y = 0, for which 0 is returned.
    virtual double correct_start(const double* /*r*/, double* /*x*/) { return 0; }
};

// A sum over the unknowns for all threads of a team, by fixed blocks: the bits do not depend on the number of threads.
// A thread may still be adding up when others go on, so each sum of an iteration has an object of its own.
class TeamSum {
public:
    explicit TeamSum(int size) : size_(size), partial_((size + block - 1) / block) {}

    // Sum of term(begin, count) over the blocks of unknowns begin .. begin + count-1; no node is split among blocks.
    template <class Term>
    double operator()(const Term& term) {
        const int blocks = static_cast<int>(partial_.size());
#pragma omp for schedule(static)
        for (int b = 0; b < blocks; ++b) partial_[b] = term(b * block, std::min(block, size_ - b * block));
        double sum = 0;
        for (double value : partial_) sum += value;
        return sum;
    }

private:
    static constexpr int block = 768;  // a multiple of 1, 2 and 3 unknowns per node
    int size_;
    std::vector<double> partial_;
};

struct KrylovParams {
    int max_iterations = 600;  // products with A
    double tolerance = 1e-10;
    int restart = 60;  // GMRES: iterations per cycle
    int patience = 0;  // conjugate gradients: products with A before which they do not count as stagnated
};

// Preconditioned conjugate gradients (Hestenes & Stiefel, J. Res. Nat. Bur. Stand. 49, 1952; Saad, Iterative Methods
// for Sparse Linear Systems, 2003, algorithm 9.1): minimises x'Ax/2 - b'x over the Krylov space, so that every iterate
// of Newton's method is a descent direction, however early the iteration ends. It detects that A is not positive
// definite by p'Ap <= 0 for a search direction p.
//
// The tolerance is on |r|_2 / |b|_2 and on |r|_M / |b|_M, r = b - A x and |r|_M^2 = r'M^{-1}r: the 2-norm hardly sees
// errors of low energy beside stiff parts of A, such as a penalised boundary.
// The direction is made orthogonal to the one before by beta = -z'q / p'q, with p, q = A p of the iteration before.
// That serves an M^{-1} that changes a little from one iteration to the next too (flexible: Notay, SIAM J. Sci. Comput.
// 22, 2000), such as one that iterates itself. A p comes from A z by the recurrence of p, and p'Ap = z'Az + beta z'q,
// because some preconditioners have z'A z before A z, and both for little (Eisenstat, SIAM J. Sci. Stat. Comput. 2,
// 1981; the order of the sums is that of Chronopoulos & Gear, J. Comput. Appl. Math. 25, 1989). Where p'Ap <= 0 by the
// recurrence, the product with A decides.
// Cost of an iteration: one product with A, one with M^{-1}, three sums; memory 5 n doubles. One team of threads runs
// the whole iteration and shares its loops. Sums go over fixed blocks, so the bits do not depend on the number of
// threads.
class ConjugateGradients {
public:
    ConjugateGradients(int size, const KrylovParams& params) : size_(size), params_(params) {}

    void set_tolerance(double tolerance) { params_.tolerance = tolerance; }

    // Solves A x = b from x_0 = 0; A symmetric. Allocates nothing. Whatever the status, x is the last iterate, zero if
    // that is not finite. Sizes: b, x: A.size().
    KrylovResult solve(const BlockCsr& A, Preconditioner& M, const double* b, double* x);

    // The same, called by all threads of a team.
    KrylovResult solve_in_team(const BlockCsr& A, Preconditioner& M, const double* b, double* x);

private:
    SolveStatus cycle(const BlockCsr& A, Preconditioner& M, Products now, double r_target, double rz_target,
                      int& iterations, double* x);
    double residual(const BlockCsr& A, const double* b, const double* x);
    Products start(const BlockCsr& A, Preconditioner& M);
    Products advance(const BlockCsr& A, Preconditioner& M, double alpha, double beta);
    void next_direction(double alpha, double beta, double* x);
    double curvature(const BlockCsr& A, double* Ap);

    int size_;
    KrylovParams params_;
    std::vector<double> zeros() const { return std::vector<double>(size_); }

    // Residual, M^{-1} r, search direction, A p of the direction before, A z.
    std::vector<double> r_ = zeros(), z_ = zeros(), p_ = zeros(), q_ = zeros(), Az_ = zeros();
    TeamSum zq_{size_}, zAz_{size_}, pAp_{size_};  // pAp_: by a product with A
    TeamSum rr_{size_}, true_rr_{size_};           // r'r by the recurrence, and by a product with A
};

// GMRES(m), m = restart, preconditioned from the right: minimises |b - A x|_2 over x_0 + M^{-1} K_m(A M^{-1}, r_0) by
// modified Gram-Schmidt and Givens rotations (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7, 1986; Saad 2003, algorithm
// 9.5). From the right, the residual that is minimised is the true one. The tolerance is on |b - A x|_2 / |b|_2.
//
// Cost of iteration k of a cycle: one product with A, one with M^{-1}, 4 k n operations; memory (m + 3) n doubles.
class Gmres {
public:
    Gmres(int size, const KrylovParams& params);

    void set_tolerance(double tolerance) { params_.tolerance = tolerance; }

    // Solves A x = b from x_0 = 0. Allocates nothing. Whatever the status, x is the last iterate, zero if that is not
    // finite. breakdown: a number is not finite, or the Krylov space ended without holding the solution (A is
    // singular). Sizes: b, x: A.size().
    KrylovResult solve(const BlockCsr& A, Preconditioner& M, const double* b, double* x);

private:
    SolveStatus cycle(const BlockCsr& A, Preconditioner& M, double beta, double target, int& iterations, int& k);
    double extend(const BlockCsr& A, Preconditioner& M, int k);
    bool rotate(int k, double below);
    void update(Preconditioner& M, int k, double* x);
    void precondition(Preconditioner& M, const double* r, double* z) const;
    double* V(int k) { return basis_.data() + offset(k, size_); }
    double& H(int i, int k) { return hessenberg_[k * (params_.restart + 1) + i]; }

    int size_;
    KrylovParams params_;
    std::vector<double> basis_;           // (m + 1) x size: orthonormal Krylov vectors
    std::vector<double> hessenberg_;      // m columns of m + 1: R of the rotated Hessenberg matrix
    std::vector<double> cosine_, sine_;   // m Givens rotations
    std::vector<double> rotated_;         // m + 1: beta e_1 under the rotations; then the coefficients y
    std::vector<double> work_;            // size
};

}  // namespace almesh
