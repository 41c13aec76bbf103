// x <- x + P y,  P (H + K) P y = -P grad E,  until y is rounding; then the derivatives with the last factorisation.
#include "method/derivative.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "constraint/sliding_nodes.hpp"
#include "linalg/vector_ops.hpp"
#include "method/fixed_nodes.hpp"
#include "method/snap.hpp"

namespace almesh {
namespace {

constexpr int most_steps = 12;          // of Newton's method, which converges quadratically, to a last one with
constexpr double negligible = 1e-9;     // at most this decrement, relative to E,
constexpr double acceptable = 1e-5;     // or this one where rounding lets it fall no further
constexpr double slight = 1e-6, undistorted = 1e-10;  // largest eta - 1
constexpr double tolerance = 1e-13;     // of iterative solvers,
constexpr int most_iterations = 10000;  // and how many iterations they have

Vec<3> times(const Mat<3>& A, const Vec<3>& v) { return {dot(A[0], v), dot(A[1], v), dot(A[2], v)}; }

Vec<3> at_node(const std::vector<double>& v, int node, int dim) { return in_space(point(v, node, dim), dim); }

void set_node(std::vector<double>& v, int node, int dim, const Vec<3>& value) {
    std::copy_n(value.begin(), dim, point(v, node, dim));
}

template <class... Parts>
Error no_derivative(const Parts&... why) { return {ExitCode::not_converged, concat("no derivative: ", why...)}; }

// The projector onto the kernel of D, which is symmetric and not negative: takes away the longest of its columns that
// are left until there is none.
Mat<3> kernel_of(const Mat<3>& D, int dim) {
    constexpr double zero = 1e-12;  // squared
    Mat<3> P{};
    for (int a = 0; a < dim; ++a) P[a][a] = 1;
    for (;;) {
        Vec<3> u{};
        for (const Vec<3>& column : D)
            if (const Vec<3> left = times(P, column); dot(left, left) > dot(u, u)) u = left;
        if (dot(u, u) <= zero) return P;
        for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b) P[a][b] -= u[a] * u[b] / dot(u, u);
    }
}

}  // namespace

Derivative::Derivative(const Mesh& mesh, DistortionEnergy& energy, const Constraint& constraint,
                       const LinearSolverParams& linear)
    : mesh_(mesh), energy_(energy), constraint_(constraint), linear_(linear), place_(mesh.nodes(), -1),
      H_(energy.hessian_pattern()), A_(H_) {
    for (const int node : constraint.nodes()) {
        place_[node] = static_cast<int>(nodes_.size());
        nodes_.push_back({node, {}, {}, {}, {}});
    }
    if (linear_.kind == SolverKind::automatic) linear_.kind = SolverKind::cholesky;
    linear_.tolerance = tolerance;
    linear_.max_iterations = most_iterations;
    linear_.fallback = false;
    solver_ = std::make_unique<LinearSolver>(mesh.dim, linear_);
}

void Derivative::settle(std::vector<double>& x) {
    if (nodes_off_target(constraint_, x) > 0 && snap_to_targets(energy_, constraint_, x) > 0)
        throw no_derivative(counted(nodes_off_target(constraint_, x), "node"),
                            " of the boundary cannot be set to the target");
    double decrement = std::numeric_limits<double>::infinity(), before = decrement;
    for (int step = 1; decrement > negligible && !(decrement <= acceptable && decrement > 0.5 * before); ++step) {
        before = decrement;
        const std::vector<double> b = set_point(x), d = solve(b, kappa_.u, kappa_.v);
        decrement = std::sqrt(std::abs(dot(b, d)) / energy_.energy(x));
        std::vector<double> next = x;
        axpy(1, d, next);
        const std::vector<double> on_target = constraint_.targets(next);
        for (const Node& of : nodes_)
            set_node(next, of.node, mesh_.dim, at_node(on_target, place_[of.node], mesh_.dim));
        if (step > most_steps || !std::isfinite(decrement) || !std::isfinite(energy_.energy(next)))
            throw not_stationary(decrement);
        x = std::move(next);
    }
    set_point(x);
}

std::vector<double> Derivative::set_point(const std::vector<double>& x) {
    x_ = x;
    update_kappa(energy_, x);
    kappa_ = change_of_kappa(energy_, x);
    std::vector<double> gradient(x.size(), 0.0);
    energy_.add_gradient(x, gradient);
    for (Node& of : nodes_) {
        const Vec<3> at = at_node(x, of.node, mesh_.dim), force = at_node(gradient, of.node, mesh_.dim);
        Mat<3> D = constraint_.distance(place_[of.node], at).slope;
        of.P = kernel_of(D, mesh_.dim);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) D[a][b] += a < mesh_.dim ? of.P[a][b] : a == b;
        of.D_inverse = inverse<3>(D);
        of.f = times(of.D_inverse, times(of.P, force) - force);
        of.K = constraint_.second_derivative_at(place_[of.node], at, of.f);
    }
    assemble(HessianKind::full);
    for (double& entry : gradient) entry = -entry;
    project(gradient);
    return gradient;
}

