// The trace mass matrix M, the projection M g_h = (N, g_D) of the target, and the quadratic form of dirichlet.hpp.
#include "constraint/dirichlet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/small_matrix.hpp"
#include "constraint/quadratic_part.hpp"
#include "constraint/tangent_planes.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/vector_ops.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

constexpr double mass_work = 40;       // simple operations that a row of M takes,
constexpr double surface_work = 1e3;   // and finding the closest point of a surface, at least

// Length of the edge or area of the triangle spanned by the face's vertices.
double face_measure(const Mesh& mesh, const std::vector<double>& ideal, int f) {
    const auto edge = [&](int v, int a) {
        return ideal[offset(mesh.face(f)[v], mesh.dim, a)] - ideal[offset(mesh.face(f)[0], mesh.dim, a)];
    };
    if (mesh.dim == 2) return std::hypot(edge(1, 0), edge(1, 1));
    const double n0 = edge(1, 1) * edge(2, 2) - edge(1, 2) * edge(2, 1),
                 n1 = edge(1, 2) * edge(2, 0) - edge(1, 0) * edge(2, 2),
                 n2 = edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0);
    return 0.5 * std::hypot(n0, n1, n2);
}

}  // namespace

Dirichlet::Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target, TargetKind kind,
                     std::shared_ptr<const SlidingSurfaces> sliding)
    : dim_(mesh.dim), kind_(kind), mesh_(mesh), target_(target), sliding_(std::move(sliding)) {
    const LagrangeBasis basis(dim_ - 1, mesh.degree);
    face_values_.resize(offset(target.quadrature.count, basis.count));
    for (int q = 0; q < target.quadrature.count; ++q)
        basis.values(&target.quadrature.xi[q * (dim_ - 1)], &face_values_[offset(q, basis.count)]);

    // |f| / h_f over the volume of the reference face: what a reference integral is multiplied by.
    std::vector<double> face_weight(mesh.face_count());
    double one_squared = 0;
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (target.hold_of_face(mesh, f) == BoundaryHold::free) continue;
        const double measure = face_measure(mesh, ideal, f), h = dim_ == 2 ? measure : std::sqrt(measure);
        one_squared += measure / h;
        face_weight[f] = measure / h * (dim_ == 2 ? 1 : 2);
    }
    norm_of_one_ = std::sqrt(one_squared);
    number_trace_nodes();
    measure_heights(ideal);
    assemble_mass(face_weight);
    if (kind == TargetKind::nodal || target.in_trace_space) interpolate_target();
    else project_target(ideal, face_weight);
    if (kind == TargetKind::exact) measure_best_approximation(face_weight);
    if (!target.prescribes_all()) find_parts();
}

void Dirichlet::number_trace_nodes() {
    std::vector<int> trace(mesh_.nodes(), -1);
    for (int node : mesh_.faces) trace[node] = 0;
    for (int node = 0; node < mesh_.nodes(); ++node) {
        if (trace[node] < 0) continue;
        trace[node] = static_cast<int>(nodes_.size());
        nodes_.push_back(node);
    }
    faces_.resize(mesh_.faces.size());
    std::transform(mesh_.faces.begin(), mesh_.faces.end(), faces_.begin(), [&](int node) { return trace[node]; });
    v_.resize(nodes_.size() * dim_);
    g_h_.resize(nodes_.size() * dim_);
}

void Dirichlet::measure_heights(const std::vector<double>& ideal) {
    const int m = mesh_.face_nodes();
    height_.assign(nodes_.size(), std::numeric_limits<double>::infinity());
    with_dimension(dim_, [&](auto n) {
        for (int f = 0; f < mesh_.face_count(); ++f) {
            const double volume = determinant(straight_jacobian<n>(mesh_.element(mesh_.face_element[f]), ideal));
            const double height = volume / ((dim_ - 1) * face_measure(mesh_, ideal, f));
            for (int i = 0; i < m; ++i) {
                double& least = height_[faces_[offset(f, m, i)]];
                least = std::min(least, height);
            }
        }
    });
}

