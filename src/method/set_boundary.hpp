// Sets the boundary on its target, at once or in load increments, and minimises the distortion inside. This needs no
// multipliers, but a valid mesh to start each increment from: continuation.hpp tries it if Algorithm 1 fails.
//
//   x = ideal mesh; for t = 1/n, 2/n, ..., 1: the boundary to its position at the fraction t of the motion, the nodes
//   inside as those of an elastic solid (Newton::predict()), then Newton's method with the boundary fixed
#pragma once
#include <vector>

#include "method/continuation.hpp"

namespace almesh {

// Positions of the constraint's nodes at a fraction of the motion; on the straight way to their targets if boundaries
// that share nodes do not agree at this fraction.
std::vector<double> targets_at(const Level& level, double fraction);

// x: node_count x dim, a valid mesh on entry, the ideal one if there are several increments. One of several increments
// is halved if it has no valid start. If that does not help, the status is invalid_start, and x the mesh before the
// increment. `newton_iterations` includes the linear solves of the solid.
AlResult minimise_with_boundary_set(const Level& level, Newton& newton, const MethodParams& params, int increments,
                                    std::vector<double>& x, const AlObserver& observer = {});

}  // namespace almesh