void Derivative::assemble(HessianKind kind) {
    is_factored_ = false;
    std::fill(H_.value.begin(), H_.value.end(), 0.0);
    energy_.add_hessian(x_, kind, H_);
    std::copy(H_.value.begin(), H_.value.end(), A_.value.begin());
    const int d = mesh_.dim;
    const Node inside{-1, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}, {}, {}};
    const auto node_of_row = [&](int i) -> const Node& {
        const int place = place_[A_.node_of(i)];
        return place < 0 ? inside : nodes_[place];
    };
    parallel_for(A_.n, [&](int i) {
        const Node& left = node_of_row(i);
        for (int k = A_.row[i]; k < A_.row[i + 1]; ++k) {
            const Node& right = node_of_row(A_.col[k]);
            if (left.node < 0 && right.node < 0) continue;
            const bool is_diagonal = A_.col[k] == i;
            double* const block = A_.block(k);
            Mat<3> B{};
            for (int a = 0; a < d; ++a)
                for (int b = 0; b < d; ++b) B[a][b] = block[a * d + b] + (is_diagonal ? left.K[a][b] : 0);
            const double size = std::sqrt(frobenius_squared<3>(B)), scale = !is_diagonal ? 0 : size > 0 ? size : 1;
            B = multiply<3>(multiply<3>(left.P, B), right.P);
            for (int a = 0; a < d; ++a)
                for (int b = 0; b < d; ++b) block[a * d + b] = B[a][b] + scale * ((a == b) - left.P[a][b]);
        }
    });
}

std::vector<double> Derivative::solve(const std::vector<double>& b, std::vector<double> u,
                                      const std::vector<double>& v) {
    std::vector<double> y = solve_with_A(b);
    if (u.empty()) return y;
    project(u);
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
        project(b);
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
    project(y);
    return y;
}

void Derivative::project(std::vector<double>& v) const {
    for (const Node& of : nodes_) set_node(v, of.node, mesh_.dim, times(of.P, at_node(v, of.node, mesh_.dim)));
}

std::vector<double> Derivative::tangent(const BoundaryChange& change) {
    std::vector<double> b = times_at_nodes(H_, change.shift);
    axpy(-dot(kappa_.v, change.shift), kappa_.u, b);
    for (std::size_t k = 0; k < b.size(); ++k) b[k] = -(b[k] + change.force[k]);
    project(b);
    std::vector<double> dx = solve(b, kappa_.u, kappa_.v);
    axpy(1, change.shift, dx);
    return dx;
}

BoundaryChange Derivative::adjoint(const std::vector<double>& dJ_dx) {
    std::vector<double> b = dJ_dx;
    for (double& entry : b) entry = -entry;
    project(b);
    const std::vector<double> p = solve(b, kappa_.v, kappa_.u);
    BoundaryChange by{times_at_nodes(H_, p), p};
    axpy(-dot(kappa_.u, p), kappa_.v, by.shift);
    axpy(1, dJ_dx, by.shift);
    for (std::size_t k = 0; k < p.size(); ++k)
        if (place_[k / mesh_.dim] < 0) by.shift[k] = by.force[k] = 0;
    return by;
}

BoundaryChange Derivative::residual(const Constraint& other) const {
    BoundaryChange result{std::vector<double>(x_.size(), 0.0), std::vector<double>(x_.size(), 0.0)};
    for (const Node& of : nodes_) {
        const SurfaceDistance distance = other.distance(place_[of.node], at_node(x_, of.node, mesh_.dim));
        set_node(result.shift, of.node, mesh_.dim, distance.r);
        set_node(result.force, of.node, mesh_.dim, times(transpose<3>(distance.slope), of.f));
    }
    return result;
}

BoundaryChange Derivative::change(BoundaryChange of_residual) const {
    for (const Node& of : nodes_) {
        const Vec<3> r = at_node(of_residual.shift, of.node, mesh_.dim);
        const Vec<3> shift = times(of.D_inverse, times(of.P, r) - r);
        const Vec<3> force = times(of.K, shift) + at_node(of_residual.force, of.node, mesh_.dim);
        set_node(of_residual.shift, of.node, mesh_.dim, shift);
        set_node(of_residual.force, of.node, mesh_.dim, force);
    }
    return of_residual;
}

}  // namespace almesh
