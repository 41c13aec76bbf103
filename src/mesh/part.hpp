// Some elements of a mesh: as a mesh of its own, or no more than the elements with their nodes numbered anew.
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// chosen: per element of the mesh, not all zero. The elements keep their order and their nodes' positions and ids;
// faces that the part shares with the rest are its boundary Mesh::cut, of that name, behind its other ones. What the
// file keeps besides (Mesh::kept, entities) is left out.
Mesh part_of(const Mesh& mesh, const std::vector<char>& chosen, const std::string& cut);

// The elements with a vertex within `reach` of a chosen one, along edges, in units of the longest edge of that one:
// with reach = 0 those that have a vertex in common with it, with infinity those connected with one. Of several the
// nearest one counts. Lengths are straight, between the vertices in mesh.x.
std::vector<char> surroundings(const Mesh& mesh, const std::vector<char>& chosen, double reach);

// These elements, of one type, with all nodes and no faces.
Mesh of_one_type(const Mesh& mesh, const std::vector<int>& elements);
std::vector<int> elements_of(const ElementGroup& group);

}  // namespace almesh
