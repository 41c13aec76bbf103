// The quadratic form of dirichlet.hpp and its derivatives, in the order of the paper's section 3.2, with the residual r
// of sliding_boundary.hpp, which is x - g_h where a position is prescribed, and its derivative D.
#include "constraint/dirichlet.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "geometry/patch.hpp"

namespace almesh {
namespace {

const Mesh no_faces;  // of a part

constexpr double mass_work = 40;     // simple operations that a row of M takes,
constexpr double matrix_work = 200;  // to be added to a matrix as well,
constexpr double surface_work = 1e3; // and finding a point of a surface, at least

}  // namespace

Dirichlet::Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target)
    : trace_(mesh, ideal, target), g_h_(trace_.interpolation(mesh, target)), mesh_(mesh), target_(target) {}

Dirichlet::Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target, TargetKind kind)
    : Dirichlet(mesh, ideal, target) {
    if (!target.prescribes_all()) throw InputError("not all positions of the boundary are prescribed");
    if (kind == TargetKind::nodal) return;
    if (!target.in_trace_space) g_h_ = trace_.projection(mesh, target);
    const double squared = deterministic_sum(mesh.face_count(), [&](int f) {  // |g_h - g_D|^2
        const FaceRule& rule = target.rules[mesh.face_group_number(f)];
        double sum = 0;
        for (int q = 0; q < rule.quadrature.count; ++q)
            sum += trace_.weight(rule, f, q) * squared_difference_at(g_h_, trace_.faces, f, q);
        return trace_.face_weight[f] * sum;
    });
    best_approximation_error_ = std::sqrt(squared) / trace_.norm_of_one;
}

Dirichlet::Dirichlet(const Dirichlet& whole, const Restriction& around)
    : trace_(whole.trace_, around), g_h_(trace_.restricted(whole.g_h_)), mesh_(no_faces) {}

std::unique_ptr<Constraint> Dirichlet::part(const Restriction& around, std::vector<double>& lambda) const {
    std::unique_ptr<Dirichlet> part(new Dirichlet(*this, around));
    lambda = part->trace_.restricted(lambda);
    return part;
}

// slope: D, unless null.
std::vector<double> Dirichlet::residual(const std::vector<double>& x, std::vector<Mat<3>>* slope) const {
    std::vector<double> r(trace_.size());
    if (slope) slope->resize(trace_.count());
    parallel_for(trace_.count(), [&](int t) {
        const SurfaceDistance here = distance(t, at(x, t));
        set_node(r, t, trace_.dim, here.r);
        if (slope) (*slope)[t] = here.slope;
    }, corrects_steps() ? surface_work : mass_work);
    return r;
}

// P c_D = r / |1|
std::vector<double> Dirichlet::constraint_field(const std::vector<double>& x) const {
    std::vector<double> c = residual(x);
    for (double& entry : c) entry /= trace_.norm_of_one;
    return c;
}

// |P c_D|
double Dirichlet::projected_norm(const std::vector<double>& x) {
    const std::vector<double> r = residual(x);
    const double squared = trace_.product(r, r);
    return std::sqrt(squared < 0 ? 0 : squared) / trace_.norm_of_one;  // rounding may be negative; nan stays nan
}

// |c_D|
double Dirichlet::norm(const std::vector<double>& x) {
    return std::hypot(projected_norm(x), best_approximation_error_);
}

// -(lambda, c_D) + mu/2 |c_D|^2 (Eq. 6) = (mu/2 r / |1| - lambda, r) / |1| + mu/2 e_h^2
double Dirichlet::value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) {
    const std::vector<double> r = residual(x);
    const double half = 0.5 * mu / trace_.norm_of_one;
    std::vector<double> u(r.size());
    for (std::size_t k = 0; k < u.size(); ++k) u[k] = half * r[k] - lambda[k];
    return trace_.product(u, r) / trace_.norm_of_one + 0.5 * mu * best_approximation_error_ * best_approximation_error_;
}

// D' M (mu r / |1| - lambda) / |1|
void Dirichlet::add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                             std::vector<double>& g) {
    std::vector<Mat<3>> D;
    const std::vector<double> v = trace_.force_density(residual(x, &D), lambda, mu);
    with_dimension(trace_.dim, [&](auto n) {
        parallel_for(trace_.count(), [&](int t) {
            double f[n], *const of_node = point(g, trace_.nodes[t], n);
            trace_.mass_times<n>(v, t, f);
            for (int a = 0; a < n; ++a)
                for (int b = 0; b < n; ++b) of_node[a] += D[t][b][a] * f[b];
        }, mass_work);
    });
}

