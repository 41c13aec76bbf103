// Harmonic extension: each coordinate of the displacement solves the Laplace equation on the mesh, K_ij = the integral
// of g_i . g_j. The maximum principle keeps the displacement within that of the boundary, not the mesh valid.
#include "method/comparators.hpp"

namespace almesh {

Stiffness harmonic_stiffness(double) { return {.a = 1}; }

}  // namespace almesh
