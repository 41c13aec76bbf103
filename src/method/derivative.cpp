// x <- x + P y,  P (H + K) P y = -P grad E,  until y is rounding; then the derivatives with the last factorisation.
#include "method/derivative.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "linalg/vector_ops.hpp"
#include "method/snap.hpp"

namespace almesh {
namespace {

constexpr int most_steps = 12;         // of Newton's method, in settle(),
constexpr double negligible = 1e-12;   // whose last one strains no edge more than this,
constexpr double acceptable = 1e-9;    // or, where rounding does not let it, than this
constexpr double tolerance = 1e-13;    // of iterative solvers,
constexpr int most_iterations = 10000; // and how many iterations they have
constexpr int refinements = 2;         // of the solution by Cholesky

Vec<3> times(const Mat<3>& A, const Vec<3>& v) { return {dot(A[0], v), dot(A[1], v), dot(A[2], v)}; }

Vec<3> node_of(const std::vector<double>& v, int node, int dim) {
    Vec<3> result{};
    std::copy_n(point(v, node, dim), dim, result.begin());
    return result;
}

void set_node(std::vector<double>& v, int node, int dim, const Vec<3>& value) {
    std::copy_n(value.begin(), dim, point(v, node, dim));
}

// The projector onto the kernel of a symmetric matrix that is not negative: takes away the longest of its columns that
// are left until there is none.
Mat<3> kernel_of(const Mat<3>& D, int dim) {
    constexpr double zero = 1e-6;
    Mat<3> P{};
    for (int a = 0; a < dim; ++a) P[a][a] = 1;
    for (int rank = 0; rank < dim; ++rank) {
        Vec<3> longest{};
        for (int a = 0; a < dim; ++a)  // D is symmetric: its rows are its columns
            if (const Vec<3> left = times(P, D[a]); dot(left, left) > dot(longest, longest)) longest = left;
        const double length = std::sqrt(dot(longest, longest));
        if (length <= zero) break;
        const Vec<3> u = 1 / length * longest;
        for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b) P[a][b] -= u[a] * u[b];
    }
    return P;
}

// (D + P)^-1 - P; in the plane the third row and column do not count.
Mat<3> inverse_beside_kernel(Mat<3> D, const Mat<3>& P, int dim) {
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) D[a][b] += P[a][b];
    if (dim == 2) D[2] = {0, 0, 1};
    D = inverse<3>(D);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) D[a][b] = a < dim && b < dim ? D[a][b] - P[a][b] : 0;
    return D;
}

}  // namespace

Derivative::Derivative(const Mesh& mesh, DistortionEnergy& energy, const Constraint& constraint,
                       const LinearSolverParams& linear)
    : mesh_(mesh), energy_(energy), constraint_(constraint), linear_(linear), trace_(mesh.nodes(), -1),
      nodes_(constraint.nodes().size()), H_(energy.hessian_pattern()), A_(H_) {
    for (std::size_t t = 0; t < nodes_.size(); ++t) trace_[constraint.nodes()[t]] = static_cast<int>(t);
    const auto is_iterative = [](SolverKind kind) { return kind == SolverKind::cg || kind == SolverKind::gmres; };
    if (!is_iterative(linear.kind)) {
        CholeskyParams params;
        params.memory_limit = linear.memory_limit;
        params.ordering = linear.ordering.value_or(params.ordering);
        cholesky_ = std::make_unique<Cholesky>(A_, params);
        if (cholesky_->fits()) return;
        cholesky_.reset();
        linear_.kind = SolverKind::cg;
    }
    linear_.tolerance = tolerance;
    linear_.max_iterations = most_iterations;
    linear_.fallback = false;
    iterative_ = std::make_unique<LinearSolver>(mesh.dim, linear_);
}

