// The augmented Lagrangian method (paper, Algorithm 1): a sequence of subproblems min E_{lambda, mu}, between which
// either the multipliers lambda or the penalty mu are updated (schedule.hpp), until the boundary constraint holds.
#pragma once
#include <functional>
#include <vector>

#include "constraint/constraint.hpp"
#include "energy/distortion_energy.hpp"
#include "method/newton.hpp"
#include "method/schedule.hpp"

namespace almesh {

// One row of the history; row 0 is the mesh at the start.
struct AlIteration {
    int iteration = 0;
    double constraint_norm = 0;            // |c_D|
    double projected_constraint_norm = 0;  // |P c_D|
    double relative_boundary_error = 0;    // Constraint::relative_error()
    double energy = 0, gradient_norm = 0;
    double mu = 0, omega = 0, epsilon = 0;  // used in this iteration; omega: the tolerance of the subproblem
    double relative_quality = 0, max_distortion = 0;
    int newton_iterations = 0;
    Status newton_status = Status::converged;
    AlUpdate update = AlUpdate::none;  // after this iteration; none where it failed
    double seconds = 0;
};

struct AlResult {
    Status status = Status::converged;
    std::vector<AlIteration> iterations;
    DistortionStatistics distortion;  // of the last iterate
    std::vector<double> lambda;       // after its last update
    std::vector<double> gradient;     // of E at the last iterate, nodes x dim; empty where it converged
    int newton_iterations = 0, linear_iterations = 0, local_steps = 0;
    int earlier_newton_iterations = 0;  // of earlier load increments and given-up attempts (continuation.hpp)
};

// The status for reports: no_visible_gain if the run counts as converged because its last steps hardly decreased E,
// although |grad E| is still above omega_star.
inline Status outcome(const AlResult& al) {
    const bool settled = !al.iterations.empty() && al.iterations.back().newton_status == Status::no_visible_gain;
    return settled && al.status == Status::converged ? Status::no_visible_gain : al.status;
}

// Of a minimisation without multipliers: an attainable accuracy up to omega0 counts as converged.
inline Status status_of(const NewtonResult& solved, double omega0) {
    return at_floor(solved.status) && solved.gradient_norm <= omega0 ? Status::converged : solved.status;
}

struct AlObserver {
    std::function<void(const AlIteration&)> iteration;
    std::function<void(int al_iteration, const NewtonStep&)> newton_step;
    // Called after every iteration, for the next subproblem. mu: in units of |1|^2.
    std::function<void(const std::vector<double>& lambda, double mu)> multipliers = {};
};

// Initial multipliers and penalty: by default zero and the schedule's, else those of a coarser mesh.
struct AlStart {
    std::vector<double> lambda;  // empty: zero
    double mu = 0;               // in units of |1|^2; 0: that of the schedule
    bool from_coarser = false;   // whether x is the solution of a coarser mesh or a lower degree, interpolated

    // Near the solution: lambda = 0, but not empty, so this is no cold start.
    static AlStart from_near(const Constraint& constraint, double mu = 0) {
        return {std::vector<double>(constraint.multipliers(), 0.0), mu};
    }
};

void add_counts(const NewtonResult& solved, AlResult& result);

// Sets the entries of a row that depend on x alone: constraint norms and distortion.
void measure(DistortionEnergy& distortion, Constraint& constraint, const std::vector<double>& x,
             DistortionStatistics& statistics, AlIteration& row);

// The row of the mesh at x, before any minimisation.
AlIteration measured(DistortionEnergy& distortion, Constraint& constraint, const std::vector<double>& x,
                     DistortionStatistics& statistics);

// x: node_count x dim, a valid mesh on entry (the identity map or a better guess), the last accepted iterate on return.
// Adds to newton.time.
AlResult minimise(DistortionEnergy& distortion, Constraint& constraint, Newton& newton,
                  const AugmentedLagrangianParams& params, std::vector<double>& x, const AlObserver& observer = {},
                  const AlStart& start = {});

}  // namespace almesh
