// Prolongation of a field from a mesh to a finer one: finite element interpolation.
//
// The finer mesh comes from the coarser one by refine() or raise_degree(), so each fine node lies in a coarse element,
// at a point xi of its reference simplex whose coordinates are multiples of 1 / (c p), where each edge of the coarse
// element was cut into c parts and p is the fine degree, and
//
//     u_fine = sum over the nodes j of that element of  N_j(xi) u_j.
//
// u is continuous, so any element that has the node gives the same value, and on the boundary only the values on the
// boundary count. The map phi = y + u of straight-sided elements keeps its D phi, so a valid map stays valid and keeps
// its distortion energy. Cost: O(nodes * p^n).
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// field: coarse.nodes() x dim; ideal positions: nodes x dim each. Returns fine.nodes() x dim.
std::vector<double> prolong(const Mesh& coarse, const std::vector<double>& coarse_ideal, const Mesh& fine,
                            const std::vector<double>& fine_ideal, const std::vector<double>& field);

}  // namespace almesh
