// Writer of Gmsh mesh files, ASCII, in the version the mesh came in (MSH 2.2 or 4.1): the elements and boundary faces
// with the ids, tags and names of the input and new positions. A 2D mesh is written at z = 0.
//
// Coordinates are the shortest decimals that read back to the same bits (17 digits at most).
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// x: node_count x dim positions, in place of mesh.x.
std::string msh_text(const Mesh& mesh, const std::vector<double>& x);

// Throws InputError where the file cannot be written.
void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh
