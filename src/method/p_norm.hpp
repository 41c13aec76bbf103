// p-norm continuation, to the mesh whose worst element is best: the least M for which eta - 1 <= M everywhere,
// approached by powers.
//
// The integral of (eta - 1)^p, to the power 1/p, comes near to the maximum of eta - 1 as p grows. Its minimisers are
// found one from the other, p = 2, 4, 8, ..., with the density
//
//     M^2 (s^p + kappa_p s^2),   s = (eta - 1) / M,   kappa_p = 0.012 / p,
//
// M the largest eta - 1 at the start of the power, so that no power overflows. Where s is well below one, s^p has no
// stiffness left, and its Hessian is singular there; the square keeps these elements in the shape that the objective
// `deviation` gives them. With the factor M^2 energies and multipliers keep their size from power to power; what is
// left of a change is scaled out: lambda is a force, and so grows like p E.
//
// All powers but the last are solved loosely. It is 64, or an earlier one where the last doubling lowered the largest
// eta by less than 0.2 %. Of a mesh with N elements of equal weight, the largest eta - 1 at the minimum for p is at
// most N^(1/p) times the least possible one.
//
// The idea of following minimisers to the least worst distortion: Garanzha, Kaporin, Kudryavtseva, Protais, Desobry,
// Sokolov, "Practical lowest distortion mapping", arXiv 2201.12112, who stiffen a barrier instead; powers have no wall
// to run into.
#pragma once
#include "method/continuation.hpp"

namespace almesh {

// As minimise_in_increments(), which it begins with; then the powers up to `last_power`. Where the last of
// them is not solved the one before is taken, and so on. Newton steps with earlier powers are among
// earlier_newton_iterations, the power of the result is level.energy->power(). observe_stage is called after each
// power but the last, too.
AlResult minimise_p_norm(const Level& level, Newton& newton, const MethodParams& params, int last_power,
                        std::vector<double>& x, const AlStart& start, const AlObserver& observer = {},
                        const StageObserver& observe_stage = {});

}  // namespace almesh
