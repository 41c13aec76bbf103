// How well the faces of a boundary that slides follow the surface along which its nodes do.
#pragma once
#include <vector>

#include "constraint/sliding.hpp"
#include "constraint/target.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Largest distance from their surface of points of the faces that have a node that slides, sampled at a grid of
// barycentric coordinates twice as fine as the nodes. x: node_count x dim positions, target and x in units of
// sliding.unit(). 0 where no node slides.
double distance_from_surfaces(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces& sliding,
                              const std::vector<double>& x);

// Largest distance of a freed node from the position that the target had for it; 0 where none is freed.
double largest_slide(const Mesh& mesh, const BoundaryTarget& target, const std::vector<double>& x);

}  // namespace almesh
