// Chooses a solver, falls back from an iterative one to Cholesky, and checks the solution of Cholesky: one step of
// iterative refinement where it lowers the scaled residual (Higham, Accuracy and Stability of Numerical Algorithms,
// 2002, chapter 12).
#include "linalg/linear_solver.hpp"

#include <cmath>
#include <variant>

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/krylov/conjugate_gradients.hpp"
#include "linalg/krylov/deflated.hpp"
#include "linalg/krylov/gmres.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "linalg/ordering/ordering.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

const char* to_string(SolverKind kind) {
    switch (kind) {
        case SolverKind::automatic: return "automatic";
        case SolverKind::cg: return "cg";
        case SolverKind::gmres: return "gmres";
        case SolverKind::cholesky: return "cholesky";
    }
    return "";
}

namespace {

constexpr int failures_to_give_up = 2;  // of iterative solvers in a row, if the choice is ours
constexpr double refine_above = 1e-15;  // scaled residual from which a step of iterative refinement is worth a solve

Domains domains_in(const Graph& graph, std::optional<Ordering> ordering) {
    if (!ordering) return cut_into_domains(graph);
    return {order_vertices(graph, *ordering), {0, graph.size()}};
}

// Where ILU(0) of a positive definite matrix meets a bad pivot, that of one with a heavier diagonal may not, and serves
// nearly as well (Manteuffel, Math. Comp. 34, 1980). Not so in 2D: there bad pivots come from stretched elements, and
// iterations stagnate with any shift.
std::vector<double> diagonal_shifts(int dimension) {
    return dimension == 2 ? std::vector<double>{0} : std::vector<double>{0, 0.01, 0.1};
}

using Method = std::variant<ConjugateGradients, Gmres>;

Method make_method(int size, const LinearSolverParams& params) {
    if (params.kind == SolverKind::gmres) return Gmres(size, {params.restart, params.max_iterations, params.tolerance});
    return ConjugateGradients(size, {params.max_iterations, params.tolerance});
}

// start: of the domains, see Ilu0.
std::unique_ptr<Preconditioner> make_preconditioner(const BlockCsr& pattern, const std::vector<int>& start,
                                                    int dimension, SolverKind kind) {
    std::unique_ptr<Preconditioner> ilu;
    const auto set_up_ilu = [&] { ilu = std::make_unique<Ilu0>(pattern, start, diagonal_shifts(dimension)); };
    if (kind == SolverKind::gmres) return set_up_ilu(), std::move(ilu);
    std::unique_ptr<CoarseSpace> coarse;
    parallel_invoke(set_up_ilu, [&] { coarse = std::make_unique<CoarseSpace>(pattern); });
    return std::make_unique<Deflated>(std::move(ilu), std::move(coarse));
}

}  // namespace

struct LinearSolver::Iterative {
    Reordered system;  // in the order of the preconditioner
    std::unique_ptr<Preconditioner> M;
    Method method;
    std::vector<double> right, solution;

    Iterative(const BlockCsr& A, int dimension, const LinearSolverParams& params, const Domains& domains)
        : system(A, domains.order),
          M(make_preconditioner(system.matrix(), domains.start, dimension, params.kind)),
          method(make_method(A.size(), params)),
          right(A.size()),
          solution(A.size()) {}

    SolverKind kind() const { return std::holds_alternative<Gmres>(method) ? SolverKind::gmres : SolverKind::cg; }
};

struct LinearSolver::Direct {
    Cholesky cholesky;
    std::vector<double> residual, correction;

    Direct(const BlockCsr& A, const CholeskyParams& params)
        : cholesky(A, params), residual(A.size()), correction(A.size()) {}
};

LinearSolver::LinearSolver(int dimension, const LinearSolverParams& params)
    : dimension_(dimension), params_(params) {}

LinearSolver::~LinearSolver() = default;

void LinearSolver::set_tolerance(double tolerance) {
    params_.tolerance = tolerance;
    if (iterative_) std::visit([=](auto& method) { method.set_tolerance(tolerance); }, iterative_->method);
}

double LinearSolver::factor_entries() const { return direct_ ? direct_->cholesky.factor_entries() : 0; }
double LinearSolver::factor_flops() const { return direct_ ? direct_->cholesky.flops() : 0; }

double LinearSolver::factor_bytes() const { return direct_ ? direct_->cholesky.predicted_bytes() : 0; }
double LinearSolver::refused_bytes() const { return direct_ && !direct_->cholesky.fits() ? factor_bytes() : 0; }

