// The quadratic form of dirichlet.hpp in r, and its derivatives with respect to x.
#include "constraint/dirichlet.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "constraint/dirichlet_part.hpp"

namespace almesh {
namespace {

constexpr double mass_work = 40;     // simple operations that a row of M takes,
constexpr double surface_work = 1e3; // and finding a point of a surface, at least

}  // namespace

Dirichlet::Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target, TargetKind kind,
                     std::shared_ptr<const SlidingSurfaces> sliding)
    : dim_(mesh.dim), kind_(kind), mesh_(mesh), target_(target), trace_(mesh, ideal, target),
      sliding_(std::move(sliding)) {
    const bool interpolated = kind == TargetKind::nodal || target.in_trace_space;
    g_h_ = interpolated ? trace_.interpolation(mesh, target) : trace_.projection(mesh, ideal, target);
    r_.resize(g_h_.size());
    v_.resize(g_h_.size());
    if (kind == TargetKind::exact) measure_best_approximation();
    if (target.prescribes_all()) return;
    parts_ = sliding_parts(mesh, target, sliding_.get(), trace_.nodes, trace_.faces, g_h_, held_);
    slope_.resize(g_h_.size() * dim_);
}

// e_h^2 = sum over faces of the weighted integral of |g_h - g_D|^2.
void Dirichlet::measure_best_approximation() {
    const double squared = deterministic_sum(mesh_.face_count(), [&](int f) {
        double sum = 0;
        for (int q = 0; q < target_.quadrature.count; ++q)
            sum += target_.quadrature.weight[q] * squared_difference_at(g_h_, trace_.faces, f, q);
        return trace_.face_weight[f] * sum;
    });
    best_approximation_error_ = std::sqrt(squared) / trace_.norm_of_one;
}

SurfaceDistance Dirichlet::distance(int t, const Vec<3>& x) const {
    if (!prescribes_all() && !parts_[t].empty()) return distance_to(*sliding_, parts_[t], x);
    SurfaceDistance from_place;
    if (!prescribes_all() && !held_[t]) return from_place;
    for (int a = 0; a < dim_; ++a) {
        from_place.r[a] = x[a] - g_h_[offset(t, dim_, a)];
        from_place.slope[a][a] = 1;
    }
    return from_place;
}

Mat<3> Dirichlet::second_derivative_at(int t, const Vec<3>& x, const Vec<3>& force) const {
    if (prescribes_all() || parts_[t].empty()) return {};
    return second_derivative(*sliding_, parts_[t], x, force);
}

// r_ <- r(x)
void Dirichlet::measure(const std::vector<double>& x) {
    if (prescribes_all()) {
        parallel_for(count(), [&](int t) {
            for (int a = 0; a < dim_; ++a)
                r_[offset(t, dim_, a)] = x[offset(trace_.nodes[t], dim_, a)] - g_h_[offset(t, dim_, a)];
        });
        return;
    }
    parallel_for(
        count(),
        [&](int t) {
            const Vec<3> r = distance(t, in_space(point(x, trace_.nodes[t], dim_), dim_)).r;
            std::copy_n(r.begin(), dim_, &r_[offset(t, dim_)]);
        },
        surface_work);
}

// r_ <- r(x), slope_ <- D(x)
void Dirichlet::measure_slopes(const std::vector<double>& x) {
    if (prescribes_all()) return measure(x);
    parallel_for(
        count(),
        [&](int t) {
            const SurfaceDistance at = distance(t, in_space(point(x, trace_.nodes[t], dim_), dim_));
            std::copy_n(at.r.begin(), dim_, &r_[offset(t, dim_)]);
            for (int a = 0; a < dim_; ++a)
                std::copy_n(at.slope[a].begin(), dim_, &slope_[offset(t, dim_ * dim_, a * dim_)]);
        },
        surface_work);
}

void Dirichlet::bend(const std::vector<double>& x, const std::vector<double>& d, double t,
                     std::vector<double>& y) const {
    parallel_for(
        count(),
        [&](int i) {
            if (parts_[i].empty()) return;
            const auto of = [&](const std::vector<double>& v) {
                return in_space(point(v, trace_.nodes[i], dim_), dim_);
            };
            const Vec<3> bent =
                at_distances(*sliding_, parts_[i], of(y), distances(*sliding_, parts_[i], of(x), t * of(d)));
            std::copy_n(bent.begin(), dim_, point(y, trace_.nodes[i], dim_));
        },
        surface_work);
}

std::vector<double> Dirichlet::targets(const std::vector<double>& x) const {
    std::vector<double> targets = g_h_;
    if (prescribes_all()) return targets;
    parallel_for(
        count(),
        [&](int t) {
            const Vec<3> at = in_space(point(x, trace_.nodes[t], dim_), dim_);
            if (!parts_[t].empty())
                std::copy_n(on_surfaces(*sliding_, parts_[t], at).begin(), dim_, &targets[offset(t, dim_)]);
            else if (!held_[t]) std::copy_n(at.begin(), dim_, &targets[offset(t, dim_)]);
        },
        surface_work);
    return targets;
}