void Dirichlet::assemble_mass(const std::vector<double>& face_weight) {
    const int m = mesh_.face_nodes();
    std::vector<double> reference(m * m, 0.0);  // integrals of N_i N_j over the reference face
    for (int q = 0; q < target_.quadrature.count; ++q)
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j)
                reference[i * m + j] +=
                    target_.quadrature.weight[q] * face_values_[offset(q, m, i)] * face_values_[offset(q, m, j)];
    LargeVector<int> place;
    M_ = pattern_of_cells(static_cast<int>(nodes_.size()), 1, faces_, m, &place);
    M_.value.assign(M_.col.size(), 0.0);
    for (int f = 0; f < mesh_.face_count(); ++f)
        for (int ij = 0; ij < m * m; ++ij) M_.value[place[offset(f, m * m, ij)]] += face_weight[f] * reference[ij];
}

// Solves M (g_h - y) = (N, g_D - y): relative to the ideal positions y, a boundary that stays has no rounding error.
void Dirichlet::project_target(const std::vector<double>& ideal, const std::vector<double>& face_weight) {
    const int m = mesh_.face_nodes(), points = target_.quadrature.count;
    Cholesky factorisation(M_);
    if (factorisation.factor(M_).status != SolveStatus::success)
        throw InputError(
            "the mass matrix of the boundary cannot be factored: a boundary face is degenerate or memory is short");
    const auto ideal_at = [&](int t, int a) { return ideal[offset(nodes_[t], dim_, a)]; };
    std::vector<double> right(nodes_.size()), displacement(nodes_.size());
    for (int a = 0; a < dim_; ++a) {
        std::fill(right.begin(), right.end(), 0.0);
        for (int f = 0; f < mesh_.face_count(); ++f) {
            const int* trace = &faces_[offset(f, m)];
            for (int q = 0; q < points; ++q) {
                const double* N = &face_values_[offset(q, m)];
                double d = target_.sample[offset(offset(f, points, q), dim_, a)];
                for (int i = 0; i < m; ++i) d -= N[i] * ideal_at(trace[i], a);
                for (int i = 0; i < m; ++i) right[trace[i]] += face_weight[f] * target_.quadrature.weight[q] * N[i] * d;
            }
        }
        factorisation.solve(right.data(), displacement.data());
        for (std::size_t t = 0; t < nodes_.size(); ++t)
            g_h_[t * dim_ + a] = ideal_at(static_cast<int>(t), a) + displacement[t];
    }
}

void Dirichlet::interpolate_target() {
    for (std::size_t k = faces_.size(); k-- > 0;)  // the first face that holds a node decides, as in target_check
        for (int a = 0; a < dim_; ++a) g_h_[offset(faces_[k], dim_, a)] = target_.node[k * dim_ + a];
}

// e_h^2 = sum over faces of the weighted integral of |g_h - g_D|^2.
void Dirichlet::measure_best_approximation(const std::vector<double>& face_weight) {
    const double squared = deterministic_sum(mesh_.face_count(), [&](int f) {
        double sum = 0;
        for (int q = 0; q < target_.quadrature.count; ++q)
            sum += target_.quadrature.weight[q] * squared_difference_at(g_h_, faces_, f, q);
        return face_weight[f] * sum;
    });
    best_approximation_error_ = std::sqrt(squared) / norm_of_one_;
}

double Dirichlet::difference(const std::vector<double>& x, int trace_node, int component) const {
    const auto from_target = [&](int a) {
        return x[offset(nodes_[trace_node], dim_, a)] - g_h_[offset(trace_node, dim_, a)];
    };
    if (P_.empty()) return from_target(component);
    double sum = 0;
    for (int b = 0; b < dim_; ++b) sum += P_[offset(trace_node, dim_ * dim_, component * dim_ + b)] * from_target(b);
    return sum;
}

// v <- P_t v
void Dirichlet::project(int trace_node, double* v) const {
    if (P_.empty()) return;
    double projected[3] = {};
    for (int a = 0; a < dim_; ++a)
        for (int b = 0; b < dim_; ++b) projected[a] += P_[offset(trace_node, dim_ * dim_, a * dim_ + b)] * v[b];
    std::copy_n(projected, dim_, v);
}

void Dirichlet::find_parts() {
    const int t_count = static_cast<int>(nodes_.size());
    parts_ = sliding_parts(mesh_, target_, sliding_.get(), nodes_, faces_, g_h_, P_);
    for (const std::vector<int>& parts : parts_)
        for (const int part : parts) is_curved_ = is_curved_ || !sliding_->surface(part).is_flat();
    B_.assign(P_.size(), 0.0);
    for (int t = 0; t < t_count; ++t) hold_to_planes(t, in_space(&g_h_[offset(t, dim_)], dim_), {});
}

