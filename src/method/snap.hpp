// The last step of a run: boundary nodes, which the method has brought to their targets up to its tolerances, are set
// to them to the last bit. Where that would fold an element they stay where they are.
#pragma once
#include <vector>

#include "constraint/constraint.hpp"
#include "energy/distortion_energy.hpp"

namespace almesh {

// x: a valid mesh, before and after. Nodes are set together, and where elements do not stay valid on the way, in halves
// of their list, down to single ones; after `most_tries` what is left stays. Returns the number of nodes that are not
// at their targets.
// chosen: per node of the mesh, which of them; empty: all.
int snap_to_targets(DistortionEnergy& distortion, const Constraint& constraint, std::vector<double>& x,
                    const std::vector<char>& chosen = {});

// Nodes of the constraint that are not at their targets, to the last bit.
int nodes_off_target(const Constraint& constraint, const std::vector<double>& x);

}  // namespace almesh
