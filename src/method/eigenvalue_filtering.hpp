// Eigenvalue filtering of the projected Hessian: how much of the negative eigenvalues of the Hessian of each point a
// Newton step keeps (Projection::kept_negative).
//
// With all of them (1) convergence is quadratic, but far from the minimum the sum is indefinite. With none (0) it never
// is, and steps are short: a negative eigenvalue of one element is most often outweighed by its neighbours, and away
// from a saddle, where what is left of both is small, nothing leads but gradients. So as much is kept as the sum bears:
// half as much after a Hessian that gave no step or a step that was cut, twice as much after one that shows that the
// Hessian was too stiff.
#pragma once
#include <algorithm>

namespace almesh {

struct EigenvalueFiltering {
    double kept = 0;

    // The whole mesh, where a Hessian that turns out indefinite is dear: none first; more after steps that had to be
    // lengthened. Never all: that is the full Hessian, which is tried anyway. For direct solvers: to conjugate
    // gradients the Hessian is the harder, the less positive it is.
    static EigenvalueFiltering of_mesh() { return {}; }
    // Local minimisations, whose systems are small: all of them first, more after every full or longer step, and none
    // only where a Hessian gives no step.
    static EigenvalueFiltering of_few_nodes() { return {1, 1, least, least, true, false}; }

    // The Hessian gave no descent direction or no step.
    void weaken() { kept = kept / 2 < least ? 0 : kept / 2; }
    void after_step(double step_length) {
        if (step_length > 1 || (step_length == 1 && after_full_steps)) kept = std::min(most, std::max(first, 2 * kept));
        if (step_length >= 1) return;
        weaken();
        kept = std::max(least_after_cut, kept);
    }

    double most = 0.9, first = 0.2, least_after_cut = 0;
    bool after_full_steps = false;
    bool only_direct = true;  // none for iterative solvers
    static constexpr double least = 0.1;  // but for 0
};

}  // namespace almesh
