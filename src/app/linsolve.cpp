#include "app/linsolve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "io/matrix_market.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/krylov/conjugate_gradients.hpp"
#include "linalg/krylov/deflation.hpp"
#include "linalg/ordering/domains.hpp"
#include "linalg/krylov/gmres.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/ordering/ordering.hpp"
#include "linalg/krylov/reordered.hpp"
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
    if (key == "threads") {
        options.threads = integer(most_threads);
    } else if (key == "block") {
        options.block = integer(3);
    } else if (key == "solver") {
        if (value != "cholesky" && value != "cg" && value != "gmres")
            throw UsageError("solver takes cholesky, cg or gmres, not " + in_backquotes(value));
        options.solver = value == "cg" ? SolverKind::cg : value == "gmres" ? SolverKind::gmres : SolverKind::cholesky;
    } else if (key == "ordering") {
        options.ordering = ordering_of(value);
    } else {
        throw UsageError("linsolve has no key " + in_backquotes(key) +
                         "; there are solver, ordering, threads and block");
    }
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

bool all_finite(const std::vector<double>& v) {
    return std::all_of(v.begin(), v.end(), [](double value) { return std::isfinite(value); });
}

// Rows as the file counts them, from 1.
std::string rows_of_node(const BlockCsr& A, int node) {
    const std::string first = std::to_string(node * A.d + 1);
    return A.d == 1 ? "row " + first : "rows " + first + " to " + std::to_string((node + 1) * A.d);
}

void print_time(std::FILE* out, const char* what, double seconds) { std::fprintf(out, "%-16s%.4g s\n", what, seconds); }

// What the analysis knows, before any memory for the factor is taken.
void print_analysis(std::FILE* out, const Cholesky& cholesky, double entries_of_A, double seconds) {
    std::fprintf(out, "nnz(L)          %.0f\n", cholesky.factor_entries());
    std::fprintf(out, "fill            %.4g times the lower triangle of A\n", cholesky.factor_entries() / entries_of_A);
    std::fprintf(out, "flops           %.4g\n", cholesky.flops());
    std::fprintf(out, "memory          %.4g GB\n", cholesky.predicted_bytes() / 1e9);
    print_time(out, "analysis", seconds);
}

bool solve_by_cholesky(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x, Ordering ordering,
                       std::FILE* out) {
    if (ordering == Ordering::minimum_degree && A.n > largest_minimum_degree)
        throw UsageError("ordering=minimum_degree takes at most " + std::to_string(largest_minimum_degree) +
                         " nodes, the matrix has " + std::to_string(A.n) + "; use nested_dissection");
    const Stopwatch analysis;
    CholeskyParams params;
    params.ordering = ordering;
    Cholesky cholesky(A, params);
    print_analysis(out, cholesky, (static_cast<double>(A.value.size()) + A.size()) / 2, analysis.seconds());

    const Stopwatch factorisation;
    const CholeskyResult factored = cholesky.factor(A);
    const double factor_time = factorisation.seconds();
    if (factored.status == CholeskyStatus::too_large) {
        std::fprintf(out, "not solved: the factorisation takes %.3g GB, more than the machine's memory; use %s\n",
                     cholesky.predicted_bytes() / 1e9,
                     ordering == Ordering::nested_dissection ? "solver=cg" : "ordering=nested_dissection");
        return false;
    }
    if (factored.status == CholeskyStatus::not_positive_definite) {
        std::fprintf(out, "not solved: the matrix is not positive definite, the pivot of %s is not positive\n",
                     rows_of_node(A, factored.bad_node).c_str());
        return false;
    }
    std::fprintf(out, "factorisation   %.4g s, %.4g GF/s\n", factor_time, cholesky.flops() / factor_time / 1e9);

    const Stopwatch solve;
    cholesky.solve(b.data(), x.data());
    const double solve_time = solve.seconds();  // every entry of L is read twice
    std::fprintf(out, "solve           %.4g s, %.4g GB/s\n", solve_time,
                 2 * sizeof(double) * cholesky.factor_entries() / solve_time / 1e9);
    return true;
}

