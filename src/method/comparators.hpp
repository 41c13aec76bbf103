// Other ways to move a mesh, to be compared with the augmented Lagrangian method: those that set the nodes of the
// boundary on their targets, at once or in load increments, and find positions for the nodes inside.
//
//   harmonic        the displacement is extended inside as a harmonic function (linear_extension.hpp)
//   elasticity      as that of an elastic solid, stiffer where elements are small
//   fixed_boundary  the distortion is minimised with the boundary fixed
//   incremental     the same, load increment by load increment
//   untangle        the same with a regularised distortion, which inverted elements may have
//
// (penalty is a schedule of the augmented Lagrangian loop, schedule.cpp.) All of them end with an AlResult, so that the
// same certificate, report and files follow. In it an iteration is a load increment, and `newton_iterations` counts
// Newton steps or linear solves.
#pragma once
#include <vector>

#include "method/continuation.hpp"

namespace almesh {

// Whether the method sets the boundary on its target: all but the augmented Lagrangian one and penalty.
bool sets_boundary(MovingMethod method);

// x: node_count x dim, the ideal mesh on entry; on return the mesh that the method came to, which is inverted where the
// status is `inverted`, or `invalid_start` of fixed_boundary. increments: how many of the load. observe_stage: called
// after each load increment but the last, whose Newton steps are observed. Adds to newton.time.
AlResult move_with_boundary(const Level& level, Newton& newton, const MethodParams& params, int increments,
                            std::vector<double>& x, const AlObserver& observer = {},
                            const StageObserver& observe_stage = {});

}  // namespace almesh
