// The augmented Lagrangian method (paper, Algorithm 1): a sequence of subproblems min E_{lambda, mu}, between which
// either the multipliers lambda or the penalty mu are updated, until the boundary constraint holds.
//
// Three schedules:
//   paper     Algorithm 1 in the only consistent reading: penalty weight mu in E to match the update
//             lambda - mu c_D, tolerances that tighten as m grows, and both tests must hold at the end
//             (Nocedal & Wright, Alg. 17.4).
//   literal   Algorithm 1 exactly as printed (penalty weight mu^2, the loop ends when one test holds, eps and omega
//             grow with m), for teaching: the README tells what goes wrong.
//   adaptive  lambda after every subproblem; mu, large from the start, times 10 whenever |c_D| fell by less than a
//             factor 10; omega a tenth, and omega* once the constraint holds. Needs no mu0, omega0, epsilon0.
//
// The penalty is given in units of |1|^2: mu |c_D|^2 = (mu / |1|^2) times the weighted integral of |phi - g_D|^2, and
// with the weight 1/h that integral scales like the distortion term, whatever the unit of length and the number of
// boundary faces. All lengths are in the unit the caller has chosen for x; see length_scale in the table of deck keys.
#pragma once
#include <functional>
#include <vector>

#include "method/newton.hpp"

namespace almesh {

enum class Algorithm { adaptive, paper, literal };

struct AugmentedLagrangianParams {
    Algorithm algorithm = Algorithm::adaptive;
    double mu0 = 1000;            // paper, literal: first penalty, in units of |1|^2
    double omega0 = 1e-2;         // paper, literal: tolerance of |grad E| in the first subproblem
    double epsilon0 = 1e-3;       // paper, literal: tolerance of |P c_D|^2 that decides between the updates
    double omega_star = 1e-8;     // final tolerance of |grad E|
    double epsilon_star = 1e-16;  // final tolerance of |P c_D|^2
    int max_iterations = 50;
    int max_newton_iterations = 200;
};

enum class AlStatus {
    converged,
    max_iterations,
    infeasible,        // no valid mesh seems to reach the target: the constraint stopped falling while the penalty
                       // grew, or the first minimum is out of reach (newton.hpp)
    rounding_floor,    // the constraint holds, but rounding ended |grad E| above omega0 (a penalty beyond all measure)
    ended_as_printed,  // literal: the loop as printed ends when one of its two tests holds, and only one did
    max_newton_iterations,
    line_search_failed,
    linear_solver_failed,
    interrupted  // by a signal
};
const char* to_string(AlStatus status);

enum class AlUpdate { none, multipliers, penalty, both };
const char* to_string(AlUpdate update);

// One row of the history; row 0 is the mesh at the start.
struct AlIteration {
    int iteration = 0;
    double constraint_norm = 0;            // |c_D|
    double projected_constraint_norm = 0;  // |P c_D|
    double energy = 0, gradient_norm = 0;
    double mu = 0, omega = 0, epsilon = 0;  // used in this iteration; omega: the tolerance of the subproblem
    double relative_quality = 0, max_distortion = 0;
    int newton_iterations = 0;
    NewtonStatus newton_status = NewtonStatus::converged;
    AlUpdate update = AlUpdate::none;  // decided after this iteration
    double seconds = 0;
};

struct AlResult {
    AlStatus status = AlStatus::converged;
    std::vector<AlIteration> iterations;
    DistortionStatistics distortion;  // of the last iterate
    std::vector<double> lambda;       // trace nodes x dim
    int newton_iterations = 0, linear_iterations = 0, pocket_steps = 0;
};

struct AlObserver {
    std::function<void(const AlIteration&)> iteration;
    std::function<void(int al_iteration, const NewtonStep&)> newton_step;
};

// Where the method starts: by default without knowledge, else from what a run on a coarser mesh has found.
struct AlStart {
    std::vector<double> lambda;  // trace nodes x dim; empty: zero
    double mu = 0;               // in units of |1|^2; 0: that of the schedule
};

// x: node_count x dim, a valid mesh on entry (the identity map or a better guess), the last accepted iterate on return.
AlResult minimise(const DistortionEnergy& distortion, const BoundaryConstraint& constraint, Newton& newton,
                  const AugmentedLagrangianParams& params, std::vector<double>& x, Timings& time,
                  const AlObserver& observer, const AlStart& start = {});

}  // namespace almesh
