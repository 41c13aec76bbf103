// Some elements of a mesh as a mesh of their own.
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/restriction.hpp"

namespace almesh {

// Its elements keep their order, and their nodes positions and ids. Faces that it shares with the rest are its last
// boundary, `cut`. Of what the file says it has no more than ids and zones.
struct MeshPart : Mesh {
    std::vector<int> node_of, element_of, face_of;  // here -> whole; -1 of faces at the cut
    std::vector<char> on_cut;                       // per node

    // Positions, or another field (node_count x dim), of the whole.
    std::vector<double> restricted(const std::vector<double>& field) const { return at_nodes(node_of, field, dim); }
    int cut() const { return static_cast<int>(boundaries.size()) - 1; }
};

// chosen: per element of the mesh, not all zero.
MeshPart part_of(const Mesh& mesh, const std::vector<char>& chosen, const std::string& cut);

// The elements with a vertex within `reach` of a chosen one, along edges, in units of the longest edge of that one:
// with reach = 0 those that have a vertex in common with it, with infinity those connected with one. Of several the
// nearest one counts. Lengths are straight, between the vertices in mesh.x.
std::vector<char> surroundings(const Mesh& mesh, const std::vector<char>& chosen, double reach);

// These elements, of one type, with all nodes and no faces.
Mesh of_one_type(const Mesh& mesh, const std::vector<int>& elements);
std::vector<int> elements_of(const ElementGroup& group);

}  // namespace almesh
