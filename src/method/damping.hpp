// Levenberg's damping of the projected Hessian.
//
// A projected Hessian that is nearly singular, as that of (eta - 1)^2 is where the mesh has hardly deformed, asks for
// steps that invert thousands of elements, and a step length that suits them all hardly moves the mesh. So it is
// damped by
//
//     t K,   t = factor * mean_slope(),   K: stiffened elasticity (distortion_energy.hpp)
//
// which scales with the distortion like the Hessian itself. As a trust region would (Levenberg 1944; Nocedal & Wright,
// Numerical Optimization, sec. 10.3) the factor falls after a full or longer step and grows after one that was cut; it
// is kept from one subproblem to the next. The full Hessian is used undamped, once the factor is small.
#pragma once
#include <algorithm>

#include "energy/options.hpp"

namespace almesh {

struct Damping {
    double factor = 0.1;
    bool is_used = true;

    static Damping none() { return {0, false}; }  // of few nodes: a step that is cut costs little there
    void reset() { factor = 1; }  // where nothing is known: at the identity map
    // Returns the Hessian to try next.
    HessianKind after_step(double step_length) {
        constexpr double shrinks = 0.2, grows = 4, full_below = 0.1;
        factor = step_length >= 1 ? shrinks * factor : std::min(1.0, grows * factor);
        return is_used && step_length >= 1 && factor <= full_below ? HessianKind::full : HessianKind::projected;
    }
};

}  // namespace almesh
