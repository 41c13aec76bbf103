// A ring or cube with a moving boundary, ready to be minimised, for the tests of method/.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "constraint/dirichlet.hpp"
#include "method/levels.hpp"
#include "method/functional.hpp"
#include "support/assemblies.hpp"
#include "support/targets.hpp"

namespace almesh::test {

// Keeps all that the functional refers to.
struct Minimisation {
    Level level;
    const Mesh& mesh;
    const std::vector<double>& ideal;
    Objective objective;
    DistortionEnergy& distortion;
    Dirichlet& constraint;

    Minimisation(const Mesh& any, const std::map<std::string, std::string>& motions, Objective wanted,
                 TargetKind kind = TargetKind::least_squares, Assembly assembly = Assembly::simd)
        : level{any, straight_sided(any), nullptr, nullptr},
          mesh(level.mesh),
          ideal(level.ideal),
          objective(wanted),
          distortion(*(level.energy = make_energy(mesh, ideal, AssembledParams{{wanted}, assembly}))),
          constraint(set_constraint(motions, kind)) {}

    // mu: in units of |1|^2; no multipliers.
    AugmentedFunctional functional(double mu) const {
        const double one = constraint.norm_of_one();
        return {distortion, constraint, std::vector<double>(constraint.multipliers(), 0.0), mu * one * one};
    }

    // x: the last iterate, from the identity map.
    AlResult solve(const AugmentedLagrangianParams& params, std::vector<double>& x, const AlObserver& observer = {},
                   const LinearSolverParams& linear = {}) const {
        x = ideal;
        Newton newton(distortion.hessian_pattern(), linear);
        return almesh::minimise(distortion, constraint, newton, params, x, observer);
    }

private:
    Dirichlet& set_constraint(const std::map<std::string, std::string>& motions, TargetKind kind) {
        auto made = std::make_unique<Dirichlet>(mesh, ideal, target_of(mesh, motions), kind);
        Dirichlet& reference = *made;
        level.constraint = std::move(made);
        return reference;
    }
};

inline constexpr Objective objectives[] = {Objective::squared, Objective::deviation};

}  // namespace almesh::test
