// Preconditioned conjugate gradients (Hestenes & Stiefel, J. Res. Nat. Bur. Stand. 49, 1952; Saad, Iterative Methods
// for Sparse Linear Systems, 2003, algorithm 9.1): minimises x'Ax/2 - b'x over the Krylov space, so that every iterate
// of Newton's method is a descent direction, however early the iteration ends. It detects that A is not positive
// definite by p'Ap <= 0 for a search direction p.
//
// Cost of an iteration: one product with A, one with M^{-1}, two sums; memory 4 n doubles. One team of threads runs the
// whole iteration and shares its loops. Sums go over fixed blocks, so the bits do not depend on the number of threads.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"
#include "linalg/krylov/krylov.hpp"

namespace almesh {

struct CgParams {
    int max_iterations = 600;  // products with A
    // On |r|_2 / |b|_2 and on |r|_M / |b|_M, r = b - A x and |r|_M^2 = r'M^{-1}r: the 2-norm hardly sees errors of low
    // energy beside stiff parts of A, such as a penalised boundary.
    double tolerance = 1e-10;
};

class ConjugateGradients {
public:
    ConjugateGradients(int size, const CgParams& params);

    void set_tolerance(double tolerance) { params_.tolerance = tolerance; }

    // Solves A x = b from x_0 = 0; A symmetric. Allocates nothing. Whatever the status, x is the last iterate, zero if
    // that is not finite. Sizes: b, x: A.size().
    KrylovResult solve(const BlockCsr& A, Preconditioner& M, const double* b, double* x);

private:
    struct Targets {
        double r_norm, rz;  // of |r| and of r'M^{-1}r
    };
    KrylovResult solve_in_team(const BlockCsr& A, Preconditioner& M, const double* b, double* x);
    SolveStatus cycle(const BlockCsr& A, Preconditioner& M, double r_norm, double rz, const Targets& targets,
                      int& iterations, double* x);
    double start(const double* b, double* x);
    double residual(const BlockCsr& A, const double* b, const double* x);
    double next_direction(Preconditioner& M, double rz_before);

    int size_;
    CgParams params_;
    std::vector<double> r_, z_, p_, q_;  // size: residual, M^{-1} r, search direction, A p
    TeamSum pq_, rr_, true_rr_;          // p'q, r'r of the recurrence and of b - A x
};

}  // namespace almesh