std::string Derivative::settle(std::vector<double>& x) {
    if (const int off = snap_to_targets(energy_, constraint_, x); off > 0)
        return concat(counted(off, "node"), " of the boundary cannot be set to the target, elements would invert");
    double before = std::numeric_limits<double>::infinity();
    for (int step = 0;; ++step) {
        std::vector<double> d = set_point(x);
        assemble();
        if (const std::string why = factor(); !why.empty()) return why;
        for (double& entry : d) entry = -entry;
        d = solve(d);
        if (!failure_.empty()) return failure_;
        const double strain = largest_strain(d);
        const bool at_rounding = strain <= acceptable && strain > 0.5 * before;
        if (strain <= negligible || at_rounding) return "";
        std::vector<double> next = x;
        axpy(1, d, next);
        const std::vector<double> on_target = constraint_.targets(next);
        for (std::size_t t = 0; t < nodes_.size(); ++t)
            set_node(next, constraint_.nodes()[t], mesh_.dim, node_of(on_target, static_cast<int>(t), mesh_.dim));
        if (step == most_steps || !std::isfinite(strain) || !std::isfinite(energy_.energy(next)))
            return concat("the gradient is not small enough: the next Newton step would strain an element's edge by ",
                          rounded_down(strain, 3), ", and ", acceptable, " is the most for a derivative");
        x = std::move(next);
        before = strain;
    }
}

std::vector<double> Derivative::set_point(const std::vector<double>& x) {
    x_ = x;
    std::vector<double> gradient(x.size(), 0.0);
    energy_.add_gradient(x, gradient);
    for (int t = 0; t < static_cast<int>(nodes_.size()); ++t) {
        const int node = constraint_.nodes()[t];
        const Vec<3> at = node_of(x, node, mesh_.dim);
        const Mat<3> D = constraint_.distance(t, at).slope;
        Node& of_node = nodes_[t];
        of_node.P = kernel_of(D, mesh_.dim);
        of_node.D_inverse = inverse_beside_kernel(D, of_node.P, mesh_.dim);
        of_node.f = -1 * times(of_node.D_inverse, node_of(gradient, node, mesh_.dim));
        of_node.K = constraint_.second_derivative_at(t, at, of_node.f);
    }
    project(gradient);
    return gradient;
}

void Derivative::assemble() {
    std::fill(H_.value.begin(), H_.value.end(), 0.0);
    energy_.add_hessian(x_, HessianKind::full, H_);
    std::copy(H_.value.begin(), H_.value.end(), A_.value.begin());
    const int d = mesh_.dim;
    Mat<3> one{};
    for (int a = 0; a < d; ++a) one[a][a] = 1;
    parallel_for(A_.n, [&](int i) {
        const int row_trace = trace_[A_.node_of(i)];
        for (int k = A_.row[i]; k < A_.row[i + 1]; ++k) {
            const int column_trace = trace_[A_.node_of(A_.col[k])];
            if (row_trace < 0 && column_trace < 0) continue;
            const bool is_diagonal = A_.col[k] == i;
            const Mat<3>& left = row_trace < 0 ? one : nodes_[row_trace].P;
            const Mat<3>& right = column_trace < 0 ? one : nodes_[column_trace].P;
            Mat<3> B{};
            double mean = 0;
            for (int a = 0; a < d; ++a) {
                for (int b = 0; b < d; ++b)
                    B[a][b] = A_.block(k)[a * d + b] + (is_diagonal ? nodes_[row_trace].K[a][b] : 0);
                mean += std::abs(A_.block(k)[a * d + a]) / d;
            }
            B = multiply<3>(multiply<3>(left, B), right);
            for (int a = 0; a < d; ++a)
                for (int b = 0; b < d; ++b)
                    A_.block(k)[a * d + b] = B[a][b] + (is_diagonal ? mean * (one[a][b] - left[a][b]) : 0);
        }
    });
}

std::string Derivative::factor() {
    failure_.clear();
    if (!cholesky_) return "";
    const FactorResult factored = cholesky_->factor(A_);
    if (factored.status == SolveStatus::success) return "";
    if (factored.status != SolveStatus::not_positive_definite || factored.bad_row < 0) return reason(factored.status);
    return concat("the Hessian at the mesh is singular or indefinite, first at node ",
                  mesh_.file.node_id[A_.node_of(factored.bad_row)],
                  ": the mesh is no isolated minimum of its functional");
}

