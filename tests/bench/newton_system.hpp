// The functional of a deck at its ideal mesh, and the linear system of its first Newton step.
#pragma once
#include <string>
#include <vector>

#include "app/problem.hpp"
#include "method/augmented_functional.hpp"

namespace almesh::bench {

struct NewtonSystem {
    Problem problem;
    DistortionParams params;
    DistortionEnergy distortion;
    BoundaryConstraint constraint;  // refers to problem
    BlockCsr A;
    std::vector<double> b;  // minus the gradient

    // name: of a deck in inputs/; settings replace its own.
    NewtonSystem(const std::string& name, const std::vector<std::string>& settings)
        : NewtonSystem(read_deck("inputs/" + name + ".deck", settings)) {}
    NewtonSystem(const NewtonSystem&) = delete;
    NewtonSystem& operator=(const NewtonSystem&) = delete;

private:
    explicit NewtonSystem(const Deck& deck)
        : problem(make_problem(deck)),
          params(deck.distortion),
          distortion(problem.mesh, problem.ideal, params),
          constraint(problem.mesh, problem.ideal, problem.target, deck.target),
          A(distortion.hessian_pattern()),
          b(A.size()) {
        constexpr double penalty = 1000;  // in units of |1|^2
        const AugmentedFunctional E{distortion, constraint, std::vector<double>(constraint.size(), 0.0),
                                    penalty * constraint.norm_of_one() * constraint.norm_of_one()};
        E.hessian(problem.ideal, HessianKind::squared_projected, A);
        E.gradient(problem.ideal, b);
        for (double& value : b) value = -value;
    }
};

}  // namespace almesh::bench
