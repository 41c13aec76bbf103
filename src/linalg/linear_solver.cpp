#include "linalg/linear_solver.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/cholesky.hpp"
#include "linalg/gmres.hpp"
#include "linalg/graph.hpp"
#include "linalg/ilu0.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

const char* to_string(SolveStatus status) {
    switch (status) {
        case SolveStatus::converged: return "converged";
        case SolveStatus::max_iterations: return "max_iterations";
        case SolveStatus::stagnated: return "stagnated";
        case SolveStatus::breakdown: return "breakdown";
        case SolveStatus::zero_pivot: return "zero_pivot";
        case SolveStatus::not_positive_definite: return "not_positive_definite";
        case SolveStatus::too_large: return "too_large";
    }
    return "";
}

const char* to_string(SolverKind kind) {
    switch (kind) {
        case SolverKind::automatic: return "automatic";
        case SolverKind::gmres: return "gmres";
        case SolverKind::cholesky: return "cholesky";
    }
    return "";
}

namespace {

constexpr int failures_to_give_up = 2;   // of GMRES in a row, if the choice is ours
constexpr double refine_above = 1e-15;   // scaled residual from which a step of iterative refinement is worth a solve
constexpr double refuse_above = 1e-8;    // scaled residual at which x no longer counts as a solution

SolveStatus status_of(GmresStatus status) {
    switch (status) {
        case GmresStatus::converged: return SolveStatus::converged;
        case GmresStatus::max_iterations: return SolveStatus::max_iterations;
        case GmresStatus::stagnated: return SolveStatus::stagnated;
        case GmresStatus::breakdown: break;
    }
    return SolveStatus::breakdown;
}

double norm_inf(const BlockCsr& A) {
    double largest = 0;
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
    std::vector<int> order;        // reverse Cuthill-McKee: order[new] = old
    std::vector<int> source;       // blocks of A in the order of B
    BlockCsr B;                    // A renumbered
    Ilu0 ilu;
    Gmres gmres;
    std::vector<double> b, x;      // renumbered

    Iterative(const BlockCsr& A, const GmresParams& params)
        : order(reverse_cuthill_mckee(graph_of(A))), B(permuted_pattern(A, order, source)), ilu(B),
          gmres(A.size(), params), b(A.size()), x(A.size()) {}

    void load(const BlockCsr& A, const std::vector<double>& right) {
        const int block = A.d * A.d;
        for (int k = 0; k < A.blocks(); ++k) std::copy_n(A.block(source[k]), block, B.block(k));
        for (int i = 0; i < A.n; ++i)
            for (int r = 0; r < A.d; ++r) b[i * A.d + r] = right[order[i] * A.d + r];
    }

    void unload(std::vector<double>& to) const {
        for (int i = 0; i < B.n; ++i)
            for (int r = 0; r < B.d; ++r) to[order[i] * B.d + r] = x[i * B.d + r];
    }
};

struct LinearSolver::Direct {
    Cholesky cholesky;
    std::vector<double> residual, correction;

    Direct(const BlockCsr& A, const CholeskyParams& params)
        : cholesky(A, params), residual(A.size()), correction(A.size()) {}
};

LinearSolver::LinearSolver(const BlockCsr&, int dimension, const LinearSolverParams& params)
    : dimension_(dimension), params_(params) {}

LinearSolver::~LinearSolver() = default;

void LinearSolver::set_tolerance(double tolerance) {
    params_.tolerance = tolerance;
    if (iterative_) iterative_->gmres.set_tolerance(tolerance);
}

double LinearSolver::factor_entries() const { return direct_ ? direct_->cholesky.factor_entries() : 0; }
double LinearSolver::factor_flops() const { return direct_ ? direct_->cholesky.flops() : 0; }

double LinearSolver::refused_bytes() const {
    return direct_ && !direct_->cholesky.fits() ? direct_->cholesky.predicted_bytes() : 0;
}

LinearSolver::Iterative& LinearSolver::iterative(const BlockCsr& A) {
    if (!iterative_)
        iterative_ = std::make_unique<Iterative>(
            A, GmresParams{params_.restart, params_.max_iterations, params_.tolerance});
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

bool LinearSolver::gmres_first(const BlockCsr& A) {
    if (params_.kind == SolverKind::cholesky) return false;
    if (params_.kind == SolverKind::gmres) return true;
    const Cholesky& cholesky = direct(A).cholesky;
    if (!cholesky.fits()) return true;
    return dimension_ == 3 && cholesky.flops() > params_.gmres_from_flops && failures_ < failures_to_give_up;
}

SolveResult LinearSolver::solve(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    x.assign(A.size(), 0.0);
    if (!gmres_first(A)) return solve_directly(A, b, x);
    const SolveResult first = solve_iteratively(A, b, x);
    if (first.status == SolveStatus::converged) {
        failures_ = 0;
        return first;
    }
    ++failures_;
    if (!direct(A).cholesky.fits()) return first;
    SolveResult second = solve_directly(A, b, x);
    second.iterations = first.iterations;
    second.fell_back = true;
    second.gmres_status = first.status;
    return second;
}

SolveResult LinearSolver::solve_iteratively(const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    Iterative& own = iterative(A);
    own.load(A, b);
    SolveResult result;
    result.used = SolverKind::gmres;
    const Ilu0Result factored = own.ilu.factor(own.B);
    if (factored.status == Ilu0Status::zero_pivot) {
        result.status = result.gmres_status = SolveStatus::zero_pivot;
        result.bad_node = own.order[factored.bad_row];
        result.relative_residual = 1;
        return result;
    }
    const GmresResult solved = own.gmres.solve(own.B, &own.ilu, own.b.data(), own.x.data());
    own.unload(x);
    result.status = result.gmres_status = status_of(solved.status);
    result.iterations = solved.iterations;
    result.relative_residual = solved.relative_residual;
    return result;
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
    if (!(residual <= refuse_above)) {
        result.status = SolveStatus::breakdown;
        x.assign(n, 0.0);
        return result;
    }
    const double length = norm_2(b);
    result.relative_residual = length > 0 ? norm_2(own.residual) / length : 0;
    return result;
}

}  // namespace almesh
