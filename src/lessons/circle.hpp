// What lessons 5 to 8 work on: the ring of section 4.1, whose inner circle is moved while the outer one stays.
#pragma once
#include <string>
#include <vector>

#include "constraint/dirichlet.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"

namespace almesh::lessons {

using Vector = std::vector<double>;

// 841 nodes and 1642 triangles between circles of radius 1 (32 edges) and 21 (8 edges).
inline Mesh ring() {
    std::vector<std::string> notes;
    return build_mesh(read_mesh("inputs/meshes/circle.msh"), notes);
}

// Where the nodes of the boundary should be after a part of a motion. motion: of the inner circle, as decks have it:
// "translate 8 0".
inline BoundaryTarget inner_circle_by(const Mesh& mesh, const std::string& motion, double part = 1) {
    const Motion inner = at_fraction(parse_motion(motion), part), outer = motion_of(NodeKind::fixed);
    std::vector<Motion> motions;
    for (const std::string& name : mesh.boundaries) motions.push_back(name == "inner" ? inner : outer);
    return make_target(mesh, motions);
}

}  // namespace almesh::lessons
