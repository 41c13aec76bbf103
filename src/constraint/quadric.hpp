// Quadrics (2D: conics): ellipsoids, cones, elliptic cylinders, paraboloids, hyperboloids.
#pragma once
#include <memory>
#include <vector>

#include "constraint/surface.hpp"

namespace almesh {

// The quadric through all points, to `tolerance` times their extent; null where there is none, more than one, too few
// points to tell, or where the points come near a point at which it has no normal (an apex, a line where two planes
// meet). Its projections are the closest points of it, but for x beyond its centres of curvature.
std::unique_ptr<Surface> fit_quadric(int dim, const std::vector<Vec<3>>& points, double tolerance);

}  // namespace almesh
