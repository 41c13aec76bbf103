// Where only a few elements of a curved mesh are folded: they and those around them are curved anew, and all other
// nodes stay where the file has them (key `region`).
#pragma once
#include <cstdio>
#include <functional>

#include "app/problem.hpp"
#include "app/results.hpp"

namespace almesh {

using Solve = std::function<Solution(const Deck& deck, const Problem& problem)>;

// The region, a mesh of its own whose boundary is fixed, is two layers of elements around the folded ones; it grows
// until the whole mesh is valid, and from 70 % on is the whole mesh. Returns the solution on the whole mesh, whose
// iterations are those of the last region. problem: with region = folded. Where the run is interrupted the nodes are on
// the ideal mesh.
Solution mend(const Deck& deck, const Problem& problem, const Solve& solve, std::FILE* out);

}  // namespace almesh
