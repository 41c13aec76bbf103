// Distance of every node to a wall: to the curved faces of degree p themselves, not to their nodes.
//
// Each face is a polynomial in Bezier form. It is bisected into nearly flat pieces; from the closest corner or centre
// of a piece the closest point of the whole face is found by FaceProjector, with an error of the order of rounding
// relative to the size of the face, however thin the layers at the wall are. Only pieces whose box (that of the Bezier
// points, which encloses them) is nearer than the best distance so far are looked at: a few for each node.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// boundary: index into mesh.boundaries. x: node_count x dim positions, finite. Returns node_count distances, exactly 0
// for the nodes of the wall. Throws InputError where the boundary has no faces.
std::vector<double> wall_distance(const Mesh& mesh, const std::vector<double>& x, int boundary);

}  // namespace almesh
