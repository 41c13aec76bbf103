// Carrying a field from a mesh to a finer one: finite element interpolation.
//
// The finer mesh comes from the coarser one by refine() or raise_degree(), so each fine node lies in a coarse element,
// at a point xi of its reference simplex whose coordinates are multiples of 1 / (cuts * p), and
//
//     u_fine = sum over the nodes j of that element of  N_j(xi) u_j.
//
// u is continuous: whichever of its elements a node is looked up in, and on the boundary the values on the boundary
// alone decide. For the map phi = y + u of straight-sided elements D phi stays what it is, so a valid map stays valid
// and keeps its distortion energy. Cost: O(nodes * p^n).
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// field: coarse.nodes() x dim; ideal positions: nodes x dim each. Returns fine.nodes() x dim.
std::vector<double> prolong(const Mesh& coarse, const std::vector<double>& coarse_ideal, const Mesh& fine,
                            const std::vector<double>& fine_ideal, const std::vector<double>& field);

}  // namespace almesh
