#include "check/surface_distance.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/patch.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

constexpr double face_work = 1e4;  // simple operations for one face

// point x face node: the basis functions at the points of a grid.
std::vector<double> grid_values(const LagrangeBasis& basis) {
    const LagrangeBasis grid(basis.cell, 2 * basis.degree);
    std::vector<double> values(offset(grid.count, basis.count));
    for (int q = 0; q < grid.count; ++q) basis.values(grid.point(q).data(), &values[offset(q, basis.count)]);
    return values;
}

}  // namespace

double distance_from_surfaces(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces& sliding,
                              const std::vector<double>& x) {
    std::vector<std::vector<double>> values_of;  // by group of faces
    for (const LagrangeBasis& basis : face_bases_of(mesh)) values_of.push_back(grid_values(basis));
    std::vector<double> distance(mesh.face_count(), 0.0);
    parallel_for(mesh.face_count(), [&](int f) {
        if (!target.slides(mesh, f)) return;
        const int m = mesh.face_nodes(f);
        const std::vector<double>& values = values_of[mesh.face_group_number(f)];
        const std::vector<int> part = {sliding.part(mesh, f)};
        const std::vector<Vec<3>> nodes = positions(mesh, x, mesh.face(f), m);
        for (std::size_t q = 0; q < values.size(); q += m) {
            Vec<3> at{};
            for (int i = 0; i < m; ++i) at = at + values[q + i] * nodes[i];
            distance[f] = std::max(distance[f], length(at - on_surfaces(sliding, part, at)));
        }
    }, face_work);
    return distance.empty() ? 0 : *std::max_element(distance.begin(), distance.end());
}

double largest_slide(const Mesh& mesh, const BoundaryTarget& target, const std::vector<double>& x) {
    const std::vector<double> at = at_target(mesh, target, x);
    double largest = 0;
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (!target.is_freed(i)) continue;
        const Vec<3> move = in_space(point(x, i, mesh.dim), mesh.dim) - in_space(point(at, i, mesh.dim), mesh.dim);
        largest = std::max(largest, length(move));
    }
    return largest;
}

}  // namespace almesh
