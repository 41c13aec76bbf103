#include "constraint/sliding_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"
#include "constraint/sliding.hpp"
#include "constraint/sliding_nodes.hpp"
#include "constraint/trace_space.hpp"

namespace almesh {
namespace {

constexpr double mass_work = 40;     // simple operations that a row of M takes,
constexpr double matrix_work = 200;  // to be added to a matrix as well,
constexpr double surface_work = 1e3; // and finding a point of a surface, at least

// C += factor A' B, d x d each.
void add_congruence(double factor, const double* A, const double* B, int d, double* C) {
    for (int c = 0; c < d; ++c)
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) C[a * d + b] += factor * A[c * d + a] * B[c * d + b];
}

void add_block(const Mat<3>& A, int d, double* block) {
    for (int a = 0; a < d; ++a)
        for (int b = 0; b < d; ++b) block[a * d + b] += A[a][b];
}

// g += D' f, d x d and d.
void add_force(const double* D, const double* f, int d, double* g) {
    for (int a = 0; a < d; ++a)
        for (int b = 0; b < d; ++b) g[a] += D[b * d + a] * f[b];
}

void copy_slope(const Mat<3>& slope, int d, double* D) {
    for (int a = 0; a < d; ++a) std::copy_n(slope[a].begin(), d, D + a * d);
}

}  // namespace

SlidingBoundary::SlidingBoundary(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                                 std::shared_ptr<const SlidingSurfaces> sliding)
    : Dirichlet(mesh, ideal, target), sliding_(std::move(sliding)),
      parts_(sliding_parts(mesh, target, sliding_.get(), trace_.nodes, trace_.faces, g_h_, prescribed_)) {}

SlidingBoundary::SlidingBoundary(const SlidingBoundary& whole, const Restriction& around)
    : Dirichlet(whole, around), sliding_(whole.sliding_), prescribed_(trace_.restricted(whole.prescribed_)),
      parts_(trace_.restricted(whole.parts_)) {}

std::unique_ptr<Constraint> SlidingBoundary::part(const Restriction& around, std::vector<double>& lambda) const {
    std::unique_ptr<SlidingBoundary> part(new SlidingBoundary(*this, around));
    lambda = part->trace_.restricted(lambda);
    return part;
}

Vec<3> SlidingBoundary::at(const std::vector<double>& x, int t) const {
    return in_space(point(x, trace_.nodes[t], trace_.dim), trace_.dim);
}

SurfaceDistance SlidingBoundary::distance(int t, const Vec<3>& x) const {
    if (!parts_[t].empty()) return distance_to(*sliding_, parts_[t], x);
    return prescribed_[t] ? Dirichlet::distance(t, x) : SurfaceDistance{};
}

Mat<3> SlidingBoundary::second_derivative_at(int t, const Vec<3>& x, const Vec<3>& force) const {
    if (parts_[t].empty()) return {};
    return second_derivative(*sliding_, parts_[t], x, force);
}

// r; slope: D, trace nodes x dim x dim, unless null.
std::vector<double> SlidingBoundary::residual(const std::vector<double>& x, std::vector<double>* slope) const {
    const int dim = trace_.dim;
    std::vector<double> r(trace_.size());
    if (slope) slope->resize(r.size() * dim);
    parallel_for(trace_.count(), [&](int t) {
        const SurfaceDistance here = distance(t, at(x, t));
        std::copy_n(here.r.begin(), dim, &r[offset(t, dim)]);
        if (slope) copy_slope(here.slope, dim, &(*slope)[offset(t, dim * dim)]);
    }, surface_work);
    return r;
}

void SlidingBoundary::add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                                   std::vector<double>& g) {
    std::vector<double> D;
    const std::vector<double> v = trace_.force_density(residual(x, &D), lambda, mu);
    with_dimension(trace_.dim, [&](auto n) {
        parallel_for(trace_.count(), [&](int t) {
            double f[n];
            trace_.mass_times<n>(v, t, f);
            add_force(&D[offset(t, n * n)], f, n, point(g, trace_.nodes[t], n));
        }, mass_work);
    });
}

