// surface = straighten: where no valid mesh keeps the curved target, faces of it are made flat, until one does.
#pragma once
#include <cstdio>

#include "app/problem.hpp"
#include "app/results.hpp"

namespace almesh {

// Solves the problem, whose target folds nothing by itself; while that does not end in a certified mesh, with the faces
// flat that hold it up and those beside them, from the ideal mesh again: at most all faces. Where those cannot be flat
// the target stays as it is, and the deck's own limits end the run. Returns the last solution.
Solution solve_straightening(const Deck& deck, Problem& problem, const Solve& solve, std::FILE* out);

}  // namespace almesh
