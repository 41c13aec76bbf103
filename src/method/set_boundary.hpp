// The boundary is set on its target, at once or in load increments, and the distortion is minimised inside. Where each
// increment has a valid mesh to start from this needs no multipliers; continuation.hpp tries it where Algorithm 1
// fails, and meshes that are improved take it where their boundary stays as it is.
//
//   x = ideal mesh; for t = 1/n, 2/n, ..., 1: the boundary to its position at the fraction t of the motion, the nodes
//   inside as those of an elastic solid (Newton::predict()), then Newton's method with the boundary fixed
#pragma once
#include <vector>

#include "method/continuation.hpp"

namespace almesh {

// Positions of the constraint's nodes at a fraction of the motion. Where the motions of boundaries that share nodes do
// not agree there, on the straight way.
std::vector<double> targets_at(const Level& level, double fraction);

// x: node_count x dim, a valid mesh on entry, the ideal one where there is more than one increment. An increment that
// has no valid mesh to start from is halved if there are several; where there is none at last the status is
// invalid_start, and x the mesh before the increment. `newton_iterations` counts the linear solves of the solid too.
AlResult minimise_with_boundary_set(const Level& level, Newton& newton, const MethodParams& params, int increments,
                                    std::vector<double>& x, const AlObserver& observer = {});

}  // namespace almesh
