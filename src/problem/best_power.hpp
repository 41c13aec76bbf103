// objective = minimax of a mesh that is improved: the least scaled Jacobian is what its user looks at, and the best
// worst distortion is not always where that is largest. In tetrahedra it mostly is so at a lower power of the p-norm
// continuation: two are tried, where the deck gives none, and the mesh with the larger least scaled Jacobian is taken.
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

Solve best_of_powers(const Solve& solve, std::FILE* out);

}  // namespace almesh
