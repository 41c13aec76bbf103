// Improvement of a mesh in place: ideal = regular | size FORMULA | mesh FILE, and almesh improve FILE.
//
// Where the mesh has inverted elements, it is made valid first (untangling.hpp), with the boundary where it is, or
// sliding. The distortion relative to the ideal elements is then minimised from there, by the method and with the
// boundary of the setup. With ideal = regular and boundaries that are fixed or only slide, a valid mesh stays as it is
// where this would lower its least scaled Jacobian, and a boundary whose nodes slide to no valid mesh is fixed.
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

// The ideal elements are regular ones, of the size of those around in the mesh file.
void set_regular_elements(Problem& problem);

// Adds all steps other than those of `solve` to newton_steps.
Solution improve(const ProblemSetup& setup, Problem& problem, const Solve& solve, int& newton_steps, std::FILE* out);

}  // namespace almesh
