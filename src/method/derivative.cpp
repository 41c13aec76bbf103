// x is polished and kappa updated until P (H + K) P y = -P grad E has a y of rounding; then the derivatives with that
// factorisation.
#include "method/derivative.hpp"

#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "linalg/vector_ops.hpp"
#include "method/fixed_nodes.hpp"

namespace almesh {
namespace {

constexpr int most_updates = 20;        // of kappa, to a Newton decrement of
constexpr double negligible = 1e-9;     // at most this, relative to E,
constexpr double acceptable = 1e-5;     // or this where rounding lets it fall no further
constexpr double slight = 1e-6, undistorted = 1e-10;  // largest eta - 1
constexpr double tolerance = 1e-13;     // of iterative solvers,
constexpr int most_iterations = 10000;  // and how many iterations they have

template <class... Parts>
Error no_derivative(const Parts&... why) { return {ExitCode::not_converged, concat("no derivative: ", why...)}; }

}  // namespace

Derivative::Derivative(const Mesh& mesh, DistortionEnergy& energy, Constraint& constraint,
                       const LinearSolverParams& linear)
    : mesh_(mesh), energy_(energy), on_target_(energy, constraint, mesh.nodes()), given_(linear),
      H_(energy.hessian_pattern()), A_(H_) {
    if (linear_.kind == SolverKind::automatic) linear_.kind = SolverKind::cholesky;
    linear_.tolerance = tolerance;
    linear_.max_iterations = most_iterations;
    linear_.fallback = false;
    solver_ = std::make_unique<LinearSolver>(mesh.dim, linear_);
}

void Derivative::polish(std::vector<double>& x) {
    double decrement = std::numeric_limits<double>::infinity(), before = decrement;
    Newton newton(energy_.hessian_pattern(), given_);
    for (int update = 0; decrement > negligible && !(decrement <= acceptable && decrement > 0.5 * before); ++update) {
        before = decrement;
        if (almesh::polish(on_target_, newton, 0, x).status == Status::stalled)
            throw no_derivative(counted(nodes_off_target(on_target_.constraint, x), "node"),
                                " of the boundary cannot be set to the target");
        const std::vector<double> b = set_point(x), d = solve(b, kappa_.u, kappa_.v);
        decrement = std::sqrt(std::abs(dot(b, d)) / energy_.energy(x));
        if (update == most_updates || !std::isfinite(decrement)) throw not_stationary(decrement);
    }
}

std::vector<double> Derivative::set_point(const std::vector<double>& x) {
    x_ = x;
    update_kappa(energy_, x);
    kappa_ = change_of_kappa(energy_, x);
    std::vector<double> gradient = on_target_.set_point(x);
    assemble(HessianKind::full);
    for (double& entry : gradient) entry = -entry;
    return gradient;
}

void Derivative::assemble(HessianKind kind) {
    is_factored_ = false;
    std::fill(H_.value.begin(), H_.value.end(), 0.0);
    energy_.add_hessian(x_, kind, H_);
    energy_.pairs().fold(H_);
    std::copy(H_.value.begin(), H_.value.end(), A_.value.begin());
    on_target_.project(A_);
}

std::vector<double> Derivative::solve(const std::vector<double>& b, std::vector<double> u,
                                      const std::vector<double>& v) {
    std::vector<double> y = solve_with_A(b);
    if (u.empty()) return y;
    on_target_.project(u);
    const std::vector<double> z = solve_with_A(u);
    const double left = 1 - dot(v, z);
    if (!(left > 0)) throw singular(-1);
    axpy(dot(v, y) / left, z, y);
    return y;
}

Error Derivative::not_stationary(double decrement) {
    const bool is_slight = energy_.statistics(x_).max_distortion - 1 <= slight;
    return no_derivative("the gradient is not small enough: relative to E its Newton decrement is ",
                         rounded_down(decrement, 3), ", and may be ", acceptable,
                         is_slight ? "; rounding leaves few digits of so little distortion: try objective = squared"
                                   : "; a mesh far from the origin has few digits: move it there");
}

Error Derivative::singular(int bad_node) {
    if (energy_.statistics(x_).max_distortion - 1 <= undistorted) {
        assemble(HessianKind::damping);
        std::vector<double> b = x_, y;
        on_target_.project(b);
        if (solver_->solve(A_, b, y).status == SolveStatus::success)
            return no_derivative("eta - 1 is at most ", undistorted, " everywhere, and there (eta - 1)^2 is flat: with "
                                 "objective = squared the mesh has a derivative");
    }
    const std::string where = bad_node < 0 ? "" : concat(", first at node ", mesh_.file.node_id[bad_node]);
    return no_derivative("the Hessian at the mesh is singular or indefinite", where, ": it is no isolated minimum");
}

std::vector<double> Derivative::solve_with_A(const std::vector<double>& b) {
    std::vector<double> y;
    SolveResult result = is_factored_ ? solver_->solve_again(A_, b, y) : solver_->solve(A_, b, y);
    if (result.status == SolveStatus::too_large) {
        linear_.kind = SolverKind::cg;
        solver_ = std::make_unique<LinearSolver>(mesh_.dim, linear_);
        result = solver_->solve(A_, b, y);
    }
    if (result.status == SolveStatus::not_positive_definite) throw singular(result.bad_node);
    if (result.status != SolveStatus::success) throw no_derivative("its linear system: ", reason(result.status));
    is_factored_ = true;
    on_target_.project(y);
    return y;
}

std::vector<double> Derivative::tangent(const BoundaryChange& change) {
    std::vector<double> b = times_at_nodes(H_, change.shift);
    axpy(-dot(kappa_.v, change.shift), kappa_.u, b);
    for (std::size_t k = 0; k < b.size(); ++k) b[k] = -(b[k] + change.force[k]);
    on_target_.project(b);
    std::vector<double> dx = solve(b, kappa_.u, kappa_.v);
    axpy(1, change.shift, dx);
    energy_.pairs().spread(dx);
    return dx;
}

BoundaryChange Derivative::adjoint(std::vector<double> dJ_dx) {
    energy_.pairs().fold(dJ_dx);
    std::vector<double> b = dJ_dx;
    for (double& entry : b) entry = -entry;
    on_target_.project(b);
    const std::vector<double> p = solve(b, kappa_.v, kappa_.u);
    BoundaryChange by{times_at_nodes(H_, p), p};
    axpy(-dot(kappa_.u, p), kappa_.v, by.shift);
    axpy(1, dJ_dx, by.shift);
    for (std::size_t k = 0; k < p.size(); ++k)
        if (on_target_.place(static_cast<int>(k) / mesh_.dim) < 0) by.shift[k] = by.force[k] = 0;
    return by;
}

BoundaryChange Derivative::residual(const Constraint& other) const {
    BoundaryChange result{std::vector<double>(x_.size(), 0.0), std::vector<double>(x_.size(), 0.0)};
    for (const OnTarget::Node& of : on_target_.nodes()) {
        const SurfaceDistance distance = other.distance(on_target_.place(of.node), at_node(x_, of.node, mesh_.dim));
        set_node(result.shift, of.node, mesh_.dim, distance.r);
        set_node(result.force, of.node, mesh_.dim, times(transpose<3>(distance.slope), of.f));
    }
    return result;
}

BoundaryChange Derivative::change(BoundaryChange of_residual) const {
    for (const OnTarget::Node& of : on_target_.nodes()) {
        const Vec<3> r = at_node(of_residual.shift, of.node, mesh_.dim);
        const Vec<3> shift = times(of.D_inverse, times(of.P, r) - r);
        const Vec<3> force = times(of.K, shift) + at_node(of_residual.force, of.node, mesh_.dim);
        set_node(of_residual.shift, of.node, mesh_.dim, shift);
        set_node(of_residual.force, of.node, mesh_.dim, force);
    }
    return of_residual;
}

}  // namespace almesh
