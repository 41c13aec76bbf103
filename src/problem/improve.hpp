// Improvement of a mesh in place: ideal = regular | size FORMULA | mesh FILE, and almesh improve FILE.
//
// A mesh with inverted elements is made valid first (untangling.hpp), with the boundary where it is, or sliding. What
// follows, with boundaries that are fixed or only slide and ideal = regular, loses nothing that is guarded
// (improvement_guard.hpp): the least scaled Jacobian is raised (corner_smoothing.hpp). With another ideal or a boundary
// that moves, or where the setup names an objective, the distortion relative to the ideal elements is minimised.
// A curved mesh is improved as the one with straight sides on its vertices, and curved again.
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "problem/solution.hpp"
#include "problem/solve.hpp"

namespace almesh {

// The ideal elements are regular ones, of the size of those around in the mesh file.
void set_regular_elements(Problem& problem);

// Adds all steps other than those of `solve` to newton_steps.
Solution improve(const ProblemSetup& setup, Problem& problem, const Solve& solve, MeshSoFar& so_far,
                 int& newton_steps, std::FILE* out);

}  // namespace almesh