std::vector<char> Dirichlet::off_target(const std::vector<double>& x) const {
    constexpr double rounding = 1e-13;
    const std::vector<double> target = targets(x);
    std::vector<char> off(count());
    for (int t = 0; t < count(); ++t) {
        const bool slides = !prescribes_all() && !parts_[t].empty();
        for (int a = 0; a < dim_; ++a) {
            const double is = x[offset(trace_.nodes[t], dim_, a)], should = target[offset(t, dim_, a)];
            const double tolerance = slides ? rounding * std::max(1.0, std::abs(should)) : 0;
            off[t] = off[t] || !(std::abs(is - should) <= tolerance);
        }
    }
    return off;
}

// |u - g_D|^2 at a quadrature point of a face, u having the value trace[nodes[face node] x dim] at each face node.
double Dirichlet::squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes, int face,
                                        int point) const {
    const int m = mesh_.face_nodes(), points = target_.quadrature.count;
    double squared = 0;
    for (int a = 0; a < dim_; ++a) {
        double d = -target_.sample[offset(offset(face, points, point), dim_, a)];
        for (int i = 0; i < m; ++i)
            d += trace_.face_values[offset(point, m, i)] * trace[offset(nodes[offset(face, m, i)], dim_, a)];
        squared += d * d;
    }
    return squared;
}

// v <- entry(place in a vector of trace nodes x dim)
template <class Entry>
void Dirichlet::set_v(const Entry& entry) {
    parallel_for(static_cast<int>(v_.size()), [&](int k) { v_[k] = entry(k); });
}

// The n entries of M v at a trace node.
template <int n>
void Dirichlet::mass_times_v(int trace_node, double* Mv) const {
    const BlockCsr& M = trace_.M;
    std::fill_n(Mv, n, 0.0);
    for (int k = M.row[trace_node]; k < M.row[trace_node + 1]; ++k)
        for (int a = 0; a < n; ++a) Mv[a] += M.value[k] * v_[offset(M.col[k], n, a)];
}

// w^T M v, w_k = weight(k), k = trace node * dim + component.
template <class Weight>
double Dirichlet::dot_mass_times_v(const Weight& weight) const {
    double sum = 0;
    with_dimension(dim_, [&](auto n) {
        sum = deterministic_sum(count(), [&](int t) {
            double Mv[n], product = 0;
            mass_times_v<n>(t, Mv);
            for (int a = 0; a < n; ++a) product += weight(t * n + a) * Mv[a];
            return product;
        }, mass_work);
    });
    return sum;
}

double Dirichlet::projected_norm(const std::vector<double>& x) {
    measure(x);
    set_v([&](int k) { return r_[k]; });
    const double squared = dot_mass_times_v([this](int k) { return v_[k]; });
    return std::sqrt(squared < 0 ? 0 : squared) / trace_.norm_of_one;  // rounding may be negative; nan stays nan
}

double Dirichlet::norm(const std::vector<double>& x) {
    return std::hypot(projected_norm(x), best_approximation_error_);
}

double Dirichlet::max_error(const std::vector<double>& x) {
    double squared = 0;
    if (!prescribes_all()) {
        const std::vector<double> target = targets(x);
        for (int t = 0; t < count(); ++t) {
            double s = 0;
            for (int a = 0; a < dim_; ++a)
                s += std::pow(x[offset(trace_.nodes[t], dim_, a)] - target[offset(t, dim_, a)], 2);
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
    const std::vector<double> target = targets(x);
    std::vector<double> errors(count());
    for (int t = 0; t < count(); ++t) {
        double squared = 0;
        for (int a = 0; a < dim_; ++a)
            squared += std::pow(x[offset(trace_.nodes[t], dim_, a)] - target[offset(t, dim_, a)], 2);
        errors[t] = std::sqrt(squared) / trace_.height[t];
    }
    return errors;
}

double Dirichlet::value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) {
    measure(x);
    set_v([&](int k) { return r_[k]; });
    const double half = 0.5 * mu / trace_.norm_of_one;
    const double of_projection = dot_mass_times_v([&](int k) { return half * v_[k] - lambda[k]; }) / trace_.norm_of_one;
    return of_projection + 0.5 * mu * best_approximation_error_ * best_approximation_error_;
}

// v <- (mu r / |1| - lambda) / |1|: the force is M v.
void Dirichlet::set_force(const std::vector<double>& lambda, double mu) {
    set_v([&](int k) { return (mu * r_[k] / trace_.norm_of_one - lambda[k]) / trace_.norm_of_one; });
}

void Dirichlet::add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                             std::vector<double>& g) {
    measure_slopes(x);
    set_force(lambda, mu);
    with_dimension(dim_, [&](auto n) {
        parallel_for(count(), [&](int t) {
            double Mv[n];
            mass_times_v<n>(t, Mv);
            double* const at = &g[offset(trace_.nodes[t], n)];
            if (prescribes_all())
                for (int a = 0; a < n; ++a) at[a] += Mv[a];
            else
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b) at[a] += slope_[offset(t, n * n, b * n + a)] * Mv[b];
        }, mass_work);
    });
}

