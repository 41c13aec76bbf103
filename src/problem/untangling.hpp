// Makes a mesh with inverted elements valid: the distortion with the regularised
// determinant of Eq. 3 is minimised for smaller and smaller delta, on the schedule of Garanzha, Kaporin, Kudryavtseva,
// Protais, Ray, Sokolov ("Foldover-free maps in 50 lines of code", ACM TOG 40, 2021). With the least determinant D of
// the mesh and the fall s of the energy, s = 1 - E_k / E_k-1, but between 1/10 and 1/2, the next delta is such that
//
//     sigma_delta'(D) = (1 - s) sigma_delta(D) =: m,   that is   delta'^2 = m (m - D).
//
// Only regions around inverted elements take part, each with its own delta, first with one layer of elements around,
// then with two, four, ..., where that does not do. What a region comes to counts only where it is certified valid:
// valid elements stay so. The nodes of the boundary are fixed; where that does not do, those that slide do so, held on
// their surfaces by a penalty and then projected onto them. Where one has gone past a corner, so that the boundary is
// folded over, the region counts as not valid.
#pragma once
#include <string>
#include <vector>

#include "constraint/constraint.hpp"
#include "constraint/target.hpp"
#include "energy/distortion_energy.hpp"
#include "linalg/linear_solver.hpp"

namespace almesh {

struct UntanglingResult {
    std::vector<int> left;  // elements that are not certified valid, but for infeasible ones, the worst first
    int regions = 0;        // that were untangled
    int newton_iterations = 0;
};

// x: node_count x dim. energy: without regularisation, on return too; its ideal elements have these volumes, per
// element. constraint: where it does not hold at x, all nodes of the boundary but for free ones are fixed. infeasible:
// those of the energy, as of why_infeasible(); or empty.
UntanglingResult untangle_regions(const Mesh& mesh, const std::vector<double>& volume, DistortionEnergy& energy,
                                  Constraint& constraint, const BoundaryTarget& target,
                                  const LinearSolverParams& linear, const std::vector<std::string>& infeasible,
                                  std::vector<double>& x);

}  // namespace almesh
