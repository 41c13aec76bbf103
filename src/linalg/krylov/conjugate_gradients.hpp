// Preconditioned conjugate gradients (Hestenes & Stiefel, J. Res. Nat. Bur. Stand. 49, 1952; Saad, Iterative Methods
// for Sparse Linear Systems, 2003, algorithm 9.1): minimises x'Ax/2 - b'x over the Krylov space, so that every iterate
// of Newton's method is a descent direction, however early the iteration ends. It notices when A is not positive
// definite: p'Ap <= 0 for a search direction p.
//
// Cost of an iteration: one product with A, one with M^{-1}, two sums; memory 4 n doubles. All threads run the whole
// iteration side by side and share its loops, with waits between them. Sums go over fixed blocks, so the bits do not
// depend on the number of threads.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"
#include "linalg/krylov/deflation.hpp"
#include "linalg/krylov/ilu0.hpp"

namespace almesh {

struct CgParams {
    int max_iterations = 600;  // products with A
    // On |r|_2 / |b|_2 and on |r|_M / |b|_M, r = b - A x and |r|_M^2 = r'M^{-1}r: the first is all but blind to soft
    // parts of A beside stiff ones, such as a penalised boundary.
    double tolerance = 1e-10;
};

enum class CgStatus {
    converged,
    max_iterations,
    stagnated,              // stagnation.hpp, or a tolerance below rounding
    not_positive_definite,  // a direction p with p'Ap <= 0 was met
    breakdown               // a number was not finite
};

struct CgResult {
    CgStatus status;
    int iterations;
    double relative_residual;  // |b - A x|_2 / |b|_2, computed from the x returned
};

// What approximates A^{-1}; nullptr for none.
struct CgPreconditioner {
    Ilu0* ilu = nullptr;
    Deflation* deflation = nullptr;  // around ilu
};

class ConjugateGradients {
public:
    ConjugateGradients(int size, const CgParams& params);

    void set_tolerance(double tolerance) { params_.tolerance = tolerance; }

    // Solves A x = b from x_0 = 0; A symmetric. Allocates nothing. Whatever the status, x is the last iterate, zero if
    // that is not finite. Sizes: b, x: A.size().
    CgResult solve(const BlockCsr& A, const CgPreconditioner& M, const double* b, double* x);

private:
    enum class Cycle { small_residual, max_iterations, stagnated, negative_curvature, not_finite };
    struct Targets {
        double r_norm, rz;  // of |r| and of r'M^{-1}r
    };
    CgResult solve_in_team(const BlockCsr& A, const CgPreconditioner& M, const double* b, double* x);
    Cycle cycle(const BlockCsr& A, const CgPreconditioner& M, double r_norm, double rz, const Targets& targets,
                int& iterations, double* x);
    double start(const double* b, double* x);
    double residual(const BlockCsr& A, const double* b, const double* x);
    double deflate(Deflation& deflation, int d, double* x);
    double next_direction(const CgPreconditioner& M, int d, double rz_before);
    template <class Term>
    double sum_over_blocks(std::vector<double>& partial, const Term& term);

    int size_;
    CgParams params_;
    std::vector<double> r_, z_, p_, q_;           // size: residual, M^{-1} r, search direction, A p
    std::vector<double> pq_, rr_, rz_, true_rr_;  // sums of blocks. One array each: a thread may still be adding up the
                                                  // last one when others write the next
};

}  // namespace almesh
