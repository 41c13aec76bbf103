// How much of the negative eigenvalues of the Hessian of each point a Newton step keeps (Projection::negative_part).
//
// With all of them (1) convergence is quadratic, but far from the minimum the sum is indefinite. With none (0) it never
// is, and steps are short: a negative eigenvalue of one element is most often outweighed by its neighbours, and away
// from a saddle, where what is left of both is small, nothing leads but gradients. So as much is kept as the sum bears.
#pragma once
#include <algorithm>

namespace almesh {

// Of local minimisations, whose systems are small: all of them first; half as much after a Hessian that gave no step,
// or a step that was cut, twice as much after a full or longer step.
struct NegativePart {
    double value = 1;

    // The Hessian gave no descent direction or no step.
    void weaken() { value = value / 2 < least ? 0 : value / 2; }
    void after_step(double step_length) {
        value = step_length >= 1 ? std::min(1.0, std::max(least, 2 * value)) : std::max(least, value / 2);
    }

private:
    static constexpr double least = 0.1;  // but for 0
};

// Of the projected Hessian of the whole mesh, where one that turns out indefinite is dear: none first; more after steps
// that had to be lengthened, because the Hessian was too stiff. Never all: that is the full Hessian, which is tried
// anyway. For direct solvers: to conjugate gradients the Hessian is the harder, the less positive it is.
struct NegativePartOfMesh {
    double value = 0;

    void weaken() { value = value / 2 < least ? 0 : value / 2; }
    void after_step(double step_length) {
        if (step_length > 1) value = std::min(most, std::max(first, 2 * value));
        if (step_length < 1) weaken();
    }

private:
    static constexpr double least = 0.1, first = 0.2, most = 0.9;
};

}  // namespace almesh