// force: (M lambda)_t / |1|.
void Dirichlet::hold_to_planes(int t, const Vec<3>& x, const Vec<3>& force) {
    if (parts_[t].empty()) return;
    const TangentPlanes planes = tangent_planes(*sliding_, parts_[t], x, force);
    std::copy_n(planes.place.begin(), dim_, &g_h_[offset(t, dim_)]);
    for (int a = 0; a < dim_; ++a) {
        std::copy_n(planes.P[a].begin(), dim_, &P_[offset(t, dim_ * dim_, a * dim_)]);
        std::copy_n(planes.B[a].begin(), dim_, &B_[offset(t, dim_ * dim_, a * dim_)]);
    }
}

bool Dirichlet::expand(const std::vector<double>& x, const std::vector<double>& lambda) {
    if (!is_curved_) return false;
    residual_.resize(v_.size());
    for (int t = 0; t < M_.n; ++t)
        for (int a = 0; a < dim_; ++a) residual_[offset(t, dim_, a)] = difference(x, t, a);
    set_v([&](int t, int a) { return lambda[offset(t, dim_, a)] / norm_of_one_; });
    with_dimension(dim_, [&](auto n) {
        parallel_for(
            M_.n,
            [&](int t) {
                Vec<3> force{};
                mass_times_v<n>(t, force.data());
                hold_to_planes(t, in_space(point(x, nodes_[t], dim_), dim_), force);
            },
            surface_work);
    });
    return true;
}

std::vector<double> Dirichlet::targets(const std::vector<double>& x) const {
    std::vector<double> targets = g_h_;
    if (P_.empty()) return targets;
    parallel_for(
        static_cast<int>(nodes_.size()),
        [&](int t) {
            const Vec<3> at = in_space(point(x, nodes_[t], dim_), dim_);
            if (!parts_[t].empty())
                std::copy_n(on_surfaces(*sliding_, parts_[t], at).begin(), dim_, &targets[offset(t, dim_)]);
            else if (P_[offset(t, dim_ * dim_)] == 0) std::copy_n(at.begin(), dim_, &targets[offset(t, dim_)]);
        },
        surface_work);
    return targets;
}

std::vector<char> Dirichlet::off_target(const std::vector<double>& x) const {
    constexpr double rounding = 1e-13;
    const std::vector<double> target = targets(x);
    std::vector<char> off(nodes_.size());
    for (std::size_t t = 0; t < nodes_.size(); ++t) {
        const bool slides = !P_.empty() && !parts_[t].empty();
        for (int a = 0; a < dim_; ++a) {
            const double is = x[offset(nodes_[t], dim_, a)], should = target[offset(t, dim_, a)];
            const double tolerance = slides ? rounding * std::max(1.0, std::abs(should)) : 0;
            off[t] = off[t] || !(std::abs(is - should) <= tolerance);
        }
    }
    return off;
}

// |u - g_D|^2 at a quadrature point of a face, u having the value trace[nodes[face node] x dim] at each face node.
double Dirichlet::squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes,
                                                 int face, int point) const {
    const int m = mesh_.face_nodes(), points = target_.quadrature.count;
    double squared = 0;
    for (int a = 0; a < dim_; ++a) {
        double d = -target_.sample[offset(offset(face, points, point), dim_, a)];
        for (int i = 0; i < m; ++i)
            d += face_values_[offset(point, m, i)] * trace[offset(nodes[offset(face, m, i)], dim_, a)];
        squared += d * d;
    }
    return squared;
}

// v <- entry(trace node, component)
template <class Entry>
void Dirichlet::set_v(const Entry& entry) {
    parallel_for(M_.n, [&](int t) {
        for (int a = 0; a < dim_; ++a) v_[offset(t, dim_, a)] = entry(t, a);
    });
}

// The n entries of M v at a trace node.
template <int n>
void Dirichlet::mass_times_v(int trace_node, double* Mv) const {
    std::fill_n(Mv, n, 0.0);
    for (int k = M_.row[trace_node]; k < M_.row[trace_node + 1]; ++k)
        for (int a = 0; a < n; ++a) Mv[a] += M_.value[k] * v_[offset(M_.col[k], n, a)];
}

