// Chooses a solver, falls back from an iterative one to Cholesky, and checks the solution of Cholesky: one step of
// iterative refinement where it lowers the scaled residual (Higham, Accuracy and Stability of Numerical Algorithms,
// 2002, chapter 12).
#include "linalg/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/krylov/krylov.hpp"
#include "linalg/krylov/deflated.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

const char* to_string(SolverKind kind) {
    constexpr const char* name[] = {"automatic", "cg", "gmres", "cholesky"};
    return name[static_cast<int>(kind)];
}

const char* to_string(PreconditionerKind kind) {
    constexpr const char* name[] = {"automatic", "ilu0", "ssor", "pmg"};
    return name[static_cast<int>(kind)];
}

namespace {

constexpr int failures_to_give_up = 2;  // of iterative solvers in a row, if the choice is ours
constexpr double worth = 4;        // Cholesky may cost this many times what an iterative solver has just spent, or
                                   // once what it has spent since it last succeeded
constexpr double flops_of_entry = 20;  // of Cholesky, in the time that an iteration spends on an entry of A
// The same from small to large matrices: work = factor flops^power, to a factor of 1.7 from 3e6 to 1e10 flops, as
// large dense blocks are eliminated at a higher rate.
constexpr double factor_of_flops = 8.5, power_of_flops = 0.7;
constexpr double row_of_half = 40;  // blocks: tetrahedra of degree 2 have 28, of degree 3 52
constexpr double refine_above = 1e-15;  // scaled residual from which a step of iterative refinement is worth a solve

double entries(const BlockCsr& A) {
    return std::max(1.0, (A.in_half() ? 2.0 * A.blocks() + A.n : A.blocks()) * A.d * A.d);
}

using Method = std::variant<ConjugateGradients, Gmres>;

Method make_method(int size, const LinearSolverParams& params, int patience) {
    KrylovParams krylov{params.max_iterations, params.tolerance};
    krylov.patience = patience;
    if (params.kind == SolverKind::gmres) return Gmres(size, krylov);
    return ConjugateGradients(size, krylov);
}

Sweeps sweeps_for(const BlockCsr& pattern, const LinearSolverParams& params, bool is_linear) {
    const bool by_choice = params.preconditioner != PreconditionerKind::automatic;
    if (by_choice) return params.preconditioner == PreconditionerKind::ilu0 ? Sweeps::ilu0 : Sweeps::ssor;
    if (params.kind == SolverKind::gmres) return Sweeps::ilu0;
    return takes_ilu0(pattern.n, pattern.blocks(), is_linear) ? Sweeps::ilu0_or_ssor : Sweeps::ssor;
}

bool takes_lower_degree(const BlockCsr& pattern, const LinearSolverParams& params) {
    return pattern.order && pattern.order->of_vertices.columns > 0 && params.kind != SolverKind::gmres &&
           sweeps_for(pattern, params, false) == Sweeps::ssor && params.preconditioner != PreconditionerKind::ssor;
}

// start: of the domains, see make_ilu0().
std::unique_ptr<Preconditioner> make_preconditioner(const BlockCsr& pattern, const std::vector<int>& start,
                                                    int dimension, const LinearSolverParams& params, bool is_linear) {
    if (takes_lower_degree(pattern, params)) {
        LinearSolverParams coarse = params;
        coarse.preconditioner = PreconditionerKind::ssor;
        const auto make_coarse = [&](const BlockCsr& E) {
            return make_preconditioner(E, pattern.order->vertex_start, dimension, coarse, false);
        };
        auto correction = std::make_unique<CoarseCorrection>(pattern, pattern.order->of_vertices, make_coarse);
        return make_ilu0(pattern, start, {}, Sweeps::ssor, std::move(correction));
    }
    std::unique_ptr<Preconditioner> ilu;
    // Where ILU(0) of a positive definite matrix meets a bad pivot, that of one with a heavier diagonal may not, and
    // serves nearly as well (Manteuffel, Math. Comp. 34, 1980). Not so in 2D: there bad pivots come from stretched
    // elements, and iterations stagnate with any shift.
    const std::vector<double> shifts = dimension == 2 ? std::vector<double>{0} : std::vector<double>{0, 0.01, 0.1};
    const Sweeps sweeps = sweeps_for(pattern, params, is_linear);
    const auto set_up_ilu = [&] { ilu = make_ilu0(pattern, start, shifts, sweeps); };
    if (params.kind == SolverKind::gmres) return set_up_ilu(), std::move(ilu);
    std::unique_ptr<CoarseSpace> coarse;
    const bool in_single = sweeps == Sweeps::ssor;
    parallel_invoke(set_up_ilu, [&] { coarse = std::make_unique<CoarseSpace>(pattern, in_single); });
    return std::make_unique<Deflated>(std::move(ilu), std::move(coarse));
}

// The rows of P in their order; its columns, each the vertex with weight 1 in it, in the order of these vertices.
void order_interpolation(const Interpolation& P, RowOrder& order) {
    if (P.columns == 0) return;
    std::vector<int> column(P.columns);
    int next = 0;
    std::vector<int>& start = order.vertex_start;
    for (int i = 0; i < P.rows(); ++i) {
        while (start.size() < order.start.size() && i == order.start[start.size()]) start.push_back(next);
        const int k = P.row[order.node[i]];
        if (P.weight[k] == 1) column[P.col[k]] = next++;
    }
    while (start.size() < order.start.size()) start.push_back(next);
    Interpolation& ordered = order.of_vertices;
    ordered.columns = P.columns;
    for (const int node : order.node) {
        for (int k = P.row[node]; k < P.row[node + 1]; ++k) {
            ordered.col.push_back(column[P.col[k]]);
            ordered.weight.push_back(P.weight[k]);
        }
        ordered.row.push_back(static_cast<int>(ordered.col.size()));
    }
}

}  // namespace

