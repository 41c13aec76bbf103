// The functional of a deck at its ideal mesh, and the linear system of its first Newton step.
#pragma once
#include <string>
#include <vector>

#include "deck/make_problem.hpp"
#include "method/functional.hpp"

namespace almesh::bench {

struct NewtonSystem {
    Problem problem;
    DistortionParams params;
    BlockCsr A;
    std::vector<double> b;  // minus the gradient

    // name: of a deck in inputs/; settings replace its own.
    NewtonSystem(const std::string& name, const std::vector<std::string>& settings)
        : NewtonSystem(read_deck("inputs/" + name + ".deck", settings)) {}
    DistortionEnergy& distortion() { return *problem.level->energy; }

    NewtonSystem(const NewtonSystem&) = delete;
    NewtonSystem& operator=(const NewtonSystem&) = delete;

private:
    explicit NewtonSystem(const Deck& deck)
        : problem(make_problem(deck)),
          params(deck.distortion),
          A(with_functional(deck).hessian_pattern()),
          b(A.size()) {
        constexpr double penalty = 1000;  // in units of |1|^2
        Constraint& constraint = *problem.level->constraint;
        const AugmentedFunctional E{distortion(), constraint, std::vector<double>(constraint.multipliers(), 0.0),
                                    penalty * constraint.norm_of_one() * constraint.norm_of_one()};
        E.hessian(problem.ideal(), HessianKind::damping, A);
        E.gradient(problem.ideal(), b);
        for (double& value : b) value = -value;
    }

    DistortionEnergy& with_functional(const Deck& deck) {
        set_functional(deck, problem);
        return distortion();
    }
};

}  // namespace almesh::bench
