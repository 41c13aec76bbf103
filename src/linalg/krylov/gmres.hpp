// GMRES(m), restarted and preconditioned from the right: minimises |b - A x|_2 over x_0 + M^{-1} K_m(A M^{-1}, r_0)
// by modified Gram-Schmidt and Givens rotations (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7, 1986; Saad, Iterative
// Methods for Sparse Linear Systems, 2003, algorithm 9.5).
//
// From the right, the residual that is minimised is the true one. Cost of iteration k of a cycle: one product with A,
// one with M^{-1}, 4 k n operations; memory (m + 3) n doubles.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"
#include "linalg/krylov/ilu0.hpp"

namespace almesh {

struct GmresParams {
    int restart = 60;          // m
    int max_iterations = 600;  // products with A in all cycles
    double tolerance = 1e-10;  // on |b - A x|_2 / |b|_2
};

enum class GmresStatus {
    converged,
    max_iterations,
    stagnated,  // stagnation.hpp, a whole cycle took less than a tenth off the residual, or a tolerance below rounding
    breakdown   // a number was not finite, or the Krylov space ended without holding the solution (A is singular)
};

struct GmresResult {
    GmresStatus status;
    int iterations;
    double relative_residual;  // |b - A x|_2 / |b|_2, computed from the x returned
};

class Gmres {
public:
    Gmres(int size, const GmresParams& params);

    void set_tolerance(double tolerance) { params_.tolerance = tolerance; }

    // Solves A x = b from x_0 = 0; M preconditions, nullptr for none. Allocates nothing. Whatever the status, x is the
    // last iterate, zero if that is not finite. Sizes: b, x: A.size().
    GmresResult solve(const BlockCsr& A, Ilu0* M, const double* b, double* x);

private:
    enum class Cycle { small_residual, space_ended, full, stagnated, not_finite };
    Cycle cycle(const BlockCsr& A, Ilu0* M, double beta, double target, int& iterations, int& k);
    double extend(const BlockCsr& A, Ilu0* M, int k);
    bool rotate(int k, double below);
    void update(Ilu0* M, int k, double* x);
    double* V(int k) { return basis_.data() + static_cast<std::size_t>(k) * size_; }
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