// w^T M v, w_k = weight(k), k = trace node * dim + component.
template <class Weight>
double Dirichlet::dot_mass_times_v(const Weight& weight) const {
    double sum = 0;
    with_dimension(dim_, [&](auto n) {
        sum = deterministic_sum(M_.n, [&](int t) {
            double Mv[n], product = 0;
            mass_times_v<n>(t, Mv);
            for (int a = 0; a < n; ++a) product += weight(t * n + a) * Mv[a];
            return product;
        }, mass_work);
    });
    return sum;
}

double Dirichlet::projected_norm(const std::vector<double>& x) {
    set_v([&](int t, int a) { return difference(x, t, a); });
    const double squared = dot_mass_times_v([this](int k) { return v_[k]; });
    return std::sqrt(squared < 0 ? 0 : squared) / norm_of_one_;  // rounding may be negative; nan stays nan
}

double Dirichlet::norm(const std::vector<double>& x) {
    return std::hypot(projected_norm(x), best_approximation_error_);
}

double Dirichlet::max_error(const std::vector<double>& x) {
    double squared = 0;
    if (!P_.empty()) {
        const std::vector<double> target = targets(x);
        for (std::size_t t = 0; t < nodes_.size(); ++t) {
            double s = 0;
            for (int a = 0; a < dim_; ++a) s += std::pow(x[offset(nodes_[t], dim_, a)] - target[offset(t, dim_, a)], 2);
            squared = std::max(squared, s);
        }
        return std::sqrt(squared);
    }
    for (std::size_t k = 0; k < mesh_.faces.size(); ++k) {
        double s = 0;
        for (int a = 0; a < dim_; ++a)
            s += std::pow(x[offset(mesh_.faces[k], dim_, a)] - target_.node[k * dim_ + a], 2);
        squared = std::max(squared, s);
    }
    if (kind_ == TargetKind::exact)
        for (int f = 0; f < mesh_.face_count(); ++f)
            for (int q = 0; q < target_.quadrature.count; ++q)
                squared = std::max(squared, squared_difference_at(x, mesh_.faces, f, q));
    return std::sqrt(squared);
}

double Dirichlet::relative_error(const std::vector<double>& x) const {
    double largest = 0;
    for (const double error : relative_errors(x)) largest = std::max(largest, error);
    return largest;
}

std::vector<double> Dirichlet::relative_errors(const std::vector<double>& x) const {
    std::vector<double> errors(nodes_.size());
    for (std::size_t t = 0; t < nodes_.size(); ++t) {
        double squared = 0;
        for (int a = 0; a < dim_; ++a) squared += std::pow(difference(x, static_cast<int>(t), a), 2);
        errors[t] = std::sqrt(squared) / height_[t];
    }
    return errors;
}

// B_t (x_t - p_t)
Vec<3> Dirichlet::turned_force(const std::vector<double>& x, int t) const {
    Vec<3> sum{};
    for (int a = 0; a < dim_; ++a)
        for (int b = 0; b < dim_; ++b)
            sum[a] +=
                B_[offset(t, dim_ * dim_, a * dim_ + b)] * (x[offset(nodes_[t], dim_, b)] - g_h_[offset(t, dim_, b)]);
    return sum;
}

double Dirichlet::of_curvature(const std::vector<double>& x) const {
    if (!is_curved_) return 0;
    return deterministic_sum(
        M_.n,
        [&](int t) {
            const Vec<3> force = turned_force(x, t);
            double sum = 0;
            for (int a = 0; a < dim_; ++a)
                sum += 0.5 * force[a] * (x[offset(nodes_[t], dim_, a)] - g_h_[offset(t, dim_, a)]);
            return sum;
        },
        mass_work);
}

double Dirichlet::value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) {
    set_v([&](int t, int a) { return difference(x, t, a); });
    const double half = 0.5 * mu / norm_of_one_;
    const double of_projection = dot_mass_times_v([&](int k) { return half * v_[k] - lambda[k]; }) / norm_of_one_;
    return of_projection + 0.5 * mu * best_approximation_error_ * best_approximation_error_ + of_curvature(x);
}

