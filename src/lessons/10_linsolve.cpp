// Lesson 10: the program's own linear solvers alone, on any symmetric matrix in Matrix Market format. Prints its sizes,
// solves by the LinearSolver of a run, but that Cholesky does not take over, with the phases timed, and checks the
// scaled residual.
//
//   build/lessons/10_linsolve A.mtx [b.mtx] [solver=cholesky|cg|gmres] [preconditioner=ilu0|ssor] [threads=N]
//                             [block=1|2|3] [ordering=nested_dissection|minimum_degree|rcm|natural]
//
// The default ordering is nested_dissection for cholesky; for cg and gmres ILU(0) and SSOR order by domains. Exit code
// 0: solved, 1 or 2: wrong arguments or files, 3: not solved.
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "lessons/matrix_market.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/vector_ops.hpp"

using namespace almesh;

namespace {

constexpr int most_threads = 1024;

struct Options {
    std::string matrix, right;  // paths; right may be empty
    SolverKind solver = SolverKind::cholesky;
    PreconditionerKind preconditioner = PreconditionerKind::automatic;
    std::optional<Ordering> ordering;
    int threads = 0, block = 1;
};

template <class Kind>
Kind kind_named(const std::string& value, const std::string& key, const std::vector<Kind>& kinds) {
    std::string names;
    for (const Kind& kind : kinds) {
        if (value == to_string(kind)) return kind;
        names += (names.empty() ? " " : &kind == &kinds.back() ? " or " : ", ") + std::string(to_string(kind));
    }
    throw UsageError(key, " takes", names, ", not ", in_backquotes(value));
}

int integer_in(const std::string& value, const std::string& key, int highest) {
    if (const std::optional<int> number = parse_int(value, 1, highest)) return *number;
    throw UsageError(key, " takes an integer in 1..", highest, ", not ", in_backquotes(value));
}

void set_option(Options& options, const std::string& key, const std::string& value) {
    if (key == "threads") options.threads = integer_in(value, key, most_threads);
    else if (key == "block") options.block = integer_in(value, key, 3);
    else if (key == "solver")
        options.solver = kind_named<SolverKind>(value, key, {SolverKind::cholesky, SolverKind::cg, SolverKind::gmres});
    else if (key == "ordering")
        options.ordering = kind_named<Ordering>(value, key, {Ordering::nested_dissection, Ordering::minimum_degree,
                                                             Ordering::reverse_cuthill_mckee, Ordering::natural});
    else if (key == "preconditioner")
        options.preconditioner =
            kind_named<PreconditionerKind>(value, key, {PreconditionerKind::ilu0, PreconditionerKind::ssor});
    else
        throw UsageError("linsolve has no key ", in_backquotes(key),
                         "; there are solver, preconditioner, ordering, threads and block");
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
        throw UsageError("linsolve takes a matrix: 10_linsolve A.mtx [b.mtx] [solver=cholesky|cg|gmres] "
                         "[preconditioner=ilu0|ssor] [ordering=nested_dissection|minimum_degree|rcm|natural] "
                         "[threads=N] [block=1|2|3]");
    const bool fills = options.ordering == Ordering::nested_dissection || options.ordering == Ordering::minimum_degree;
    if (fills && options.solver != SolverKind::cholesky)
        throw UsageError("ordering=", to_string(*options.ordering),
                         " is for solver=cholesky; ILU(0) of solver=", to_string(options.solver),
                         " takes rcm or natural");
    return options;
}

// Rows as the file counts them, from 1.
std::string rows_of_node(const BlockCsr& A, int node) {
    const int first = node * A.d + 1;
    return A.d == 1 ? concat("row ", first) : concat("rows ", first, " to ", first + A.d - 1);
}

// What the analysis of Cholesky knows, before any memory for the factor is taken.
void print_factor_sizes(std::FILE* out, const LinearSolver& solver, const BlockCsr& A) {
    const double lower_triangle = (static_cast<double>(A.value.size()) + A.size()) / 2;
    std::fprintf(out, "nnz(L)          %.0f\n", solver.factor_entries());
    std::fprintf(out, "fill            %.4g times the lower triangle of A\n", solver.factor_entries() / lower_triangle);
    std::fprintf(out, "flops           %.4g\n", solver.factor_flops());
    std::fprintf(out, "memory          %.4g GB\n", solver.factor_bytes() / 1e9);
}

// Of the phases that were reached. Every entry of L is read twice.
void print_phases(std::FILE* out, const LinearSolver& solver, const SolveResult& result) {
    const double factor = result.factor_seconds, solve = result.solve_seconds;
    const bool direct = result.used == SolverKind::cholesky, reached = solve > 0;
    const char* const sweeps = result.preconditioner == PreconditionerKind::ssor ? "SSOR" : "ILU(0)";
    const std::string preconditioner = concat(sweeps, result.used == SolverKind::cg ? ", coarse" : "");
    if (!direct) std::fprintf(out, "%-16s%.4g s\n", preconditioner.c_str(), factor);
    if (reached && direct) {
        std::fprintf(out, "factorisation   %.4g s, %.4g GF/s\n", factor, solver.factor_flops() / factor / 1e9);
        const double bytes = 2 * sizeof(double) * solver.factor_entries();
        std::fprintf(out, "solve           %.4g s, %.4g GB/s\n", solve, bytes / solve / 1e9);
    } else if (reached) {
        const double shift = result.diagonal_shift;
        if (shift > 0) std::fprintf(out, "shift           %g: ILU(0) of the matrix with a heavier diagonal\n", shift);
        std::fprintf(out, "solve           %.4g s\niterations      %d\n", solve, result.iterations);
    }
}

void print_failure(std::FILE* out, const LinearSolver& solver, const SolveResult& result, const BlockCsr& A,
                   bool nested_dissection) {
    const bool direct = result.used == SolverKind::cholesky;
    const char* const why = reason(result.status);
    if (result.status == SolveStatus::too_large)
        std::fprintf(out, "not solved: the factorisation takes %.3g GB, more than the machine's memory; use %s\n",
                     solver.factor_bytes() / 1e9, nested_dissection ? "solver=cg" : "ordering=nested_dissection");
    else if (result.status == SolveStatus::breakdown && direct)
        std::fprintf(out, "not solved: the residual is too large\n");
    else if (result.bad_node >= 0)
        std::fprintf(out, direct ? "not solved: %s, the pivot of %s is not positive\n" : "not solved: %s in %s\n", why,
                     rows_of_node(A, result.bad_node).c_str());
    else if (result.solve_seconds == 0)  // the coarse matrix is not positive definite
        std::fprintf(out, "not solved: %s\n", why);
    else std::fprintf(out, "not solved: %s, |b - Ax|/|b| = %.3g\n", why, result.relative_residual);
}

// With b = A (1, 1/2, 1/3, 1/4, 1/5, 1, 1/2, ...) where no file gives it: not the same at all nodes, which deflation
// would find without an iteration.
std::vector<double> right_hand_side(const BlockCsr& A, const Options& options) {
    if (!options.right.empty()) return lessons::read_vector(options.right, A.size());
    std::vector<double> b(A.size()), x(A.size());
    for (int i = 0; i < A.size(); ++i) x[i] = 1.0 / (1 + i % 5);
    multiply(A, x.data(), b.data());
    if (!std::isfinite(norm_inf(b))) throw InputError(options.matrix, ": A x overflows for x near 1; scale the matrix");
    return b;
}

ExitCode linsolve(const std::vector<std::string>& arguments, std::FILE* out) {
    const Options options = options_of(arguments);
    set_threads(options.threads);
    const BlockCsr A = lessons::read_matrix(options.matrix, options.block);
    const std::vector<double> b = right_hand_side(A, options);
    const bool direct = options.solver == SolverKind::cholesky;
    const Ordering ordering = options.ordering.value_or(Ordering::nested_dissection);
    const auto nonzeros = static_cast<long long>(A.value.size()) - std::count(A.value.begin(), A.value.end(), 0.0);
    std::fprintf(out, "%s: %d unknowns in %d nodes\n", options.matrix.c_str(), A.size(), A.n);
    std::fprintf(out, "nnz(A)          %lld\n", nonzeros);
    std::fprintf(out, "solver          %s, threads %d\n", to_string(options.solver), max_threads());
    std::fprintf(out, "ordering        %s\n",
                 direct || options.ordering ? to_string(ordering) : "domains (rcm inside each)");
    if (ordering == Ordering::minimum_degree && A.n > largest_minimum_degree)
        throw UsageError("ordering=minimum_degree takes at most ", largest_minimum_degree, " nodes, the matrix has ",
                         A.n, "; use nested_dissection");

    LinearSolverParams params;
    params.kind = options.solver;
    params.preconditioner = options.preconditioner;
    params.ordering = options.ordering;
    params.fallback = false;
    LinearSolver solver(A.d == 2 ? 2 : 3, params);  // blocks of two are of a 2D mesh
    const Stopwatch analysis;
    solver.analyse(A);
    const double analysis_seconds = analysis.seconds();
    if (direct) print_factor_sizes(out, solver, A);
    std::fprintf(out, "analysis        %.4g s\n", analysis_seconds);

    std::vector<double> x;
    const SolveResult result = solver.solve(A, b, x);
    const bool solved = result.status == SolveStatus::success;
    print_phases(out, solver, result);
    if (!solved) print_failure(out, solver, result, A, ordering == Ordering::nested_dissection);
    const double residual = scaled_residual(A, x, b);
    std::fprintf(out, "scaled residual %.3g%s\n", residual, solved ? "" : " of the last x");
    if (solved && !(residual <= acceptable_residual)) std::fprintf(out, "not solved: the residual is too large\n");
    return solved && residual <= acceptable_residual ? ExitCode::success : ExitCode::not_converged;
}

}  // namespace

int main(int count, char** argument) try {
    return static_cast<int>(linsolve({argument + 1, argument + count}, stdout));
} catch (const Error& error) {
    std::fprintf(stderr, "10_linsolve: %s\n", error.what());
    return static_cast<int>(error.exit_code);
}
