// Newton's method with a line search for one subproblem of the augmented Lagrangian method: minimise E(x) for given
// multipliers and penalty until |grad E| <= omega.
//
// Direction. Far from the minimum the Hessian is indefinite; each step uses one of three (HessianKind): the full one,
// whose convergence is quadratic, after a step of length one or more, the projected one after a step that was cut, and
// whenever the full one is found not to be positive definite (by Cholesky, by negative curvature, or by pivots of
// ILU(0) with any shift: no Cholesky factorisation is spent on finding out) or gives no descent direction. The Hessian
// of the objective (eta - 1)^2 vanishes at the identity, so there the very first step takes the damping alone.
// Iterative solvers need to be no more exact than the model is: forcing_term() below.
//
// Damping (Levenberg). A projected Hessian that is nearly singular, as that of (eta - 1)^2 is where the mesh has hardly
// deformed, asks for steps that invert thousands of elements, and a step length that suits them all hardly moves the
// mesh. So the projected Hessian is damped by t times a Hessian that knows about element sizes (distortion_energy.hpp),
// t = damping x root mean square of the density: 0.2 times as large after a full or longer step, 4 times after one that
// was cut. The full Hessian, undamped, is used once the damping is 0.1 or less.
//
// Step length: line_search.hpp. Where it tells that energies can no longer be compared, the iteration ends as
// `rounding_floor` when a step does not halve |grad E|.
//
// Pockets. A subproblem that takes more than ten steps has places where a few nodes hold up all others: from then on,
// and in the following subproblems, each step is followed by a local minimisation over them (pockets.hpp).
//
// Out of reach. Without multipliers a mesh that meets the target has the energy of its distortion alone, which is not
// less than the minimum of E. Where that minimum is above `largest_energy` and nine tenths of it are penalty, only
// meshes of no use could meet the target, if any: the iteration ends as soon as full steps have found the minimum to
// 0.1 %.
#pragma once
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "base/stopwatch.hpp"
#include "method/augmented_functional.hpp"
#include "linalg/linear_solver.hpp"

namespace almesh {

// Tolerance of iterative linear solvers: chosen from step to step, or always the given one.
enum class Forcing { automatic, fixed };

enum class NewtonStatus {
    converged,
    rounding_floor,
    max_iterations,
    line_search_failed,
    linear_solver_failed,
    interrupted,
    out_of_reach  // of the target, without multipliers: see above
};
const char* to_string(NewtonStatus status);
const char* to_string(HessianKind kind);

struct NewtonParams {
    double omega = 1e-8;           // tolerance of |grad E| ...
    double wanted_reduction = 1;   // ... if less than 1: lowered to this part of |grad E| at the start, for a step to
                                   // be made,
    double omega_star = 0;         // ... but not below this
    int max_iterations = 200;
    // See `Out of reach`; only for E without multipliers.
    double largest_energy = std::numeric_limits<double>::infinity();
    HessianKind first = HessianKind::projected;  // of the first step
};

// One row of the history: the step that led from one iterate to the next.
struct NewtonStep {
    int iteration = 0;         // 1, 2, ...
    double energy = 0;         // after the step
    double gradient_norm = 0;  // after the step
    double step_length = 0;    // t, see line_search.hpp
    int cuts_inverted = 0;     // trial lengths refused because an element was inverted
    int cuts_decrease = 0;     // trial lengths refused because E did not decrease enough
    HessianKind hessian = HessianKind::projected;
    int pocket_nodes = 0, pocket_steps = 0;  // of the local minimisation after the step
    int linear_iterations = 0;
    SolverKind solver = SolverKind::automatic;  // who made the direction
    double shift = 0;                           // of the diagonal in ILU(0), see SolveResult
    std::optional<SolveStatus> fallback;        // how an iterative solver failed before Cholesky took over
};

struct NewtonResult {
    NewtonStatus status = NewtonStatus::converged;
    int iterations = 0;
    int linear_iterations = 0;
    int pocket_steps = 0;
    double energy = 0, gradient_norm = 0;
    double omega = 0;  // the tolerance that was used
};

using NewtonObserver = std::function<void(const NewtonStep&)>;
using SystemObserver = std::function<void(const BlockCsr& A, const std::vector<double>& b)>;

// Relative residual to which the next system is solved after a full step took the gradient norm from g_before to g:
// 0.9 (g / g_before)^a, a = (1 + sqrt 5)/2, so that the convergence is of order a, but not less than 0.5 omega / g,
// which ends the iteration (Eisenstat & Walker, SIAM J. Sci. Comput. 17, 1996, choice 2; Kelley, Iterative Methods for
// Linear and Nonlinear Equations, 1995, section 6.3). Within [floor, largest_forcing]: larger terms save iterations and
// cost Newton steps, which are dearer; the safeguard of the paper is for terms above 0.1.
inline constexpr double largest_forcing = 1e-3;
double forcing_term(double g_before, double g, double omega, double floor);

class Newton {
public:
    // The pattern of the Hessian, the linear solver and all work arrays are set up once for all subproblems.
    Newton(const DistortionEnergy& distortion, const LinearSolverParams& linear, Forcing forcing = Forcing::automatic);

    // Called with every linear system A d = b before it is solved.
    void observe_systems(SystemObserver observer) { observe_system_ = std::move(observer); }

    const LinearSolver& linear_solver() const { return solver_; }

    // x: node_count x dim; enters with finite energy, leaves as the last accepted iterate.
    NewtonResult minimise(const AugmentedFunctional& E, const NewtonParams& params, std::vector<double>& x,
                          Timings& time, const NewtonObserver& observe);

private:
    BlockCsr H_;
    LinearSolver solver_;
    Forcing forcing_;
    double linear_tolerance_;  // of the deck: what `fixed` uses, and the floor of `automatic`
    std::vector<double> g_, minus_g_, d_, trial_;
    bool relaxes_ = false;  // pockets after each step; kept like the damping
    double damping_ = 0.1;  // relative to the root mean square of the density; kept from one subproblem to the next
    SystemObserver observe_system_;

    bool find_direction(const AugmentedFunctional& E, const std::vector<double>& x, double energy, NewtonStep& step,
                        Timings& time);
    NewtonStatus take_step(const AugmentedFunctional& E, std::vector<double>& x, double& energy, NewtonStep& step,
                           bool& by_rounding, Timings& time);
    void relax(const AugmentedFunctional& E, double gained, std::vector<double>& x, double& energy, NewtonStep& step,
               Timings& time);
};

}  // namespace almesh
