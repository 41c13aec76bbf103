// x_0 = ideal mesh; for t = dt, 2 dt, ..., 1: x_t solves the problem at the fraction t of the motion, from x_{t - dt};
// where that fails, dt is halved, and at last the whole motion is tried at once, unless it has been.
#include "method/follow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace almesh {
namespace {

constexpr double part_turn = 90;  // degrees turned in one part
constexpr double most_at_once = 180;  // beyond, the target does not tell how it is reached
constexpr double smallest_part = 1.0 / 32;
constexpr int most_steps = 100;  // Newton steps of a subproblem that is not the last resort,
constexpr int most_followed_steps = 500;  // and of all parts

bool succeeded(const AlResult& result) {
    return result.status == AlStatus::converged || result.status == AlStatus::interrupted;
}

AugmentedLagrangianParams impatient(AugmentedLagrangianParams params) {
    params.max_newton_iterations = std::min(params.max_newton_iterations, most_steps);
    return params;
}

// Of the constraint that the last iterate of a part is on the way to.
void measure_boundary(Constraint& constraint, const std::vector<double>& x, AlIteration& row) {
    row.constraint_norm = constraint.norm(x);
    row.projected_constraint_norm = constraint.projected_norm(x);
    row.relative_boundary_error = constraint.relative_error(x);
}

// Nothing where the motion cannot be followed. x: the last iterate; failed: what came of the last part that was tried.
std::optional<AlResult> follow(const Level& level, Newton& newton, const AugmentedLagrangianParams& params, double part,
                               std::vector<double>& x, const AlObserver& observer, const StageObserver& observe_part,
                               int& earlier_steps, std::optional<AlResult>& failed) {
    std::vector<double> reached = level.ideal;
    for (double done = 0; part >= smallest_part && earlier_steps <= most_followed_steps;) {
        const double fraction = done + part < 1 - 0.5 * smallest_part ? done + part : 1;
        const bool last = fraction == 1;
        const auto constraint = last ? nullptr : level.constraint_at(fraction);
        if (!last && !constraint) return std::nullopt;
        x = reached;
        AlStart start;
        if (done > 0) start.lambda.assign(level.constraint->multipliers(), 0.0);  // not from the ideal mesh
        AlResult result = minimise(*level.energy, last ? *level.constraint : *constraint, newton,
                                   impatient(last ? params : loosened(params, level)), x,
                                   last ? observer : AlObserver{}, start);
        if (!last && observe_part)
            observe_part({level.mesh.nodes(), result.status, result.iterations.back(), result.newton_iterations,
                          fraction});
        if (!last) measure_boundary(*level.constraint, x, result.iterations.back());
        if ((succeeded(result) && last) || result.status == AlStatus::interrupted) return result;
        earlier_steps += result.newton_iterations;
        if (succeeded(result)) {
            reached = x;
            done = fraction;
        } else {
            part *= 0.5;
        }
        failed = std::move(result);
    }
    return std::nullopt;
}

}  // namespace

AugmentedLagrangianParams loosened(AugmentedLagrangianParams params, const Level& level, double of_gradient) {
    constexpr double of_constraint = 1e-3;
    const int dim = level.mesh.dim;
    const double motion = level.constraint->projected_norm(level.ideal);
    const double L = std::pow(level.energy->domain_volume(), 1.0 / dim);
    params.algorithm = Algorithm::adaptive;
    params.wall_tolerance = std::numeric_limits<double>::infinity();
    params.epsilon_star = std::max(params.epsilon_star, std::pow(of_constraint * motion, 2));
    params.omega_star = std::max(params.omega_star, of_gradient * motion * std::pow(L, dim - 2));
    return params;
}

AlResult minimise_following(const Level& level, Newton& newton, const MethodParams& params, std::vector<double>& x,
                            const AlStart& start, const AlObserver& observer, const StageObserver& observe_part) {
    const auto at_once = [&](const AugmentedLagrangianParams& schedule) {
        return minimise(*level.energy, *level.constraint, newton, schedule, x, observer, start);
    };
    if (!level.constraint_at || params.follow == Follow::never) return at_once(params.schedule);
    const std::vector<double> first = x;
    std::optional<AlResult> at_once_failed;
    std::vector<double> x_failed;
    double part = 0.5;
    int earlier_steps = 0;
    if (level.turn > part_turn && start.lambda.empty()) {
        part = 1 / std::ceil(level.turn / part_turn);
    } else {
        AlResult result = at_once(impatient(params.schedule));
        const bool hopeless = result.status == AlStatus::infeasible || result.status == AlStatus::max_iterations;
        if (succeeded(result) || hopeless) return result;
        earlier_steps = result.newton_iterations;
        if (result.status != AlStatus::max_newton_iterations) {
            at_once_failed = std::move(result);
            x_failed = x;
        }
    }
    std::optional<AlResult> failed_part;
    std::optional<AlResult> result =
        follow(level, newton, params.schedule, part, x, observer, observe_part, earlier_steps, failed_part);
    if (!result && failed_part && level.turn > most_at_once) {  // at once it would go the shorter way
        result = std::move(failed_part);
        result->status = AlStatus::stalled;
        earlier_steps -= result->newton_iterations;
    } else if (!result && at_once_failed) {  // with more steps it would end alike
        x = std::move(x_failed);
        result = std::move(at_once_failed);
        earlier_steps -= result->newton_iterations;
    } else if (!result) {  // the last resort
        x = first;
        result = at_once(params.schedule);
    }
    result->followed_newton_iterations = earlier_steps;
    return *result;
}

}  // namespace almesh