void Dirichlet::add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                             std::vector<double>& g) {
    set_v([&](int t, int a) {
        const double scaled = mu * difference(x, t, a) / norm_of_one_;
        return (scaled - lambda[offset(t, dim_, a)]) / norm_of_one_;
    });
    with_dimension(dim_, [&](auto n) {
        parallel_for(M_.n, [&](int t) {
            double Mv[n];
            mass_times_v<n>(t, Mv);
            project(t, Mv);
            const Vec<3> turned = is_curved_ ? turned_force(x, t) : Vec<3>{};
            for (int a = 0; a < n; ++a) g[offset(nodes_[t], n, a)] += Mv[a] + turned[a];
        }, mass_work);
    });
}

namespace {

// C += factor A B
void add_product(double factor, const double* A, const double* B, int n, double* C) {
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b)
            for (int c = 0; c < n; ++c) C[a * n + b] += factor * A[a * n + c] * B[c * n + b];
}

}  // namespace

// Adds mu / |1|^2 P M P + B, B without its negative part if `projected`; row(mesh node): its block row in H, or -1
// where H leaves it out.
template <class Row>
void Dirichlet::add_matrix(double mu, bool projected, const Row& row, BlockCsr& H) const {
    const double factor = mu / (norm_of_one_ * norm_of_one_);
    parallel_for(M_.n, [&](int t) {
        const int i = row(nodes_[t]);
        for (int k = M_.row[t]; k < M_.row[t + 1] && i >= 0; ++k) {
            const int j = row(nodes_[M_.col[k]]), place = j < 0 ? -1 : H.find(i, j);
            if (place < 0) continue;
            double* const block = H.block(place);
            const double entry = factor * M_.value[k];
            if (P_.empty())
                for (int a = 0; a < dim_; ++a) block[a * dim_ + a] += entry;
            else add_product(entry, &P_[offset(t, dim_ * dim_)], &P_[offset(M_.col[k], dim_ * dim_)], dim_, block);
            if (P_.empty() || M_.col[k] != t) continue;
            const double* const B = &B_[offset(t, dim_ * dim_)];
            double trace = 0;  // B is semidefinite but on a saddle
            for (int a = 0; a < dim_; ++a) trace += B[a * dim_ + a];
            for (int e = 0; e < dim_ * dim_ && (!projected || trace > 0); ++e) block[e] += B[e];
        }
    }, 200);
}

void Dirichlet::add_hessian(const std::vector<double>&, const std::vector<double>&, double mu, bool projected,
                            BlockCsr& H) {
    add_matrix(
        mu, projected, [&H](int node) { return H.row_of(node); }, H);
}

void Dirichlet::update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) {
    for (int t = 0; t < M_.n; ++t)
        for (int a = 0; a < dim_; ++a) {
            const double r = is_curved_ ? residual_[offset(t, dim_, a)] : difference(x, t, a);
            lambda[offset(t, dim_, a)] -= mu * r / norm_of_one_;
        }
}

std::vector<double> Dirichlet::constraint_field(const std::vector<double>& x) const {
    std::vector<double> c(g_h_.size());
    for (int t = 0; t < M_.n; ++t)
        for (int a = 0; a < dim_; ++a) c[offset(t, dim_, a)] = difference(x, t, a) / norm_of_one_;
    return c;
}

std::unique_ptr<ConstraintPart> Dirichlet::part(const std::vector<double>& x, const std::vector<double>& lambda,
                                                double mu, const std::vector<int>& node, const BlockCsr& pattern) {
    std::vector<double> gradient(x.size(), 0.0);
    add_gradient(x, lambda, mu, gradient);
    std::vector<int> row(mesh_.nodes(), -1);
    auto part = std::make_unique<QuadraticPart>();
    for (std::size_t k = 0; k < node.size(); ++k) {
        const int i = node[k];
        row[i] = static_cast<int>(k);
        part->x.insert(part->x.end(), point(x, i, dim_), point(x, i, dim_) + dim_);
        part->g.insert(part->g.end(), point(gradient, i, dim_), point(gradient, i, dim_) + dim_);
    }
    part->C = pattern;
    add_matrix(
        mu, false, [&row](int i) { return row[i]; }, part->C);
    return part;
}

}  // namespace almesh
