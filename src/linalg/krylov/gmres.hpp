// GMRES(m), restarted and preconditioned from the right: minimises |b - A x|_2 over x_0 + M^{-1} K_m(A M^{-1}, r_0)
// by modified Gram-Schmidt and Givens rotations (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7, 1986; Saad, Iterative
// Methods for Sparse Linear Systems, 2003, algorithm 9.5).
//
// From the right, the residual that is minimised is the true one. Cost of iteration k of a cycle: one product with A,
// one with M^{-1}, 4 k n operations; memory (m + 3) n doubles.
#pragma once
#include <vector>

#include "base/index.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/krylov/krylov.hpp"

namespace almesh {

struct GmresParams {
    int restart = 60;          // m
    int max_iterations = 600;  // products with A in all cycles
    double tolerance = 1e-10;  // on |b - A x|_2 / |b|_2
};

class Gmres {
public:
    Gmres(int size, const GmresParams& params);

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
    GmresParams params_;
    std::vector<double> basis_;           // (m + 1) x size: orthonormal Krylov vectors
    std::vector<double> hessenberg_;      // m columns of m + 1: R of the rotated Hessenberg matrix
    std::vector<double> cosine_, sine_;   // m Givens rotations
    std::vector<double> rotated_;         // m + 1: beta e_1 under the rotations; then the coefficients y
    std::vector<double> work_;            // size
};

}  // namespace almesh
