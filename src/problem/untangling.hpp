// Makes a mesh with inverted elements valid: the distortion with the regularised
// determinant of Eq. 3 is minimised for smaller and smaller delta, on the schedule of Garanzha, Kaporin, Kudryavtseva,
// Protais, Ray, Sokolov ("Foldover-free maps in 50 lines of code", ACM TOG 40, 2021). With the least determinant D of
// the mesh and the fall s of the energy, s = 1 - E_k / E_k-1, but between 1/10 and 1/2, the next delta is such that
//
//     sigma_delta'(D) = (1 - s) sigma_delta(D) =: m,   that is   delta'^2 = m (m - D).
//
// Only regions around inverted elements move, each with its own delta: with one layer of elements around, then with
// two, four, ..., until they become valid. The result of a region is taken only if it is certified valid: valid
// elements stay valid. Boundary nodes are fixed; if that fails, sliding nodes move too, kept near their surfaces by a
// penalty and then projected onto them. If such a node has passed a corner, so that the boundary is folded over, the
// region counts as not valid.
//
// The ideal elements are those of another mesh if it is given. Else, and where these lead nowhere, they are like the
// valid ones around (mesh/local_size.hpp), with the thickness of their layer, and where these lead nowhere regular.
// Nodes that need not move for that go back.
#pragma once
#include <vector>

#include "problem/problem.hpp"

namespace almesh {

struct UntanglingResult {
    std::vector<int> left;  // feasible elements that are still not certified valid, the worst first
    int regions = 0;        // that were untangled
    int newton_iterations = 0;
};

// x: node_count x dim, with these invalid elements. The problem has its functional; if its constraint does not hold at
// x, all boundary nodes but free ones are fixed. Elements that stay invalid become infeasible.
UntanglingResult untangle(const ProblemOptions& options, Problem& problem, std::vector<int> invalid,
                          std::vector<double>& x);

}  // namespace almesh
