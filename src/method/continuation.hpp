// Coarse-to-fine start: the deck's problem is solved on coarser meshes first, and each solution is where the method
// starts on the next finer mesh.
//
// Carried over are the displacement, interpolated (prolongation.hpp), the penalty in units of |1|^2, and the
// multipliers. The force that they put on the boundary is the integral of lambda . v / (h |1|), so lambda / (h |1|)
// is the same on both meshes. Refinement divides every h by the same number, and |1|^2 = sum |f| / h is
// inversely proportional to h; so lambda_fine = lambda_coarse |1|_coarse / |1|_fine, interpolated. The penalty grows
// tenfold from mesh to mesh: from a good start a large one costs no Newton steps, and saves updates of the multipliers.
//
// A step on a mesh that was refined k times less costs 2^(-n k) of one on the deck's own, so all coarse steps together
// cost a third of those of the next coarser mesh (2D).
#pragma once
#include <functional>
#include <vector>

#include "app/problem.hpp"
#include "method/coarse_stage.hpp"

namespace almesh {

// What a coarser mesh hands to the next finer one. Where it failed, and before the first, there is no displacement.
struct CoarseSolution {
    Mesh mesh;
    std::vector<double> ideal;         // node_count x dim
    std::vector<double> displacement;  // node_count x dim
    std::vector<double> lambda;        // node_count x dim, zero inside
    double norm_of_one = 0;            // |1|
    double mu = 0;                     // in units of |1|^2
};

bool starts_coarse(const Deck& deck);

// Solves the deck's problem on the mesh refined 0, 1, ... times, but not as often as the deck says; no solution where
// the deck does not ask for that, or where the last of them failed. Tolerances are looser than the deck's. Adds to
// `time`, to its total the making of the meshes included.
CoarseSolution solve_coarser(const Deck& deck, const Problem& problem, Timings& time,
                             const std::function<void(const CoarseStage&)>& observe);

// Sets x (node_count x dim) and where the method starts: at the coarse solution, or at the identity map without
// multipliers where there is none, or where its energy is infinite on this mesh (by rounding).
AlStart start_from(const CoarseSolution& coarse, const Problem& problem, const DistortionEnergy& distortion,
                   const BoundaryConstraint& constraint, std::vector<double>& x);

}  // namespace almesh
