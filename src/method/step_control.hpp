// What a step of Newton's method leaves to the next one: how well its linear system is solved, by how much its Hessian
// is damped, and how much of the negative eigenvalues it keeps.
#pragma once
#include <algorithm>
#include <cmath>

#include "energy/options.hpp"

namespace almesh {

enum class Forcing { automatic, fixed };  // fixed: always the floor

// Forcing terms of inexact Newton methods: the relative residual to which an iterative solver solves the next system.
// After a full step took |grad E| from g_before to g,
//
//     0.9 (g / g_before)^a,   a = (1 + sqrt 5)/2,
//
// so that the convergence is of order a, but not less than 0.5 omega / g, which ends the iteration (Eisenstat &
// Walker, SIAM J. Sci. Comput. 17, 1996, choice 2; Kelley, Iterative Methods for Linear and Nonlinear Equations, 1995,
// sec. 6.3). Within [floor, 1e-3]: larger terms save iterations and cost Newton steps, which are dearer; the safeguard
// of the paper is for terms above 0.1.
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
    double most = 1;   // in layers of thin cells, whose height the error of the solution must not exceed

    // Where no ratio of gradients tells how good the model is, in the first step of a subproblem and after a step that
    // was cut, 1e-4: from 1e-9 to 1e-4 the decks of the aircraft with Eq. 5 take the same numbers of steps.
    void start() { value = kind == Forcing::fixed ? floor : std::max(std::min(1e-4, most), floor); }
    void after_step(double step_length, double g_before, double g, double omega) {
        constexpr double hardly_any = 0.02, tighter = 0.01;
        if (step_length > 0 && step_length < hardly_any) most = std::max(tighter * value, floor);
        start();
        if (kind == Forcing::automatic && step_length >= 1)
            value = std::min(forcing_term(g_before, g, omega, floor), std::max(most, floor));
    }
};

// Levenberg's damping. A projected Hessian that is nearly singular, as that of (eta - 1)^2 is where the mesh has hardly
// deformed, asks for steps that invert thousands of elements, and a step length that suits them all hardly moves the
// mesh. So it is damped by
//
//     t K,   t = factor * mean_slope(),   K: stiffened elasticity (distortion_energy.hpp)
//
// which scales with the distortion like the Hessian itself. As a trust region would (Levenberg 1944; Nocedal & Wright,
// Numerical Optimization, sec. 10.3) the factor falls after a full or longer step and grows after one that was cut; it
// is kept from one subproblem to the next. The full Hessian is used undamped, once the factor is small.
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

// Eigenvalue filtering of the projected Hessian: how much of the negative eigenvalues of the Hessian of each point is
// kept (Projection::kept_negative). With all of them (1) convergence is quadratic, but far from the minimum the sum is
// indefinite. With none (0) it never is, and steps are short: a negative eigenvalue of one element is most often
// outweighed by its neighbours, and away from a saddle, where what is left of both is small, nothing leads but
// gradients. So as much is kept as the sum bears: half as much after a Hessian that gave no step or a step that was
// cut, twice as much after one that shows that the Hessian was too stiff.
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
    void filter_more() { kept = kept / 2 < least ? 0 : kept / 2; }
    void after_step(double step_length) {
        if (step_length > 1 || (step_length == 1 && after_full_steps)) kept = std::min(most, std::max(first, 2 * kept));
        if (step_length >= 1) return;
        filter_more();
        kept = std::max(least_after_cut, kept);
    }

    double most = 0.9, first = 0.2, least_after_cut = 0;
    bool after_full_steps = false;
    bool only_direct = true;  // none for iterative solvers
    static constexpr double least = 0.1;  // but for 0
};

}  // namespace almesh
