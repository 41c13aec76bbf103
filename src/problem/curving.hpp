// Makes curved meshes valid whose boundary should stay as it is in the file: CAD meshes.
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "problem/solve.hpp"

namespace almesh {

// Starts from the mesh of the file with its invalid elements straightened, which is certified (check/straightened.hpp),
// and restores as much of the curved boundary as possible. These attempts are made in this order, each around all
// connected sets of elements that are still straightened:
//   1. the boundary as it is in the file, the nodes inside move;
//   2. nodes slide in planes, which keep their shape: in large sets those that are no vertices, then all;
//   3. nodes on boundary faces of elements that the boundary alone makes invalid slide along the surface, then those of
//      the faces beside them too, around larger sets and around smaller ones;
//   4. faces of these elements become flatter, as few and by as little as makes no element invalid by itself, beside
//      planes in which nodes slide;
//   5. what was straightened stays so.
// Each is a separate problem on the elements around, with all other nodes fixed, and is accepted if it is certified.
//
// A small mesh, which is solved in about a second, is also solved as a whole: before the attempts if the boundary alone
// makes no element invalid, else after them, from their mesh and with its boundary, unless step 5 was needed.
// local_repair = 0 treats every mesh as small, local_repair = 1 none.
// The result is the mesh certified last, also if the run is interrupted. On return the problem's target is the boundary
// of that mesh, and the nodes that slid are freed; straight_faces() are the faces that differ from the file.
//
// The mesh so far is that of the first solution as a whole, then that of the parts: a resumed run solves again the part
// that was interrupted, and the whole mesh after the parts.
Solution curve_in_place(const ProblemOptions& options, Problem& problem, const Solve& solve,
                        const StageObserver& observe, MeshSoFar& so_far, std::FILE* out);

// As certify_injective() of check/injectivity.hpp: of a mesh that is curved in place with certify_curved().
Injectivity certified_injective(const Problem& problem, const std::vector<double>& x, const Certificate& certificate);

}  // namespace almesh
