// Blocks of hexahedra, prisms, pyramids and tetrahedra built in code for the tests.
#pragma once
#include <string>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh::test {

// k x k columns of unit cubes / k, a layer for each letter, from the bottom: h: a hexahedron; p: two prisms; d: five
// pyramids around the centre, the top of the cube being two tetrahedra; u: the same upside down. A p has d or p below
// and u or p above it; nothing else has triangles to neighbours. Inner vertices are moved by `amplitude` / k or less.
// Boundaries bottom, top, sides; volume: all.
RawMesh solid_block(int k, const std::string& layers, double amplitude = 0);

Mesh solid_mesh(int k, const std::string& layers, double amplitude = 0);

// Meshes of one type each, and one of all four.
std::vector<Mesh> solid_meshes(double amplitude = 0.1);

}  // namespace almesh::test
