// Some elements of a mesh as a mesh of its own.
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// chosen: per element of the mesh, not all zero. The elements keep their order and their nodes' positions and ids;
// faces that the part shares with the rest are its boundary `cut`. What the file keeps besides (Mesh::kept, entities)
// is left out.
Mesh part_of(const Mesh& mesh, const std::vector<char>& chosen, const std::string& cut);

// The elements that have a vertex in common with a chosen one become chosen too.
void add_layer(const Mesh& mesh, std::vector<char>& chosen);

}  // namespace almesh
