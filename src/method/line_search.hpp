// Step length t along a descent direction d.
//
// Backtracking from 1 until the sufficient-decrease (first Wolfe) condition
//     E(x + t d) <= E(x) + c1 t grad E . d,   c1 = 1e-4   (Nocedal & Wright, Alg. 3.1)
// holds. E is infinite for an element inverted at a quadrature point. If t passes this test, the whole way from x to
// x + t d must also be valid (valid_fraction): no step may pass through an inverted element to another valid mesh, and
// curved elements must be valid between their points. Else t is cut to half of the valid part. So every accepted
// iterate is a valid mesh in the homotopy class of the one before (unless the distortion is regularised, delta > 0).
//
// Lengthening. A projected Hessian can be many times stiffer than the energy along d, and its full step then stops
// far short of the minimum. Where t = 1 gives more than two thirds of what the slope promises, the parabola through
// E(x), the slope and E(x + d) is lower still at t = 2: t is doubled while that pays. An exact model gives one half:
// nothing is tried.
//
// Rounding. When the decrease that the full step promises is below the rounding error of E, energies can no longer be
// compared: the full step is taken if E stays the same to rounding. The rounding error of E is 1e-14 |E|, or the
// caller's estimate if that is larger, since terms of E may nearly cancel.
#pragma once
#include <functional>
#include <vector>

namespace almesh {

struct LineSearchResult {
    double step_length = 0;   // t; 0 where there is none
    double energy = 0;        // at x + t d
    int cuts_inverted = 0;    // trial lengths refused because an element was inverted, there or on the way
    int cuts_decrease = 0;    // trial lengths refused because E did not decrease enough
    bool by_rounding = false;  // the promised decrease is below rounding
};

// E; infinite for invalid meshes.
using EnergyFunction = std::function<double(const std::vector<double>&)>;

// How much of the step from x to x' is valid, in [0, 1]: DistortionEnergy::valid_fraction().
using StepFunction = std::function<double(const std::vector<double>& from, const std::vector<double>& to)>;

// Second-order correction: moves x + t d, given as `y`, by what is of second order in t.
using Correction = std::function<void(double t, std::vector<double>& y)>;

// energy: E(x), finite. slope: grad E . d < 0. rounding_error: of E(x), absolute. Where there is a step length x
// becomes x + t d, corrected if there is a function that does so, else it stays. trial: work space, the size of x.
LineSearchResult line_search(const EnergyFunction& E, const StepFunction& valid_fraction, double energy, double slope,
                             const std::vector<double>& d, std::vector<double>& x, std::vector<double>& trial,
                             const Correction& correct = {}, double rounding_error = 0);

}  // namespace almesh
