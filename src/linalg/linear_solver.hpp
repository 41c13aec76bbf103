// Solves the symmetric systems A x = b of Newton's method on one fixed pattern, by sparse Cholesky or by conjugate
// gradients (deflated) or GMRES with ILU(0), and knows which of them suits.
//
// `automatic`: Cholesky in 2D, where the factor is small and ILU(0) fails on stretched elements; conjugate gradients in
// 3D but for small systems, decided by their size because already the analysis of a large 3D pattern costs more than
// several iterative solves. Where an iterative solver does not converge, the same system goes to Cholesky, and after
// two such failures in a row all further ones do. Analyses and memory are made when first needed, then kept.
#pragma once
#include <memory>
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

enum class SolverKind { automatic, cg, gmres, cholesky };

// Scaled residual |b - A x|_inf / (|A|_1 |x|_inf + |b|_inf) above which x does not count as a solution.
inline constexpr double acceptable_residual = 1e-8;

enum class SolveStatus {
    converged,
    max_iterations,             // iterative
    stagnated,                  // iterative
    breakdown,                  // numbers that are not finite, or a solution that does not satisfy the system
    indefinite_preconditioner,  // ILU(0), in 3D also of A with a heavier diagonal, met a pivot that is not
                                // positive; the matrix may be positive definite
    not_positive_definite,      // Cholesky; conjugate gradients: the coarse matrix, or a direction of no
                                // positive curvature
    too_large                   // the Cholesky factor would not fit the memory
};

const char* to_string(SolveStatus status);
const char* to_string(SolverKind kind);

struct LinearSolverParams {
    SolverKind kind = SolverKind::automatic;
    double tolerance = 1e-10;    // iterative: on |b - A x|_2 / |b|_2
    int restart = 60;            // GMRES: iterations per cycle
    int max_iterations = 600;    // iterative: in all cycles
    int cg_from_unknowns = 8000; // automatic, 3D: systems from this size on go to conjugate gradients
    double memory_limit = 0;     // bytes for the Cholesky factor; 0: the machine's physical memory
};

struct SolveResult {
    SolveStatus status = SolveStatus::converged;
    int iterations = 0;              // iterations, those of a failed attempt included
    double relative_residual = 0;    // |b - A x|_2 / |b|_2 of the x returned; 1 where x = 0 is returned
    SolverKind used = SolverKind::cholesky;  // cg, gmres or cholesky: who made x
    bool fell_back = false;          // an iterative solver was tried before, and ended with iterative_status
    SolveStatus iterative_status = SolveStatus::converged;
    double shift = 0;                // ILU(0) is of A with its diagonal blocks times 1 + shift
    int bad_node = -1;               // block row of the bad pivot of ILU(0) or Cholesky
};

class LinearSolver {
public:
    // dimension: 2 or 3, of the mesh. Takes no time: the pattern is analysed by the first solve that needs it.
    LinearSolver(int dimension, const LinearSolverParams& params);
    ~LinearSolver();

    // For inexact Newton methods: the tolerance of iterative solvers from the next solve on.
    void set_tolerance(double tolerance);

    // A: symmetric, both triangles stored, with all diagonal blocks, on the pattern of the first A. b, x: A.size(); x
    // is resized. Unless the status is converged, x is the last iterate of an iterative solver or zero. Its convergence
    // does not mean that A is positive definite. not_positive_definite is about A itself, so nothing else is tried
    // then. doubtful: A may be indefinite, and the caller has another matrix in its place; then
    // indefinite_preconditioner, a sign of that, ends the solve too.
    SolveResult solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x, bool doubtful = false);

    // Scalar entries of the Cholesky factor and operations to compute it; 0 until it has been analysed.
    double factor_entries() const;
    double factor_flops() const;

    // Bytes of the factorisation if it has been analysed and does not fit the memory, else 0.
    double refused_bytes() const;

private:
    struct Iterative;
    struct Direct;
    Iterative& iterative(const BlockCsr& A);
    Direct& direct(const BlockCsr& A);
    bool iterative_first(const BlockCsr& A);
    SolveResult solve_iteratively(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x);
    SolveResult solve_directly(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x);

    int dimension_;
    LinearSolverParams params_;
    int failures_ = 0;  // of iterative solvers in a row
    std::unique_ptr<Iterative> iterative_;
    std::unique_ptr<Direct> direct_;
};

}  // namespace almesh