struct LinearSolver::Iterative {
    std::optional<BlockCsr> copy;  // of A in the order of the sweeps, where A is not in it
    LargeVector<int> place;        // of A's blocks in the copy
    bool has_lower_degree;
    std::unique_ptr<Preconditioner> M;
    Method method;
    std::vector<double> right, solution;  // in the order of the sweeps

    Iterative(const BlockCsr& A, std::shared_ptr<const RowOrder> order, int dimension, const LinearSolverParams& params,
              int patience)
        : has_lower_degree(takes_lower_degree(A, params)), method(make_method(A.size(), params, patience)) {
        if (!A.order) copy = ordered_pattern(A, order, place);
        const bool is_linear = A.order && A.order->of_vertices.columns == 0;
        M = make_preconditioner(copy ? *copy : A, order->start, dimension, params, is_linear);
    }

    SolveResult solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x, bool again = false) {
        SolveResult result;
        result.relative_residual = 1;
        result.used = std::holds_alternative<Gmres>(method) ? SolverKind::gmres : SolverKind::cg;
        const BlockCsr& B = copy ? *copy : A;
        const Stopwatch factorisation;
        if (copy) copy_values(A, place, *copy);
        const FactorResult factored = again ? FactorResult{SolveStatus::success} : M->factor(B);
        result.factor_seconds = factorisation.seconds();
        result.status = factored.status;
        if (factored.bad_row >= 0) result.bad_node = B.node_of(factored.bad_row);
        result.preconditioner = !factored.ssor     ? PreconditionerKind::ilu0
                                : has_lower_degree ? PreconditionerKind::pmg
                                                   : PreconditionerKind::ssor;
        if (factored.status != SolveStatus::success) return result;
        result.diagonal_shift = factored.diagonal_shift;

        const Stopwatch iteration;
        to_rows(B, b, right);
        solution.resize(B.size());
        const KrylovResult solved = std::visit(
            [&](auto& krylov) { return krylov.solve(B, *M, right.data(), solution.data()); }, method);
        to_nodes(B, solution, x);
        result.solve_seconds = iteration.seconds();
        result.status = solved.status;
        result.iterations = solved.iterations;
        result.work = solved.iterations * entries(A);
        result.relative_residual = solved.relative_residual;
        return result;
    }
};

struct LinearSolver::Direct {
    Cholesky cholesky;
    std::vector<double> residual, correction;

    Direct(const BlockCsr& A, const CholeskyParams& params)
        : cholesky(A, params), residual(A.size()), correction(A.size()) {}

    SolveResult solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x, bool again) {
        SolveResult result;
        result.relative_residual = 1;
        x.assign(A.size(), 0.0);
        const Stopwatch factorisation;
        const FactorResult factored = again ? FactorResult{SolveStatus::success} : cholesky.factor(A);
        result.work = factor_of_flops * std::pow(cholesky.flops(), power_of_flops);
        result.factor_seconds = factorisation.seconds();
        result.status = factored.status;
        result.bad_node = factored.bad_row;
        if (factored.status != SolveStatus::success) return result;

        const Stopwatch substitution;
        cholesky.solve(b.data(), x.data());
        result.solve_seconds = substitution.seconds();
        const double A_norm = norm_inf(A);
        double scaled = scaled_residual(A, A_norm, x, b, residual);
        if (scaled > refine_above) {
            cholesky.solve(residual.data(), correction.data());
            axpy(1, correction, x);
            const double refined = scaled_residual(A, A_norm, x, b, residual);
            if (!(refined <= scaled)) {
                axpy(-1, correction, x);
                scaled_residual(A, A_norm, x, b, residual);
            } else {
                scaled = refined;
            }
        }
        if (!(scaled <= acceptable_residual)) {
            result.status = SolveStatus::breakdown;
            x.assign(A.size(), 0.0);
            return result;
        }
        const double b_norm = norm_2(b);
        result.relative_residual = b_norm > 0 ? norm_2(residual) / b_norm : 0;
        return result;
    }
};

