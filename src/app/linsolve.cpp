// Reads A and b, prints their sizes, solves by LinearSolver with the phases timed, and checks the scaled residual.
#include "app/linsolve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "io/matrix_market.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {
namespace {

constexpr int most_threads = 1024;

struct Options {
    std::string matrix, right;  // paths; right may be empty
    SolverKind solver = SolverKind::cholesky;
    std::optional<Ordering> ordering;
    int threads = 0, block = 1;
};

SolverKind solver_of(const std::string& name) {
    for (SolverKind kind : {SolverKind::cholesky, SolverKind::cg, SolverKind::gmres})
        if (name == to_string(kind)) return kind;
    throw UsageError("solver takes cholesky, cg or gmres, not " + in_backquotes(name));
}

Ordering ordering_of(const std::string& name) {
    for (Ordering ordering : {Ordering::nested_dissection, Ordering::minimum_degree, Ordering::reverse_cuthill_mckee,
                              Ordering::natural})
        if (name == to_string(ordering)) return ordering;
    throw UsageError("ordering takes nested_dissection, minimum_degree, rcm or natural, not " + in_backquotes(name));
}

void set_option(Options& options, const std::string& key, const std::string& value) {
    const auto integer = [&](int highest) {
        const std::optional<int> number = parse_int(value, 1, highest);
        if (!number)
            throw UsageError(key + " takes an integer in 1.." + std::to_string(highest) + ", not " +
                             in_backquotes(value));
        return *number;
    };
    if (key == "threads") options.threads = integer(most_threads);
    else if (key == "block") options.block = integer(3);
    else if (key == "solver") options.solver = solver_of(value);
    else if (key == "ordering") options.ordering = ordering_of(value);
    else throw UsageError("linsolve has no key " + in_backquotes(key) +
                          "; there are solver, ordering, threads and block");
}

Options options_of(const std::vector<std::string>& arguments) {
    Options options;
    for (const std::string& argument : arguments) {
        const auto equals = argument.find('=');
        if (equals != std::string::npos) set_option(options, argument.substr(0, equals), argument.substr(equals + 1));
        else if (options.matrix.empty()) options.matrix = argument;
        else if (options.right.empty()) options.right = argument;
        else throw UsageError("linsolve takes a matrix and at most one right-hand side");
    }
    if (options.matrix.empty())
        throw UsageError("linsolve takes a matrix: almesh linsolve A.mtx [b.mtx] [solver=cholesky|cg|gmres] "
                         "[ordering=nested_dissection|minimum_degree|rcm|natural] [threads=N] [block=1|2|3]");
    const bool fills = options.ordering == Ordering::nested_dissection || options.ordering == Ordering::minimum_degree;
    if (fills && options.solver != SolverKind::cholesky)
        throw UsageError(std::string("ordering=") + to_string(*options.ordering) +
                         " is for solver=cholesky; ILU(0) of solver=" + to_string(options.solver) +
                         " takes rcm or natural");
    return options;
}

// Rows as the file counts them, from 1.
std::string rows_of_node(const BlockCsr& A, int node) {
    const std::string first = std::to_string(node * A.d + 1);
    return A.d == 1 ? "row " + first : "rows " + first + " to " + std::to_string((node + 1) * A.d);
}

void print_time(std::FILE* out, const char* what, double seconds) { std::fprintf(out, "%-16s%.4g s\n", what, seconds); }

// What the analysis knows, before any memory for the factor is taken.
void print_factor_sizes(std::FILE* out, const LinearSolver& solver, const BlockCsr& A) {
    const double lower_triangle = (static_cast<double>(A.value.size()) + A.size()) / 2;
    std::fprintf(out, "nnz(L)          %.0f\n", solver.factor_entries());
    std::fprintf(out, "fill            %.4g times the lower triangle of A\n", solver.factor_entries() / lower_triangle);
    std::fprintf(out, "flops           %.4g\n", solver.factor_flops());
    std::fprintf(out, "memory          %.4g GB\n", solver.factor_bytes() / 1e9);
}

// Of the phases that were reached.
void print_phases(std::FILE* out, const LinearSolver& solver, const SolveResult& result) {
    const bool direct = result.used == SolverKind::cholesky, reached = result.solve_seconds > 0;
    if (!direct) print_time(out, result.used == SolverKind::cg ? "ILU(0), coarse" : "ILU(0)", result.factor_seconds);
    if (!reached) return;
    if (direct) {
        std::fprintf(out, "factorisation   %.4g s, %.4g GF/s\n", result.factor_seconds,
                     solver.factor_flops() / result.factor_seconds / 1e9);
        const double bytes = 2 * sizeof(double) * solver.factor_entries();  // every entry of L is read twice
        std::fprintf(out, "solve           %.4g s, %.4g GB/s\n", result.solve_seconds, bytes / result.solve_seconds / 1e9);
        return;
    }
    if (result.diagonal_shift > 0)
        std::fprintf(out, "shift           %g: ILU(0) of the matrix with a heavier diagonal\n", result.diagonal_shift);
    print_time(out, "solve", result.solve_seconds);
    std::fprintf(out, "iterations      %d\n", result.iterations);
}

void print_failure(std::FILE* out, const LinearSolver& solver, const SolveResult& result, const BlockCsr& A,
                   bool nested_dissection) {
    const bool direct = result.used == SolverKind::cholesky;
    if (result.status == SolveStatus::too_large)
        std::fprintf(out, "not solved: the factorisation takes %.3g GB, more than the machine's memory; use %s\n",
                     solver.factor_bytes() / 1e9, nested_dissection ? "solver=cg" : "ordering=nested_dissection");
    else if (result.status == SolveStatus::breakdown && direct)
        std::fprintf(out, "not solved: the residual is too large\n");
    else if (result.bad_node >= 0)
        std::fprintf(out, direct ? "not solved: %s, the pivot of %s is not positive\n" : "not solved: %s in %s\n",
                     reason(result.status), rows_of_node(A, result.bad_node).c_str());
    else if (result.solve_seconds == 0)  // the coarse matrix is not positive definite
        std::fprintf(out, "not solved: %s\n", reason(result.status));
    else
        std::fprintf(out, "not solved: %s, |b - Ax|/|b| = %.3g\n", reason(result.status), result.relative_residual);
}

// Through the facade of a run, but that Cholesky does not take over.
SolveResult solve_by(const Options& options, const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                     std::FILE* out) {
    if (options.ordering == Ordering::minimum_degree && A.n > largest_minimum_degree)
        throw UsageError("ordering=minimum_degree takes at most " + std::to_string(largest_minimum_degree) +
                         " nodes, the matrix has " + std::to_string(A.n) + "; use nested_dissection");
    LinearSolverParams params;
    params.kind = options.solver;
    params.ordering = options.ordering;
    params.fallback = false;
    LinearSolver solver(A.d == 2 ? 2 : 3, params);  // blocks of two are of a 2D mesh
    const Stopwatch analysis;
    solver.analyse(A);
    const double analysis_seconds = analysis.seconds();
    const bool direct = options.solver == SolverKind::cholesky;
    if (direct) print_factor_sizes(out, solver, A);
    print_time(out, "analysis", analysis_seconds);

    const SolveResult result = solver.solve(A, b, x);
    print_phases(out, solver, result);
    if (result.status != SolveStatus::success)
        print_failure(out, solver, result, A,
                      options.ordering.value_or(Ordering::nested_dissection) == Ordering::nested_dissection);
    return result;
}

// What the output calls it where none is asked for.
const char* ordering_name(const Options& options) {
    if (options.ordering) return to_string(*options.ordering);
    return options.solver == SolverKind::cholesky ? to_string(Ordering::nested_dissection)
                                                  : "domains (rcm inside each)";
}

// With b = A (1, 1/2, 1/3, 1/4, 1/5, 1, 1/2, ...) where no file gives it: not the same at all nodes, which deflation
// would find without an iteration.
std::vector<double> right_hand_side(const BlockCsr& A, const Options& options) {
    if (!options.right.empty()) return read_matrix_market_vector(options.right, A.size());
    std::vector<double> b(A.size()), x(A.size());
    for (int i = 0; i < A.size(); ++i) x[i] = 1.0 / (1 + i % 5);
    multiply(A, x.data(), b.data());
    if (!std::isfinite(norm_inf(b)))
        throw InputError(options.matrix + ": A x overflows for x near 1; scale the matrix");
    return b;
}

}  // namespace

