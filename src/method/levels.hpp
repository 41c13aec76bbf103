// Continuation in the level, from coarse to fine: the problem is solved on coarser meshes first, then with elements of
// degree 1, 2, 4, ..., and each solution is where the method starts on the next finer mesh.
//
// Carried over are the displacement, interpolated (prolong()), the penalty in units of |1|^2, and the
// multipliers. The force that they put on the boundary is the integral of lambda . v / (h |1|), so lambda / (h |1|)
// is the same on both meshes. Refinement divides every h by the same number, and |1|^2 = sum |f| / h is
// inversely proportional to h; so lambda_fine = lambda_coarse |1|_coarse / |1|_fine, interpolated. The penalty grows
// a hundredfold from mesh to mesh: from a good start a large one costs no Newton steps, and saves updates of the
// multipliers.
//
// A step on a mesh that was refined k times less costs 2^(-n k) of one on the deck's own mesh, so one step on each
// of the coarser meshes costs, all together, a third of one on the deck's own (2D).
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "method/continuation.hpp"

namespace almesh {

constexpr double largest_start_penalty = 1e7;  // in units of |1|^2

// What a coarser mesh hands to the next finer one. level is null before the first mesh, and if the coarser one failed.
struct CoarseSolution {
    std::unique_ptr<Level> level;      // without its energy
    std::vector<double> displacement;  // node_count x dim
    std::vector<double> multipliers;   // node_count x dim, as a vector field, zero inside
    double mu = 0;                     // in units of |1|^2
};

// Solves the problem on the levels 0, 1, ... levels - 1 that make_level(k) makes, with the adaptive schedule and
// tolerances looser than those given. Empty if the last of them failed. Adds to `time`; its total includes the
// construction of the levels.
CoarseSolution solve_coarser(int levels, const std::function<std::unique_ptr<Level>(int)>& make_level,
                             const MethodParams& params, Timings& time, const StageObserver& observe);

// Sets x (node_count x dim) and the start of the method: the coarse solution, or the identity map without multipliers
// if there is none, if it is not valid on this mesh (by rounding), or if the solution of a lower degree is hardly
// nearer to the target, because the motion only curves the boundary.
AlStart start_from(const CoarseSolution& coarse, const Level& level, std::vector<double>& x);

}  // namespace almesh