LinearSolver::Iterative& LinearSolver::iterative(const BlockCsr& A) {
    if (!iterative_) {
        const Domains domains = domains_in(graph_of(A), params_.ordering);
        iterative_ = std::make_unique<Iterative>(A, dimension_, params_, domains);
    }
    return *iterative_;
}

LinearSolver::Direct& LinearSolver::direct(const BlockCsr& A) {
    if (!direct_) {
        CholeskyParams params;
        params.memory_limit = params_.memory_limit;
        params.ordering = params_.ordering.value_or(params.ordering);
        direct_ = std::make_unique<Direct>(A, params);
    }
    return *direct_;
}

bool LinearSolver::iterative_first(const BlockCsr& A) {
    if (params_.kind != SolverKind::automatic) return params_.kind != SolverKind::cholesky;
    if (failures_ < failures_to_give_up && dimension_ == 3 && A.size() >= params_.cg_from_unknowns) return true;
    return !direct(A).cholesky.fits();
}

void LinearSolver::analyse(const BlockCsr& A) {
    if (iterative_first(A)) iterative(A);
    else direct(A);
}

SolveResult LinearSolver::solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                                bool may_be_indefinite) {
    x.assign(A.size(), 0.0);
    if (!iterative_first(A)) return solve_directly(A, b, x);
    const SolveResult first = solve_iteratively(A, b, x);
    if (first.status == SolveStatus::success) failures_ = 0;
    if (first.status == SolveStatus::success || first.status == SolveStatus::not_positive_definite) return first;
    if (may_be_indefinite && first.status == SolveStatus::indefinite_preconditioner) return first;
    ++failures_;
    if (!params_.fallback || !direct(A).cholesky.fits()) return first;
    SolveResult second = solve_directly(A, b, x);
    second.iterations = first.iterations;
    second.failed_first = first.status;
    return second;
}

SolveResult LinearSolver::solve_iteratively(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    Iterative& own = iterative(A);
    SolveResult result;
    result.used = own.kind();
    result.relative_residual = 1;
    const Stopwatch factorisation;
    own.system.set(A);
    const BlockCsr& B = own.system.matrix();
    const FactorResult factored = own.M->factor(B);
    result.factor_seconds = factorisation.seconds();
    result.status = factored.status;
    if (factored.bad_row >= 0) result.bad_node = own.system.order()[factored.bad_row];
    if (factored.status != SolveStatus::success) return result;
    result.diagonal_shift = factored.diagonal_shift;

    const Stopwatch iteration;
    own.system.gather(b.data(), own.right.data());
    const KrylovResult solved = std::visit(
        [&](auto& method) { return method.solve(B, *own.M, own.right.data(), own.solution.data()); }, own.method);
    own.system.scatter(own.solution.data(), x.data());
    result.solve_seconds = iteration.seconds();
    result.status = solved.status;
    result.iterations = solved.iterations;
    result.relative_residual = solved.relative_residual;
    return result;
}

SolveResult LinearSolver::solve_directly(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    Direct& own = direct(A);
    SolveResult result;
    result.relative_residual = 1;
    x.assign(A.size(), 0.0);
    const Stopwatch factorisation;
    const FactorResult factored = own.cholesky.factor(A);
    result.factor_seconds = factorisation.seconds();
    result.status = factored.status;
    result.bad_node = factored.bad_row;
    if (factored.status != SolveStatus::success) return result;

    const Stopwatch substitution;
    own.cholesky.solve(b.data(), x.data());
    result.solve_seconds = substitution.seconds();
    const double A_norm = norm_inf(A), b_norm = norm_inf(b);
    const auto scaled = [&] {  // computes the residual too
        multiply(A, x.data(), own.residual.data());
        subtract(A.size(), b.data(), own.residual.data(), own.residual.data());
        const double scale = A_norm * norm_inf(x) + b_norm, largest = norm_inf(own.residual);
        return scale > 0 ? largest / scale : largest;
    };
    double residual = scaled();
    if (residual > refine_above) {
        own.cholesky.solve(own.residual.data(), own.correction.data());
        axpy(1, own.correction, x);
        const double refined = scaled();
        if (!(refined <= residual)) {
            axpy(-1, own.correction, x);
            scaled();
        } else {
            residual = refined;
        }
    }
    if (!(residual <= acceptable_residual)) {
        result.status = SolveStatus::breakdown;
        x.assign(A.size(), 0.0);
        return result;
    }
    const double b_length = norm_2(b);
    result.relative_residual = b_length > 0 ? norm_2(own.residual) / b_length : 0;
    return result;
}

}  // namespace almesh