const char* reason(GmresStatus status) {
    switch (status) {
        case GmresStatus::converged: return "converged";
        case GmresStatus::max_iterations: return "too many iterations";
        case GmresStatus::stagnated: return "stagnated";
        case GmresStatus::breakdown: return "breakdown: the matrix is singular, or a number was not finite";
    }
    return "";
}

const char* reason(CgStatus status) {
    switch (status) {
        case CgStatus::converged: return "converged";
        case CgStatus::max_iterations: return "too many iterations";
        case CgStatus::stagnated: return "stagnated";
        case CgStatus::not_positive_definite: return "the matrix is not positive definite";
        case CgStatus::breakdown: return "breakdown: a number was not finite";
    }
    return "";
}

// Domain by domain, or in the order asked for, which makes it one domain for one thread.
Domains domains_for(const BlockCsr& A, std::optional<Ordering> ordering) {
    if (!ordering) return cut_into_domains(graph_of(A));
    return {order_vertices(graph_of(A), *ordering), {0, A.n}};
}

// By GMRES or by conjugate gradients, which are deflated.
bool solve_iteratively(SolverKind solver, const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                       std::optional<Ordering> ordering, std::FILE* out) {
    const Stopwatch analysis;
    const Domains domains = domains_for(A, ordering);
    Reordered system(A, domains.order);
    Ilu0 ilu(system.matrix(), domains.start);
    std::optional<Deflation> deflation;
    if (solver == SolverKind::cg) deflation.emplace(system.matrix());
    print_time(out, "analysis", analysis.seconds());

    const Stopwatch preconditioner;
    system.set(A);
    // Blocks of two are of a 2D mesh, where a heavier diagonal is of no use: see linear_solver.cpp.
    const Ilu0Result factored = A.d == 2 ? ilu.factor(system.matrix()) : ilu.factor_heavier(system.matrix());
    const bool definite = !deflation || deflation->factor(system.matrix());
    print_time(out, deflation ? "ILU(0), coarse" : "ILU(0)", preconditioner.seconds());
    if (factored.status == Ilu0Status::not_positive_definite) {
        std::fprintf(out, "not solved: ILU(0) met a pivot that is not positive in %s\n",
                     rows_of_node(A, domains.order[factored.bad_row]).c_str());
        return false;
    }
    if (!definite) {
        std::fprintf(out, "not solved: %s\n", reason(CgStatus::not_positive_definite));
        return false;
    }

    if (factored.shift > 0)
        std::fprintf(out, "shift           %g: ILU(0) of the matrix with a heavier diagonal\n", factored.shift);

    const Stopwatch iteration;
    std::vector<double> right(b.size()), solution(b.size());
    system.gather(b.data(), right.data());
    const auto report = [&](const auto& solved) {
        system.scatter(solution.data(), x.data());
        print_time(out, "solve", iteration.seconds());
        std::fprintf(out, "iterations      %d\n", solved.iterations);
        if (solved.status == decltype(solved.status)::converged) return true;
        std::fprintf(out, "not solved: %s, |b - Ax|/|b| = %.3g\n", reason(solved.status), solved.relative_residual);
        return false;
    };
    const BlockCsr& B = system.matrix();
    if (solver == SolverKind::gmres) return report(Gmres(A.size(), {}).solve(B, &ilu, right.data(), solution.data()));
    return report(ConjugateGradients(A.size(), {}).solve(B, {&ilu, &*deflation}, right.data(), solution.data()));
}

bool solve_by(const Options& options, const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
              std::FILE* out) {
    if (options.solver == SolverKind::cholesky)
        return solve_by_cholesky(A, b, x, options.ordering.value_or(Ordering::nested_dissection), out);
    return solve_iteratively(options.solver, A, b, x, options.ordering, out);
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
    if (!all_finite(b)) throw InputError(options.matrix + ": A x overflows for x near 1; scale the matrix");
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

    std::vector<double> x(A.size(), 0.0);
    const bool solved = solve_by(options, A, b, x, out);
    const double residual = scaled_residual(A, x, b);
    std::fprintf(out, "scaled residual %.3g%s\n", residual, solved ? "" : " of the last x");
    if (solved && !(residual <= acceptable_residual)) std::fprintf(out, "not solved: the residual is too large\n");
    return solved && residual <= acceptable_residual ? ExitCode::success : ExitCode::not_converged;
}

}  // namespace almesh
