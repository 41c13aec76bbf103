// p-norm continuation towards the minimax mesh, whose largest eta - 1 is as small as possible: it is approached by
// powers of eta - 1.
//
// The integral of (eta - 1)^p, to the power 1/p, comes near to the maximum of eta - 1 as p grows. Its minimisers are
// found one from the other, p = 2, 4, 8, ..., with the density
//
//     M^2 (s^p + kappa s^2),   s = (eta - 1) / M.
//
// Where s is well below one, s^p has no stiffness left, and its Hessian is singular there; the square keeps these
// elements in the shape that the objective `deviation` gives them. M is a unit, the largest eta - 1 where a
// minimisation starts, so that no power overflows. The mesh of the last power has to depend on its boundary alone, not
// on the way to it: kappa is that of the mesh, with the mean over the ideal mesh as the norm, and q = 4 p, near to the
// maximum,
//
//     kappa(x) = K (|eta - 1|_q / M)^(p - 2),   K = 0.01.
//
// Like multipliers, kappa is updated between minimisations until it converges; then M does not affect the stationary x.
// With projection P onto the directions in which x is free, P grad E = 0, the derivative of P grad E is
//
//     P (E'' - u v'),   u = grad E_p,   v = (p - 2) / (q E_q) grad E_q,   E_q = M^2 integral of s^q.
//
// With the factor M^2 energies and multipliers keep their size from power to power; what is left of a change is scaled
// out: lambda is a force, and so grows like p E.
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

// Sets kappa, if the density has one, to kappa(x). Returns its relative change.
double update_kappa(DistortionEnergy& energy, const std::vector<double>& x);

// Empty where there is no kappa.
struct KappaChange {
    std::vector<double> u, v;
};
KappaChange change_of_kappa(DistortionEnergy& energy, const std::vector<double>& x);

// minimise_in_increments() with the power 2, then the powers up to `last_power`; a resumed run begins with the power
// that it had reached. If the last power is not solved, the one below it is taken, and so on. Newton steps of earlier
// powers are in earlier_newton_iterations; the power of the result is level.energy->power(). observe_stage is also
// called after each power but the last.
AlResult minimise_p_norm(const Level& level, Newton& newton, const MethodParams& params, int last_power,
                        std::vector<double>& x, const AlStart& start, const AlObserver& observer = {},
                        const StageObserver& observe_stage = {});

}  // namespace almesh
