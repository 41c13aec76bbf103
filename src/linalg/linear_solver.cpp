#include "linalg/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/krylov/conjugate_gradients.hpp"
#include "linalg/ordering/domains.hpp"
#include "linalg/krylov/gmres.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "linalg/krylov/reordered.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

const char* to_string(SolveStatus status) {
    switch (status) {
        case SolveStatus::converged: return "converged";
        case SolveStatus::max_iterations: return "max_iterations";
        case SolveStatus::stagnated: return "stagnated";
        case SolveStatus::breakdown: return "breakdown";
        case SolveStatus::indefinite_preconditioner: return "indefinite_preconditioner";
        case SolveStatus::not_positive_definite: return "not_positive_definite";
        case SolveStatus::too_large: return "too_large";
    }
    return "";
}

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

constexpr int failures_to_give_up = 2;   // of iterative solvers in a row, if the choice is ours

constexpr double refine_above = 1e-15;   // scaled residual from which a step of iterative refinement is worth a solve

SolveStatus status_of(GmresStatus status) {
    switch (status) {
        case GmresStatus::converged: return SolveStatus::converged;
        case GmresStatus::max_iterations: return SolveStatus::max_iterations;
        case GmresStatus::stagnated: return SolveStatus::stagnated;
        case GmresStatus::breakdown: break;
    }
    return SolveStatus::breakdown;
}

SolveStatus status_of(CgStatus status) {
    switch (status) {
        case CgStatus::converged: return SolveStatus::converged;
        case CgStatus::max_iterations: return SolveStatus::max_iterations;
        case CgStatus::stagnated: return SolveStatus::stagnated;
        case CgStatus::not_positive_definite: return SolveStatus::not_positive_definite;
        case CgStatus::breakdown: break;
    }
    return SolveStatus::breakdown;
}

// Largest sum of absolute values in a row. The largest of several numbers does not depend on their order, so the
// reduction gives the same bits for any number of threads.
double norm_inf(const BlockCsr& A) {
    double largest = 0;
#pragma omp parallel for schedule(static) reduction(max : largest)
    for (int i = 0; i < A.n; ++i)
        for (int r = 0; r < A.d; ++r) {
            double sum = 0;
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                for (int c = 0; c < A.d; ++c) sum += std::abs(A.block(k)[r * A.d + c]);
            largest = std::max(largest, sum);
        }
    return largest;
}

}  // namespace

struct LinearSolver::Iterative {
    Reordered system;  // domain by domain
    std::optional<Ilu0> ilu;
    std::optional<Deflation> deflation;    // with cg
    std::optional<ConjugateGradients> cg;  // one of the two
    std::optional<Gmres> gmres;
    std::vector<double> right, solution;

    Iterative(const BlockCsr& A, const LinearSolverParams& params)
        : Iterative(A, params, cut_into_domains(graph_of(A))) {}

    Iterative(const BlockCsr& A, const LinearSolverParams& params, const Domains& domains)
        : system(A, domains.order), right(A.size()), solution(A.size()) {
        const auto set_up_ilu = [&] { ilu.emplace(system.matrix(), domains.start); };
        if (params.kind == SolverKind::gmres) {
            set_up_ilu();
            gmres.emplace(A.size(), GmresParams{params.restart, params.max_iterations, params.tolerance});
        } else {
            parallel_invoke(set_up_ilu, [&] { deflation.emplace(system.matrix()); });
            cg.emplace(A.size(), CgParams{params.max_iterations, params.tolerance});
        }
    }

    void set_tolerance(double tolerance) {
        if (cg) cg->set_tolerance(tolerance);
        else gmres->set_tolerance(tolerance);
    }
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
    if (iterative_) iterative_->set_tolerance(tolerance);
}

double LinearSolver::factor_entries() const { return direct_ ? direct_->cholesky.factor_entries() : 0; }
double LinearSolver::factor_flops() const { return direct_ ? direct_->cholesky.flops() : 0; }

double LinearSolver::refused_bytes() const {
    return direct_ && !direct_->cholesky.fits() ? direct_->cholesky.predicted_bytes() : 0;
}

LinearSolver::Iterative& LinearSolver::iterative(const BlockCsr& A) {
    if (!iterative_) iterative_ = std::make_unique<Iterative>(A, params_);
    return *iterative_;
}

