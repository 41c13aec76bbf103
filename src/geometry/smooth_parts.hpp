// The boundary of a mesh in smooth parts, for meshes whose file names none.
#pragma once
#include <vector>

#include "base/small_matrix.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Outward unit normal of the flat face with the same vertices.
Vec<3> unit_normal(const Mesh& mesh, int f);

// Per face: the number of its part, from 1, in the order of their first faces. Neighbouring outer faces are in one part
// where their normals are at most feature_angle degrees apart. Inner faces: 0. Cost: O(faces log faces).
std::vector<int> smooth_parts(const Mesh& mesh, double feature_angle);

}  // namespace almesh
