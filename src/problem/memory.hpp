// The memory that a run will take, told before it takes it.
#pragma once
#include "linalg/linear_solver.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Bytes at the peak of a run on this mesh: the mesh, the energy's arrays, the Hessian and its preconditioner or factor.
// Blocks of the Hessian are counted exactly, up to the holes of the domain; a Cholesky factor by its law of growth, in
// 3D to a factor of two. Of a run in which no direct factorisation takes over from conjugate gradients.
double predicted_bytes(const Mesh& mesh, const LinearSolverParams& linear);

// Throws the InputError of a run that needs more than these bytes, or numbers more nodes than int can, before its mesh is
// made: the base mesh refined so many times, of this degree. It says with which refinement or degree it takes less
// memory, where there is one.
void check_memory(const Mesh& base, int degree, int refinements, const LinearSolverParams& linear, double available);

// Blocks of the Hessian: pairs of nodes that share an element. Exact but for tunnels and cavities of a 3D domain, each
// of which shifts it by a few blocks.
double hessian_blocks(const Mesh& mesh);

}  // namespace almesh