LinearSolver::Direct& LinearSolver::direct(const BlockCsr& A) {
    if (!direct_) {
        CholeskyParams params;
        params.memory_limit = params_.memory_limit;
        direct_ = std::make_unique<Direct>(A, params);
    }
    return *direct_;
}

bool LinearSolver::iterative_first(const BlockCsr& A) {
    if (params_.kind != SolverKind::automatic) return params_.kind != SolverKind::cholesky;
    if (failures_ < failures_to_give_up && dimension_ == 3 && A.size() >= params_.cg_from_unknowns) return true;
    return !direct(A).cholesky.fits();
}

SolveResult LinearSolver::solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x,
                                bool doubtful) {
    x.assign(A.size(), 0.0);
    if (!iterative_first(A)) return solve_directly(A, b, x);
    const SolveResult first = solve_iteratively(A, b, x);
    if (first.status == SolveStatus::converged) failures_ = 0;
    if (first.status == SolveStatus::converged || first.status == SolveStatus::not_positive_definite) return first;
    if (doubtful && first.status == SolveStatus::indefinite_preconditioner) return first;
    ++failures_;
    if (!direct(A).cholesky.fits()) return first;
    SolveResult second = solve_directly(A, b, x);
    second.iterations = first.iterations;
    second.fell_back = true;
    second.iterative_status = first.status;
    return second;
}

SolveResult LinearSolver::solve_iteratively(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    Iterative& own = iterative(A);
    const auto result_of = [&](SolverKind used, SolveStatus status, int iterations, double residual) {
        SolveResult result;
        result.used = used;
        result.status = result.iterative_status = status;
        result.iterations = iterations;
        result.relative_residual = residual;
        return result;
    };
    const SolverKind kind = own.cg ? SolverKind::cg : SolverKind::gmres;
    own.system.set(A);
    const BlockCsr& B = own.system.matrix();
    // In 2D bad pivots come from stretched elements, and iterations stagnate with any shift.
    const Ilu0Result factored = dimension_ == 3 ? own.ilu->factor_heavier(B) : own.ilu->factor(B);
    if (factored.status == Ilu0Status::not_positive_definite) {
        SolveResult result = result_of(kind, SolveStatus::indefinite_preconditioner, 0, 1);
        result.bad_node = own.system.order()[factored.bad_row];
        return result;
    }
    if (own.deflation && !own.deflation->factor(B)) return result_of(kind, SolveStatus::not_positive_definite, 0, 1);
    own.system.gather(b.data(), own.right.data());
    const auto finish = [&](const auto& solved) {
        own.system.scatter(own.solution.data(), x.data());
        SolveResult result = result_of(kind, status_of(solved.status), solved.iterations, solved.relative_residual);
        result.shift = factored.shift;
        return result;
    };
    const double* const right = own.right.data();
    if (own.gmres) return finish(own.gmres->solve(B, &*own.ilu, right, own.solution.data()));
    return finish(own.cg->solve(B, {&*own.ilu, &*own.deflation}, right, own.solution.data()));
}

SolveResult LinearSolver::solve_directly(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    Direct& own = direct(A);
    SolveResult result;
    result.relative_residual = 1;
    x.assign(A.size(), 0.0);
    const CholeskyResult factored = own.cholesky.factor(A);
    result.bad_node = factored.bad_node;
    if (factored.status != CholeskyStatus::factored) {
        result.status = factored.status == CholeskyStatus::too_large ? SolveStatus::too_large
                                                                     : SolveStatus::not_positive_definite;
        return result;
    }

    const int n = A.size();
    const double A_norm = norm_inf(A), b_norm = almesh::norm_inf(b);
    auto scaled = [&] {  // computes the residual too
        multiply(A, x.data(), own.residual.data());
        subtract(n, b.data(), own.residual.data(), own.residual.data());
        const double scale = A_norm * almesh::norm_inf(x) + b_norm, largest = almesh::norm_inf(own.residual);
        return scale > 0 ? largest / scale : largest;
    };
    own.cholesky.solve(b.data(), x.data());
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
        x.assign(n, 0.0);
        return result;
    }
    const double length = norm_2(b);
    result.relative_residual = length > 0 ? norm_2(own.residual) / length : 0;
    return result;
}

}  // namespace almesh