// mu D' M D / |1|^2, positive semidefinite as it is, and where nodes slide the second derivative of r
void Dirichlet::add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
                            BlockCsr& H) {
    const BlockCsr& M = trace_.M;
    std::vector<Mat<3>> D;
    const std::vector<double> r = residual(x, &D);
    const double factor = mu / (trace_.norm_of_one * trace_.norm_of_one);
    with_dimension(trace_.dim, [&](auto n) {
        parallel_for(trace_.count(), [&](int t) {
            const int i = H.row_of(trace_.nodes[t]);
            for (int k = M.row[t]; k < M.row[t + 1]; ++k) {
                const Mat<3>&left = D[t], &right = D[M.col[k]];
                const double weight = factor * M.value[k];
                H.change_block(i, H.row_of(trace_.nodes[M.col[k]]), [&](double* block) {
                    for (int c = 0; c < n; ++c)
                        for (int ab = 0; ab < n * n; ++ab) block[ab] += weight * left[c][ab / n] * right[c][ab % n];
                });
            }
        }, matrix_work);
        if (projected) return;
        const std::vector<double> v = trace_.force_density(r, lambda, mu);
        parallel_for(trace_.count(), [&](int t) {
            if (!slides(t)) return;
            Vec<3> force{};
            trace_.mass_times<n>(v, t, force.data());
            const Mat<3> second = second_derivative_at(t, at(x, t), force);
            double* const block = H.diagonal(H.row_of(trace_.nodes[t]));
            for (int ab = 0; ab < n * n; ++ab) block[ab] += second[ab / n][ab % n];
        }, surface_work);
    });
}

// lambda <- lambda - mu P c_D (Algorithm 1, line 10)
void Dirichlet::update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) {
    const std::vector<double> r = residual(x);
    for (std::size_t k = 0; k < lambda.size(); ++k) lambda[k] -= mu * r[k] / trace_.norm_of_one;
}

// |u - g_D|^2 at a quadrature point of a face, u having the value trace[nodes[face node] x dim] at each face node.
double Dirichlet::squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes, int face,
                                        int point) const {
    const FaceRule& rule = target_.rules[mesh_.face_group_number(face)];
    const int m = mesh_.face_nodes(face), dim = trace_.dim;
    const int* const node = &nodes[mesh_.face_start(face)];
    double squared = 0;
    for (int a = 0; a < dim; ++a) {
        double d = -target_.sample[rule.sample(face, point) * dim + a];
        for (int i = 0; i < m; ++i) d += rule.values[offset(point, m, i)] * trace[offset(node[i], dim, a)];
        squared += d * d;
    }
    return squared;
}

double Dirichlet::max_error(const std::vector<double>& x) {
    const int dim = trace_.dim;
    double largest = 0;
    for (std::size_t k = 0; k < mesh_.faces.size(); ++k)
        largest = std::max(largest, length(at_node(x, mesh_.faces[k], dim) - in_space(&target_.node[k * dim], dim)));
    return largest;
}

double Dirichlet::error_between_nodes(const std::vector<double>& x) {
    double squared = 0;
    for (int f = 0; f < mesh_.face_count(); ++f)
        for (int q = 0; q < target_.rules[mesh_.face_group_number(f)].quadrature.count && target_.prescribes(mesh_, f);
             ++q)
            squared = std::max(squared, squared_difference_at(x, mesh_.faces, f, q));
    return std::sqrt(squared);
}

std::vector<double> Dirichlet::relative_errors(const std::vector<double>& x) const {
    std::vector<double> errors = trace_.distances(x, targets(x));
    for (std::size_t t = 0; t < errors.size(); ++t) errors[t] /= trace_.height[t];
    return errors;
}

std::vector<char> Dirichlet::off_target(const std::vector<double>& x) const {
    constexpr double rounding = 1e-13;
    const std::vector<double> target = targets(x);
    std::vector<char> off(trace_.nodes.size(), 0);
    for (std::size_t k = 0; k < target.size(); ++k) {
        const int t = static_cast<int>(k) / trace_.dim;
        const double is = x[offset(trace_.nodes[t], trace_.dim, static_cast<int>(k) % trace_.dim)];
        const double tolerance = slides(t) ? rounding * std::max(1.0, std::abs(target[k])) : 0;
        off[t] = off[t] || !(std::abs(is - target[k]) <= tolerance);
    }
    return off;
}

SurfaceDistance Dirichlet::distance(int t, const Vec<3>& x) const {
    SurfaceDistance from_target;
    for (int a = 0; a < trace_.dim; ++a) {
        from_target.r[a] = x[a] - g_h_[offset(t, trace_.dim, a)];
        from_target.slope[a][a] = 1;
    }
    return from_target;
}

}  // namespace almesh
