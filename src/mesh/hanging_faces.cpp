#include "mesh/build_boundary.hpp"

#include <algorithm>

#include "mesh/sides.hpp"

namespace almesh {

void refuse_hanging_faces(const MeshBuild& build) {
    const Mesh& mesh = build.mesh;
    if (mesh.face_groups().size() < 2) return;
    std::vector<Side> triples;  // the triangles, and those of the vertices of each quadrilateral
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::span<const int> vertex = mesh.face_vertices(f);
        for (std::size_t left_out = 0; vertex.size() == 4 && left_out < 4; ++left_out) {
            std::array<int, 3> triple{};
            std::copy_if(vertex.begin(), vertex.end(), triple.begin(), [&](int v) { return v != vertex[left_out]; });
            triples.emplace_back(triple, f);
        }
        if (vertex.size() == 3) triples.emplace_back(vertex, f);
    }
    for_equal_sides(triples, [&](std::span<const Side> equal) {
        const auto is_triangle = [&](const Side& side) { return mesh.face_cell(side.number).is_simplex(); };
        const auto triangle = std::find_if(equal.begin(), equal.end(), is_triangle);
        const auto other = std::find_if_not(equal.begin(), equal.end(), is_triangle);
        if (triangle == equal.end() || other == equal.end()) return;
        const auto nodes_of = [&](int f) { return build.node_ids(mesh.face(f), mesh.face_cell(f).vertices); };
        const int e = mesh.face_element[triangle->number], q = mesh.face_element[other->number];
        build.refuse(build.element(e), "has the face with the nodes ", nodes_of(triangle->number),
                     ", half of the face ", nodes_of(other->number), " of ", name_of(build.element(q)),
                     ": faces must match; put a pyramid on that one (gmsh does where tetrahedra meet recombined "
                     "surfaces), or cut its element into tetrahedra");
    });
}

}  // namespace almesh