void SlidingBoundary::add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                                  bool projected, BlockCsr& H) {
    const int dim = trace_.dim;
    const BlockCsr& M = trace_.M;
    std::vector<double> D;
    const std::vector<double> r = residual(x, &D);
    const double factor = mu / (trace_.norm_of_one * trace_.norm_of_one);
    parallel_for(trace_.count(), [&](int t) {
        const int i = H.row_of(trace_.nodes[t]);
        for (int k = M.row[t]; k < M.row[t + 1]; ++k)
            add_congruence(factor * M.value[k], &D[offset(t, dim * dim)], &D[offset(M.col[k], dim * dim)], dim,
                           H.block(H.find(i, H.row_of(trace_.nodes[M.col[k]]))));
    }, matrix_work);
    if (projected) return;
    const std::vector<double> v = trace_.force_density(r, lambda, mu);
    with_dimension(dim, [&](auto n) {
        parallel_for(trace_.count(), [&](int t) {
            if (parts_[t].empty()) return;
            Vec<3> force{};
            trace_.mass_times<n>(v, t, force.data());
            const int i = H.row_of(trace_.nodes[t]);
            add_block(second_derivative_at(t, at(x, t), force), n, H.block(H.find(i, i)));
        }, surface_work);
    });
}

void SlidingBoundary::correct(const std::vector<double>& x, const std::vector<double>& d, double t,
                              std::vector<double>& y) const {
    parallel_for(trace_.count(), [&](int i) {
        if (parts_[i].empty()) return;
        const Vec<3> corrected =
            at_distances(*sliding_, parts_[i], at(y, i), distances(*sliding_, parts_[i], at(x, i), t * at(d, i)));
        std::copy_n(corrected.begin(), trace_.dim, point(y, trace_.nodes[i], trace_.dim));
    }, surface_work);
}

std::vector<double> SlidingBoundary::targets(const std::vector<double>& x) const {
    std::vector<double> targets = g_h_;
    parallel_for(trace_.count(), [&](int t) {
        if (prescribed_[t]) return;
        const Vec<3> target = parts_[t].empty() ? at(x, t) : on_surfaces(*sliding_, parts_[t], at(x, t));
        std::copy_n(target.begin(), trace_.dim, &targets[offset(t, trace_.dim)]);
    }, surface_work);
    return targets;
}

std::vector<char> SlidingBoundary::off_target(const std::vector<double>& x) const {
    constexpr double rounding = 1e-13;
    const std::vector<double> target = targets(x);
    std::vector<char> off(trace_.nodes.size(), 0);
    for (int t = 0; t < trace_.count(); ++t)
        for (int a = 0; a < trace_.dim; ++a) {
            const double is = x[offset(trace_.nodes[t], trace_.dim, a)], should = target[offset(t, trace_.dim, a)];
            const double tolerance = parts_[t].empty() ? 0 : rounding * std::max(1.0, std::abs(should));
            off[t] = off[t] || !(std::abs(is - should) <= tolerance);
        }
    return off;
}

double SlidingBoundary::max_error(const std::vector<double>& x) {
    double largest = 0;
    for (const double distance : trace_.distances(x, targets(x))) largest = std::max(largest, distance);
    return largest;
}

std::unique_ptr<Constraint> make_constraint(const Mesh& mesh, const std::vector<double>& ideal,
                                            const BoundaryTarget& target, TargetKind kind,
                                            std::shared_ptr<const SlidingSurfaces> sliding) {
    if (target.prescribes_all()) return std::make_unique<Dirichlet>(mesh, ideal, target, kind);
    return std::make_unique<SlidingBoundary>(mesh, ideal, target, std::move(sliding));
}

}  // namespace almesh
