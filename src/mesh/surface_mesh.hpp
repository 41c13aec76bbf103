// A surface that bounds no elements, such as a scan, as a mesh of faces alone: along which others slide.
#pragma once
#include <string>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

// The triangles (dim = 2: lines) among the elements, quadrilaterals as two; faces that are curved go straight from
// vertex to vertex. Nodes that agree to the rounding of single precision are one, doubled faces and those without area
// are left out, and neighbours are turned alike, closed surfaces outward. Boundaries: the physical groups. Mesh::x has
// nothing but the nodes of faces, Mesh::face_element is -1. notes: what was corrected, and where it has edges.
// Throws InputError where there are no such faces, and where points are off the plane in 2D.
Mesh surface_mesh(const RawMesh& raw, int dim, std::vector<std::string>& notes);

}  // namespace almesh
