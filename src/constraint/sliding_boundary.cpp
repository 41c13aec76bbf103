#include "constraint/sliding_boundary.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "constraint/sliding.hpp"
#include "constraint/sliding_nodes.hpp"
#include "constraint/trace_space.hpp"

namespace almesh {
namespace {

constexpr double work = 1e3;  // simple operations that finding a point of a surface takes, at least

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

SurfaceDistance SlidingBoundary::distance(int t, const Vec<3>& x) const {
    if (!parts_[t].empty()) return distance_to(*sliding_, parts_[t], x);
    return prescribed_[t] ? Dirichlet::distance(t, x) : SurfaceDistance{};
}

Mat<3> SlidingBoundary::second_derivative_at(int t, const Vec<3>& x, const Vec<3>& force) const {
    if (parts_[t].empty()) return {};
    return second_derivative(*sliding_, parts_[t], x, force);
}

void SlidingBoundary::correct(const std::vector<double>& x, const std::vector<double>& d, double t,
                              std::vector<double>& y) const {
    parallel_for(trace_.count(), [&](int i) {
        if (parts_[i].empty()) return;
        const std::array<double, 3> wanted = distances(*sliding_, parts_[i], at(x, i), t * at(d, i));
        set_node(y, trace_.nodes[i], trace_.dim, at_distances(*sliding_, parts_[i], at(y, i), wanted));
    }, work);
}

std::vector<double> SlidingBoundary::targets(const std::vector<double>& x) const {
    std::vector<double> targets = g_h_;
    parallel_for(trace_.count(), [&](int t) {
        if (prescribed_[t]) return;
        set_node(targets, t, trace_.dim, slides(t) ? on_surfaces(*sliding_, parts_[t], at(x, t)) : at(x, t));
    }, work);
    return targets;
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
