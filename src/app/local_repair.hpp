// Where only a few elements of a curved mesh are inverted: they and those around them are curved anew, and all other
// nodes stay where the file has them (key `region`).
#pragma once
#include <cstdio>

#include "app/problem.hpp"
#include "app/results.hpp"

namespace almesh {

// The part, a mesh of its own that keeps its nodes where it meets the rest, are the elements within half the size of
// an inverted one: about a layer, and through thin layers. Its reach doubles until the whole mesh is valid, and from 70
// % of the connected elements on it is the whole mesh. Returns the solution on the whole mesh, whose
// iterations are those of the last part. problem: with local_repair = 1; of the nodes that its target frees to slide,
// those that stay where the file has them are prescribed again. Where the run is interrupted the nodes are on the ideal
// mesh.
Solution repair_locally(const Deck& deck, Problem& problem, const Solve& solve, std::FILE* out);

}  // namespace almesh
