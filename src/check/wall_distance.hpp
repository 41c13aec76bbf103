// Distance of every node to a wall: to the curved faces of degree p themselves, not to their nodes. The error is of the
// order of the rounding errors of the coordinates, however thin the layers at the wall are. Where a face is curved so
// strongly that the distance has several minima on a nearly flat part of it, the least one may be missed.
//
// Cost: O(log faces) boxes and a few Newton steps for each node.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// is_wall: per boundary. x: node_count x dim positions, finite. Returns node_count distances, exactly 0
// for the nodes of the wall. Throws InputError where the boundary has no faces.
std::vector<double> wall_distance(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& is_wall);

}  // namespace almesh