LinearSolver::LinearSolver(int dimension, const LinearSolverParams& params) : dimension_(dimension), params_(params) {}

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
    if (iterative_) return *iterative_;
    std::shared_ptr<const RowOrder> order = A.order;
    if (!order && params_.ordering)
        order = std::make_shared<RowOrder>(row_order(order_vertices(graph_of(A), *params_.ordering)));
    if (!order) order = std::make_shared<RowOrder>(cut_into_domains(graph_of(A)));
    const double patience = params_.fallback ? predicted_flops(A) / (worth * (flops_of_entry * entries(A))) : 0;
    iterative_ = std::make_unique<Iterative>(A, std::move(order), dimension_, params_,
                                             static_cast<int>(std::min<double>(patience, params_.max_iterations)));
    return *iterative_;
}

LinearSolver::Direct& LinearSolver::direct(const BlockCsr& A) {
    if (direct_) return *direct_;
    CholeskyParams params;
    params.memory_limit = params_.memory_limit;
    params.ordering = params_.ordering.value_or(params.ordering);
    direct_ = std::make_unique<Direct>(A, params);
    return *direct_;
}

bool iterates(double unknowns, int dimension, const LinearSolverParams& params) {
    if (params.kind != SolverKind::automatic) return params.kind != SolverKind::cholesky;
    return unknowns >= params.cg_from_unknowns[dimension - 2];
}

bool stores_half(double rows, double blocks, int dimension, const LinearSolverParams& params) {
    const auto by = params.preconditioner;
    return dimension == 3 && iterates(dimension * rows, dimension, params) && params.kind != SolverKind::gmres &&
           by != PreconditionerKind::ilu0 && by != PreconditionerKind::ssor && !params.ordering &&
           blocks >= std::max(params.half_from_blocks, row_of_half * rows);
}

std::shared_ptr<const RowOrder> sweep_order(const BlockCsr& pattern, int dimension, const LinearSolverParams& params,
                                            const Interpolation& of_vertices) {
    if (!iterates(pattern.size(), dimension, params) || params.ordering) return nullptr;
    auto order = std::make_shared<RowOrder>(cut_into_domains(graph_of(pattern)));
    order_interpolation(of_vertices, *order);
    order->in_half = of_vertices.columns > 0 && stores_half(pattern.n, pattern.blocks(), dimension, params);
    return order;
}

bool LinearSolver::iterative_first(const BlockCsr& A) {
    if (params_.kind != SolverKind::automatic) return params_.kind != SolverKind::cholesky;
    if (failures_ < failures_to_give_up && iterates(A.size(), dimension_, params_)) return true;
    return !direct(A).cholesky.fits();
}

// Of a Cholesky factorisation, with the exponents of nested dissection and the factors of the aircraft and the circle.
double LinearSolver::predicted_flops(const BlockCsr& A) const {
    if (direct_) return direct_->cholesky.flops();
    const double N = A.size();
    return dimension_ == 3 ? 5 * N * N : 56 * N * std::sqrt(N);
}

bool LinearSolver::direct_is_worth(const BlockCsr& A, int iterations) {
    failed_iterations_ += iterations;
    const double spent = std::max(worth * iterations, failed_iterations_) * flops_of_entry * entries(A);
    const auto costs_too_much = [&] { return predicted_flops(A) > spent; };
    if (costs_too_much()) return false;
    return direct(A).cholesky.fits() && !costs_too_much();
}

void LinearSolver::analyse(const BlockCsr& A) {
    if (iterative_first(A)) iterative(A);
    else direct(A);
}

SolveResult LinearSolver::solve_again(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    return direct_ ? solve_directly(A, b, x, true) : iterative_->solve(A, b, x, true);
}

SolveResult LinearSolver::solve_directly(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                                         bool again) {
    if (!A.order) return direct(A).solve(A, b, x, again);
    to_rows(A, b, b_);
    SolveResult result = direct(A).solve(A, b_, x_, again);
    to_nodes(A, x_, x);
    if (result.bad_node >= 0) result.bad_node = A.node_of(result.bad_node);
    return result;
}

SolveResult LinearSolver::solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                                bool may_be_indefinite) {
    x.assign(A.size(), 0.0);
    if (!iterative_first(A)) return solve_directly(A, b, x);
    const SolveResult first = iterative(A).solve(A, b, x);
    if (first.status == SolveStatus::success) failures_ = 0, failed_iterations_ = 0;
    if (first.status == SolveStatus::success || first.status == SolveStatus::not_positive_definite) return first;
    if (may_be_indefinite && first.status == SolveStatus::indefinite_preconditioner) return first;
    if (!params_.fallback || A.in_half()) return first;
    const bool tried = first.status != SolveStatus::indefinite_preconditioner;
    const bool of_ilu = first.preconditioner == PreconditionerKind::ilu0;
    if (tried ? !direct_is_worth(A, first.iterations) : !of_ilu || !direct(A).cholesky.fits()) return first;
    ++failures_;
    SolveResult second = solve_directly(A, b, x);
    second.iterations = first.iterations;
    second.work += first.work;
    second.failed_first = first.status;
    return second;
}

}  // namespace almesh
