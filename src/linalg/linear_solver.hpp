// Solves the symmetric systems A x = b of Newton's method on one fixed pattern: by sparse Cholesky, by conjugate
// gradients with deflated ILU(0) or SSOR, or by GMRES with ILU(0).
//
// `automatic` takes Cholesky in 2D, where the factor is small and ILU(0) fails on stretched elements, and conjugate
// gradients in 3D except for small systems, and in 2D from a million unknowns on. The size decides, because already the
// analysis of a large 3D pattern costs more than several iterative solves. Where an iterative solver does not converge,
// Cholesky solves the same system, and after two such failures in a row all further ones; but not where its work,
// predicted from the number of unknowns or known from the analysis, is more than four times what the iteration has
// spent: until then an iteration does not count as stagnated, and after it x is what it has come to. Analyses and
// memory are made when first needed, then kept.
//
// The preconditioner of conjugate gradients: ILU(0) where rows are short, as those of linear triangles are, and SSOR
// where ILU(0) meets bad pivots or rows are long; for degrees above 1 with a correction of degree 1.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "linalg/block_csr.hpp"
#include "linalg/ordering/ordering.hpp"
#include "linalg/solve_status.hpp"

namespace almesh {

enum class SolverKind { automatic, cg, gmres, cholesky };
// Of conjugate gradients. pmg: SSOR with a correction of degree 1, where the degree is higher; else SSOR.
enum class PreconditionerKind { automatic, ilu0, ssor, pmg };

const char* to_string(SolverKind kind);
const char* to_string(PreconditionerKind kind);

// Blocks of a row, on average, from which ILU(0) spends more on products, and on A z, than it saves iterations over
// SSOR: triangles of degree 1 have 7 and of degree 2 have 11, tetrahedra of degree 1 have 14.
inline constexpr double long_rows = 10;

// Whether ILU(0) is tried first. If all nodes are vertices also for rows longer than those of tetrahedra: in layers of
// hexahedra and prisms it is nearly exact along the columns, and SSOR stagnates; elsewhere it costs no more.
inline bool takes_ilu0(double rows, double blocks, bool is_linear) {
    constexpr double row_of_cells = 18;
    return blocks <= long_rows * rows || (is_linear && blocks > row_of_cells * rows);
}

// Scaled residual |b - A x|_inf / (|A|_inf |x|_inf + |b|_inf) above which x does not count as a solution.
inline constexpr double acceptable_residual = 1e-8;

struct LinearSolverParams {
    SolverKind kind = SolverKind::automatic;
    PreconditionerKind preconditioner = PreconditionerKind::automatic;
    double tolerance = 1e-10;    // iterative: on |b - A x|_2 / |b|_2
    int max_iterations = 600;    // iterative: in all cycles
    int cg_from_unknowns[2] = {1000000, 8000};  // automatic, 2D and 3D: systems from this size on go to cg
    double memory_limit = 0;     // bytes for the Cholesky factor; 0: the machine's physical memory
    bool fallback = true;        // Cholesky takes over where an iterative solver fails
    double half_from_blocks = 1.3e7;  // of a matrix of 1 GB half is stored, see stores_half()
    // Empty: nested dissection for Cholesky, domains for ILU(0), which any other ordering makes run on one thread.
    std::optional<Ordering> ordering = {};
};

struct SolveResult {
    SolveStatus status = SolveStatus::success;
    int iterations = 0;              // iterations, those of a failed attempt included
    double relative_residual = 0;    // |b - A x|_2 / |b|_2 of the x returned; 1 where x = 0 is returned
    SolverKind used = SolverKind::cholesky;   // cg, gmres or cholesky: who made x
    std::optional<SolveStatus> failed_first;  // how an iterative solver failed before Cholesky took over
    double diagonal_shift = 0;       // ILU(0) is of A with its diagonal blocks times 1 + diagonal_shift
    PreconditionerKind preconditioner = PreconditionerKind::automatic;  // of the iterative solver; automatic: none
    int bad_node = -1;               // block row of the bad pivot of ILU(0) or Cholesky
    double factor_seconds = 0, solve_seconds = 0;  // of who made x, refinement left out; 0 if that was not reached
    double work = 0;  // iterations times the entries of A; of Cholesky, as many as are made in the time it takes
};

// Whether a system of this size goes to an iterative solver first.
bool iterates(double unknowns, int dimension, const LinearSolverParams& params);

// Whether half of a matrix is stored (block_csr.hpp): in 3D, where conjugate gradients with SSOR and a correction of
// degree 1 solve it, and rows are so long that no factorisation would take over. It takes no part in products then.
bool stores_half(double rows, double blocks, int dimension, const LinearSolverParams& params);

// The order of rows in which the matrices on this pattern had best be assembled; none where they go to Cholesky first.
// of_vertices: interpolation to the nodes from those that are vertices, each of which has a column and there the weight
// 1; no columns: there is none.
std::shared_ptr<const RowOrder> sweep_order(const BlockCsr& pattern, int dimension, const LinearSolverParams& params,
                                            const Interpolation& of_vertices = {});

class LinearSolver {
public:
    // dimension: 2 or 3, of the mesh. Takes no time: the pattern is analysed by the first solve that needs it.
    LinearSolver(int dimension, const LinearSolverParams& params);
    ~LinearSolver();

    // For inexact Newton methods: the tolerance of iterative solvers from the next solve on.
    void set_tolerance(double tolerance);

    // A: symmetric, both triangles stored, with all diagonal blocks, on the pattern of the first A. b, x: A.size(); x
    // is resized. Unless the status is success, x is the last iterate of an iterative solver or zero. Success of an
    // iterative solver does not mean that A is positive definite. not_positive_definite is about A itself, so nothing
    // else is tried then. may_be_indefinite: the caller has another matrix in place of an indefinite A, so
    // indefinite_preconditioner, a sign of that, ends the solve too.
    // b, x by nodes, whatever the order of A's rows.
    SolveResult solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                      bool may_be_indefinite = false);

    // The same with the matrix of the last solve, a success of the only solver that the parameters allow.
    SolveResult solve_again(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x);

    // What the first solve does with the pattern of A before it looks at the values.
    void analyse(const BlockCsr& A);

    // As another solver had it: the next solve gives the bits that it would have given there.
    void forget() { failures_ = 0, failed_iterations_ = 0; }  // what the systems so far have told

    // Scalar entries of the Cholesky factor, operations to compute it, bytes of the factorisation with the number of
    // threads now in force; 0 until it has been analysed.
    double factor_entries() const;
    double factor_flops() const;
    double factor_bytes() const;

    // factor_bytes() if they do not fit the memory, else 0.
    double refused_bytes() const;

private:
    struct Iterative;
    struct Direct;
    SolveResult solve_directly(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                               bool again = false);
    Iterative& iterative(const BlockCsr& A);
    Direct& direct(const BlockCsr& A);
    bool iterative_first(const BlockCsr& A);
    double predicted_flops(const BlockCsr& A) const;
    bool direct_is_worth(const BlockCsr& A, int iterations);

    int dimension_;
    LinearSolverParams params_;
    int failures_ = 0;              // of iterative solvers in a row, solved by Cholesky
    double failed_iterations_ = 0;  // since the last success
    std::vector<double> b_, x_;  // in the order of A's rows
    std::unique_ptr<Iterative> iterative_;
    std::unique_ptr<Direct> direct_;
};

}  // namespace almesh
