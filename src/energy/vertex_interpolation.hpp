// Interpolation from degree 1 to degree p: the displacement of each node if vertices move and elements stay affine. The
// coarse space of the p-hierarchy of linear solvers (linalg/krylov/coarse_correction.hpp).
#pragma once
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// One row per node: the basis of degree 1 at the node, in the columns of the vertices, which are numbered as their
// nodes are. No columns for degree 1.
Interpolation vertex_interpolation(const Mesh& mesh);

}  // namespace almesh
