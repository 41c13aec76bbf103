// A curved mesh made better by its vertices alone: the mesh with straight sides on them is improved, and what lies
// between vertices is as far from the straight sides as before. Straight elements stay straight, so that what is
// certified of them is not lowered; curved faces stay, as their vertices do.
#pragma once
#include <functional>
#include <vector>

#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

// Where it takes the nodes of the problem's mesh, in its frame; nothing where the mesh with straight sides cannot be
// improved, or faces would leave the file's surface.
std::vector<double> moved_vertices(const ProblemSetup& setup, const Problem& problem,
                                   const std::function<Solution(const ProblemSetup&, Problem&)>& improve_straight);

}  // namespace almesh