// Adds factor D' M D, or factor M where all places are prescribed.
void Dirichlet::add_matrix(double factor, BlockCsr& H) const {
    const BlockCsr& M = trace_.M;
    parallel_for(count(), [&](int t) {
        const int i = H.row_of(trace_.nodes[t]);
        for (int k = M.row[t]; k < M.row[t + 1]; ++k) {
            double* const block = H.block(H.find(i, H.row_of(trace_.nodes[M.col[k]])));
            const double entry = factor * M.value[k];
            if (!prescribes_all())
                add_congruence(entry, &slope_[offset(t, dim_ * dim_)], &slope_[offset(M.col[k], dim_ * dim_)], dim_,
                               block);
            else
                for (int a = 0; a < dim_; ++a) block[a * dim_ + a] += entry;
        }
    }, 200);
}

// v as set by set_force().
void Dirichlet::add_second_derivatives(const std::vector<double>& x, BlockCsr& H) const {
    with_dimension(dim_, [&](auto n) {
        parallel_for(
            count(),
            [&](int t) {
                if (parts_[t].empty()) return;
                Vec<3> force{};
                mass_times_v<n>(t, force.data());
                const int i = H.row_of(trace_.nodes[t]);
                const Mat<3> sum = second_derivative_at(t, in_space(point(x, trace_.nodes[t], n), n), force);
                double* const block = H.block(H.find(i, i));
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b) block[a * n + b] += sum[a][b];
            },
            surface_work);
    });
}

void Dirichlet::add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
                            BlockCsr& H) {
    if (!prescribes_all()) measure_slopes(x);
    add_matrix(mu / (trace_.norm_of_one * trace_.norm_of_one), H);
    if (prescribes_all() || projected) return;
    set_force(lambda, mu);
    add_second_derivatives(x, H);
}

void Dirichlet::update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) {
    measure(x);
    for (std::size_t k = 0; k < lambda.size(); ++k) lambda[k] -= mu * r_[k] / trace_.norm_of_one;
}

std::vector<double> Dirichlet::constraint_field(const std::vector<double>& x) const {
    std::vector<double> c(g_h_.size());
    for (int t = 0; t < count(); ++t) {
        const Vec<3> r = distance(t, in_space(point(x, trace_.nodes[t], dim_), dim_)).r;
        for (int a = 0; a < dim_; ++a) c[offset(t, dim_, a)] = r[a] / trace_.norm_of_one;
    }
    return c;
}

std::unique_ptr<ConstraintPart> Dirichlet::part(const std::vector<double>& x, const std::vector<double>& lambda,
                                                double mu, const std::vector<int>& node, const BlockCsr& pattern) {
    measure(x);
    set_force(lambda, mu);
    auto part = std::make_unique<DirichletPart>(prescribes_all() ? nullptr : this, dim_);
    std::vector<int> node_of(mesh_.nodes(), -1), entry_of(count(), -1);  // trace node -> entry of the part
    for (std::size_t k = 0; k < node.size(); ++k) node_of[node[k]] = static_cast<int>(k);
    for (int t = 0; t < count(); ++t) {
        const int k = node_of[trace_.nodes[t]];
        if (k < 0) continue;
        entry_of[t] = static_cast<int>(part->node.size());
        part->node.push_back(k);
        part->trace_node.push_back(t);
        const double* const at = point(x, trace_.nodes[t], dim_);
        part->x.insert(part->x.end(), at, at + dim_);
        part->r.insert(part->r.end(), &r_[offset(t, dim_)], &r_[offset(t, dim_)] + dim_);
    }
    part->g.resize(part->x.size());
    const double factor = mu / (trace_.norm_of_one * trace_.norm_of_one);
    BlockCsr& C = part->C;
    C.n = static_cast<int>(part->node.size());
    C.row.assign(1, 0);
    const BlockCsr& M = trace_.M;
    for (int i = 0; i < C.n; ++i) {
        const int t = part->trace_node[i];
        with_dimension(dim_, [&](auto n) { mass_times_v<n>(t, &part->g[offset(i, n)]); });
        for (int k = M.row[t]; k < M.row[t + 1]; ++k) {
            const int j = entry_of[M.col[k]], place = j < 0 ? -1 : pattern.find(part->node[i], part->node[j]);
            if (place < 0) continue;  // both are held, at no cell in common that has a node that moves
            C.col.push_back(j);
            C.value.push_back(factor * M.value[k]);
            part->place.push_back(place);
        }
        C.row.push_back(C.blocks());
    }
    return part;
}

}  // namespace almesh