ExitCode linsolve(const std::vector<std::string>& arguments, std::FILE* out) {
    const Options options = options_of(arguments);
    set_threads(options.threads);
    const BlockCsr A = read_matrix_market(options.matrix, options.block);
    const std::vector<double> b = right_hand_side(A, options);
    const auto zeros = std::count(A.value.begin(), A.value.end(), 0.0);
    std::fprintf(out, "%s: %d unknowns in %d nodes\n", options.matrix.c_str(), A.size(), A.n);
    std::fprintf(out, "nnz(A)          %lld\n", static_cast<long long>(A.value.size()) - static_cast<long long>(zeros));
    std::fprintf(out, "solver          %s, threads %d\n", to_string(options.solver), max_threads());
    std::fprintf(out, "ordering        %s\n", ordering_name(options));

    std::vector<double> x;
    const bool solved = solve_by(options, A, b, x, out).status == SolveStatus::success;
    const double residual = scaled_residual(A, x, b);
    std::fprintf(out, "scaled residual %.3g%s\n", residual, solved ? "" : " of the last x");
    if (solved && !(residual <= acceptable_residual)) std::fprintf(out, "not solved: the residual is too large\n");
    return solved && residual <= acceptable_residual ? ExitCode::success : ExitCode::not_converged;
}

}  // namespace almesh
