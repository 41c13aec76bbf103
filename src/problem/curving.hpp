// Curved meshes whose boundary is to stay where the file has it: CAD meshes, made valid.
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "problem/solve.hpp"

namespace almesh {

// From the mesh of the file with its invalid elements straightened, which is certified (check/straightened.hpp), to one
// that keeps as much of the boundary as it can. Around connected sets of elements that are still straightened, in this
// order, each everywhere before the next:
//   1. the boundary as it is in the file, the nodes inside move;
//   2. nodes slide in planes, which keep their shape: in large sets those that are no vertices, then all;
//   3. the nodes slide along the surface that are on boundary faces of elements which the boundary alone makes invalid,
//      then those of the faces beside them too, around larger sets and around smaller ones;
//   4. faces of these elements become flatter, as few and by as little as makes no element invalid by itself, beside
//      planes in which nodes slide;
//   5. what was straightened stays so.
// Each is a problem of its own on the elements around, whose other nodes are fixed, and counts when it is certified.
//
// A small mesh, whose nodes can all move in about a second, is solved as a whole: before, where the boundary alone
// makes no element invalid, else after, from there and with the boundary that was found, unless step 5 was needed.
// local_repair: never or always only as parts.
// What is certified last is the result, also where the run is interrupted. On return the problem's target is where the
// boundary is, with the nodes that slid freed; straight_faces() are those that are not where the file has them.
//
// The mesh so far is that of the whole mesh before anything is straightened, then that of the parts: a part that was
// being solved, and the whole mesh after the parts, are solved again by a run that goes on.
Solution curve_in_place(const ProblemOptions& options, Problem& problem, const Solve& solve,
                        const StageObserver& observe, MeshSoFar& so_far, std::FILE* out);

// As certify_injective() of check/injectivity.hpp: of a mesh that is curved in place with certify_curved().
Injectivity certified_injective(const Problem& problem, const std::vector<double>& x, const Certificate& certificate);

}  // namespace almesh