// A y = P b; y = P y.
std::vector<double> Derivative::solve(const std::vector<double>& b) {
    std::vector<double> y(b.size());
    if (iterative_) {
        const SolveResult result = iterative_->solve(A_, b, y);
        if (result.status != SolveStatus::success)
            failure_ = concat("the linear system of the derivative is not solved: ", reason(result.status));
        project(y);
        return y;
    }
    std::vector<double> right, rows(b.size()), residual(b.size()), correction(b.size());
    to_rows(A_, b, right);
    cholesky_->solve(right.data(), rows.data());
    const double A_norm = norm_inf(A_);
    for (int k = 0; k < refinements; ++k) {
        scaled_residual(A_, A_norm, rows, right, residual);
        cholesky_->solve(residual.data(), correction.data());
        axpy(1, correction, rows);
    }
    if (!(scaled_residual(A_, A_norm, rows, right, residual) <= acceptable_residual))
        failure_ = "the Hessian at the mesh is singular to rounding";
    to_nodes(A_, rows, y);
    project(y);
    return y;
}

void Derivative::project(std::vector<double>& v) const {
    for (std::size_t t = 0; t < nodes_.size(); ++t) {
        const int node = constraint_.nodes()[t];
        set_node(v, node, mesh_.dim, times(nodes_[t].P, node_of(v, node, mesh_.dim)));
    }
}

std::vector<double> Derivative::times_hessian(const std::vector<double>& v) const {
    std::vector<double> rows, product(v.size()), result;
    to_rows(H_, v, rows);
    multiply(H_, rows.data(), product.data());
    to_nodes(H_, product, result);
    return result;
}

std::vector<double> Derivative::tangent(const BoundaryChange& change) {
    std::vector<double> b = times_hessian(change.shift);
    for (std::size_t k = 0; k < b.size(); ++k) b[k] = -(b[k] + change.force[k]);
    project(b);
    std::vector<double> dx = solve(b);
    axpy(1, change.shift, dx);
    return dx;
}

BoundaryChange Derivative::adjoint(const std::vector<double>& dJ_dx) {
    std::vector<double> b = dJ_dx;
    for (double& entry : b) entry = -entry;
    project(b);
    const std::vector<double> p = solve(b);
    BoundaryChange by{times_hessian(p), p};
    axpy(1, dJ_dx, by.shift);
    for (int i = 0; i < mesh_.nodes(); ++i) {
        if (trace_[i] >= 0) continue;
        set_node(by.shift, i, mesh_.dim, {});
        set_node(by.force, i, mesh_.dim, {});
    }
    return by;
}

BoundaryChange Derivative::residual(const Constraint& other) const {
    BoundaryChange result{std::vector<double>(x_.size(), 0.0), std::vector<double>(x_.size(), 0.0)};
    for (int t = 0; t < static_cast<int>(nodes_.size()); ++t) {
        const int node = constraint_.nodes()[t];
        const SurfaceDistance distance = other.distance(t, node_of(x_, node, mesh_.dim));
        set_node(result.shift, node, mesh_.dim, distance.r);
        set_node(result.force, node, mesh_.dim, times(transpose<3>(distance.slope), nodes_[t].f));
    }
    return result;
}

BoundaryChange Derivative::change(const BoundaryChange& of_residual) const {
    BoundaryChange result = of_residual;
    for (std::size_t t = 0; t < nodes_.size(); ++t) {
        const int node = constraint_.nodes()[t], dim = mesh_.dim;
        const Vec<3> shift = -1 * times(nodes_[t].D_inverse, node_of(of_residual.shift, node, dim));
        set_node(result.shift, node, dim, shift);
        set_node(result.force, node, dim, times(nodes_[t].K, shift) + node_of(of_residual.force, node, dim));
    }
    return result;
}

// Of an element's edge or diagonal between two vertices, by the displacement d.
double Derivative::largest_strain(const std::vector<double>& d) const {
    double largest = 0;
    for (int e = 0; e < mesh_.element_count(); ++e) {
        const int* const node = mesh_.element(e);
        for (int i = 0; i < mesh_.cell(e).vertices; ++i)
            for (int k = 0; k < i; ++k) {
                const Vec<3> edge = node_of(x_, node[i], mesh_.dim) - node_of(x_, node[k], mesh_.dim);
                const Vec<3> change = node_of(d, node[i], mesh_.dim) - node_of(d, node[k], mesh_.dim);
                const double strain = std::sqrt(dot(change, change) / dot(edge, edge));
                if (!(strain <= largest)) largest = strain;  // nan stays
            }
    }
    return largest;
}

}  // namespace almesh
