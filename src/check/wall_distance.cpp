#include "check/wall_distance.hpp"

#include <utility>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "geometry/closest_point.hpp"
#include "geometry/face_patches.hpp"

namespace almesh {
namespace {

constexpr double node_work = 1e3;  // simple operations to find the distance of one node, at least

}  // namespace

std::vector<double> wall_distance(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& is_wall) {
    const FacePatches faces(mesh);
    std::vector<Patch> patches;
    std::vector<char> on_wall(mesh.nodes(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (!is_wall[mesh.face_boundary[f]]) continue;
        for (Patch& patch : faces.of(f, x)) patches.push_back(std::move(patch));
        for (int i = 0; i < mesh.face_nodes(f); ++i) on_wall[mesh.face(f)[i]] = 1;
    }
    if (patches.empty())
        throw InputError("wall distance: the boundary has no faces; name another one");
    const ClosestPoint wall(faces.basis, patches);
    std::vector<double> distance(mesh.nodes(), 0.0);
    parallel_for(mesh.nodes(), [&](int i) {
        if (!on_wall[i]) distance[i] = wall.find(positions(mesh, x, &i, 1)[0]).distance;
    }, node_work);
    return distance;
}

}  // namespace almesh
