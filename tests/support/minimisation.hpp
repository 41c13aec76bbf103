// A ring or cube with a moving boundary, ready to be minimised, for the tests of method/.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "method/augmented_lagrangian.hpp"
#include "support/targets.hpp"

namespace almesh::test {

// Keeps all that the functional refers to.
struct Minimisation {
    Mesh mesh;
    std::vector<double> ideal;
    Objective objective;
    DistortionEnergy distortion;
    BoundaryConstraint constraint;

    Minimisation(const Mesh& any, const std::map<std::string, std::string>& motions, Objective wanted,
                 TargetKind kind = TargetKind::exact)
        : mesh(any),
          ideal(straight_sided(mesh)),
          objective(wanted),
          distortion(mesh, ideal, {.objective = wanted}),
          constraint(mesh, ideal, target_of(mesh, motions), kind) {}

    // mu: in units of |1|^2; no multipliers.
    AugmentedFunctional functional(double mu) const {
        const double one = constraint.norm_of_one();
        return {distortion, constraint, std::vector<double>(constraint.size(), 0.0), mu * one * one};
    }

    // x: the last iterate, from the identity map.
    AlResult solve(const AugmentedLagrangianParams& params, std::vector<double>& x, const AlObserver& observer = {},
                   const LinearSolverParams& linear = {}) const {
        x = ideal;
        Newton newton(distortion, linear);
        Timings time;
        return almesh::minimise(distortion, constraint, newton, params, x, time, observer);
    }
};

inline constexpr Objective objectives[] = {Objective::squared, Objective::deviation};

}  // namespace almesh::test
