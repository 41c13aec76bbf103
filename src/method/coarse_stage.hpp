// What the method came to on a mesh coarser than the deck's own, on the way to a start there: one row of the report.
#pragma once
#include "method/augmented_lagrangian.hpp"

namespace almesh {

struct CoarseStage {
    int nodes = 0;
    AlStatus status = AlStatus::converged;  // where it is not, the next mesh starts from the identity map
    AlIteration last;  // its last iteration; seconds: with making the mesh, its target and the pattern of its matrix
    int newton_iterations = 0;
};

}  // namespace almesh
