#include "geometry/smooth_parts.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include "base/disjoint_sets.hpp"
#include "geometry/patch.hpp"
#include "mesh/sides.hpp"

namespace almesh {

Vec<3> unit_normal(const Mesh& mesh, int f) {
    const int vertices = mesh.face_cell(f).vertices;
    return unit(flat_normal(positions(mesh, mesh.x, mesh.face(f), vertices), mesh.dim - 1, vertices));
}

std::vector<int> smooth_parts(const Mesh& mesh, double feature_angle) {
    std::vector<Vec<3>> normal(mesh.face_count());
    std::vector<Side> sides;
    for (int f = 0; f < mesh.face_count(); ++f) {
        normal[f] = unit_normal(mesh, f);
        if (!mesh.is_inner(f)) append_sides_of_face(mesh, f, f, sides);
    }
    DisjointSets connected(mesh.face_count());
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        for (const Side& other : equal.subspan(1)) {
            const Vec<3>&a = normal[equal[0].number], &b = normal[other.number];
            const double angle = std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
            if (angle <= feature_angle) connected.join(equal[0].number, other.number);
        }
    });
    std::map<int, int> number;
    std::vector<int> part(mesh.face_count(), 0);
    for (int f = 0; f < mesh.face_count(); ++f)
        if (!mesh.is_inner(f))
            part[f] = number.try_emplace(connected.find(f), static_cast<int>(number.size()) + 1).first->second;
    return part;
}

}  // namespace almesh
