// Forcing terms of inexact Newton methods: the relative residual to which the next linear system is solved by an
// iterative solver. After a full step took |grad E| from g_before to g,
//
//     0.9 (g / g_before)^a,   a = (1 + sqrt 5)/2,
//
// so that the convergence is of order a, but not less than 0.5 omega / g, which ends the iteration (Eisenstat &
// Walker, SIAM J. Sci. Comput. 17, 1996, choice 2; Kelley, Iterative Methods for Linear and Nonlinear Equations, 1995,
// sec. 6.3). Within [floor, 1e-3]: larger terms save iterations and cost Newton steps, which are dearer; the safeguard
// of the paper is for terms above 0.1. Where no ratio of gradients tells how good the model is, in the first step of a
// subproblem and after a step that was cut, 1e-4: from 1e-9 to 1e-4 the decks of the aircraft with Eq. 5 take the same
// numbers of steps.
#pragma once
#include <algorithm>
#include <cmath>

namespace almesh {

enum class Forcing { automatic, fixed };  // fixed: always the floor

inline double forcing_term(double g_before, double g, double omega, double floor) {
    constexpr double largest = 1e-3;
    const double order = (1 + std::sqrt(5.0)) / 2;
    const double term = std::max(0.9 * std::pow(g / g_before, order), 0.5 * omega / g);
    return std::max(std::min(term, largest), floor);
}

struct ForcingTerm {
    Forcing kind = Forcing::automatic;
    double floor = 0;  // of the linear solver
    double value = 0;  // for the next system

    void start() { value = kind == Forcing::fixed ? floor : std::max(1e-4, floor); }
    void after_step(double step_length, double g_before, double g, double omega) {
        start();
        if (kind == Forcing::automatic && step_length >= 1) value = forcing_term(g_before, g, omega, floor);
    }
};

}  // namespace almesh
