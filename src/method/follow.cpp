// x_0 = ideal mesh; for t = dt, 2 dt, ..., 1: x_t solves the problem at the fraction t of the motion, from x_{t - dt};
// where that fails, dt is halved.
#include "method/follow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace almesh {
namespace {

constexpr double part_turn = 90;  // degrees turned in one part
constexpr double smallest_part = 1.0 / 32;
constexpr int most_steps = 60;  // Newton steps of a subproblem that is not the last resort

bool succeeded(const AlResult& result) {
    return result.status == AlStatus::converged || result.status == AlStatus::interrupted;
}

AugmentedLagrangianParams impatient(AugmentedLagrangianParams params) {
    params.max_newton_iterations = std::min(params.max_newton_iterations, most_steps);
    return params;
}

// One part of the motion, up to `fraction`. from_ideal: x is the ideal mesh.
AlResult solve_part(const Level& level, Newton& newton, const AugmentedLagrangianParams& params, double fraction,
                    bool from_ideal, std::vector<double>& x, const AlObserver& observer) {
    const auto constraint = fraction < 1 ? level.constraint_at(fraction) : nullptr;
    Constraint& c = constraint ? *constraint : *level.constraint;
    AlStart start;
    if (!from_ideal) start.lambda.assign(c.multipliers(), 0.0);
    return minimise(*level.energy, c, newton, impatient(fraction < 1 ? loosened(params, level) : params), x,
                    fraction < 1 ? AlObserver{} : observer, start);
}

AlResult follow(const Level& level, Newton& newton, const AugmentedLagrangianParams& params, double part,
                std::vector<double>& x, const AlObserver& observer, const StageObserver& observe_part) {
    std::vector<double> reached = level.ideal;
    double done = 0;
    int steps = 0;
    for (;;) {
        const double fraction = done + part < 1 - 0.5 * smallest_part ? done + part : 1;
        x = reached;
        AlResult result = solve_part(level, newton, params, fraction, done == 0, x, observer);
        if (fraction < 1 && observe_part)
            observe_part({level.mesh.nodes(), result.status, result.iterations.back(), result.newton_iterations,
                          fraction});
        const bool stuck = !succeeded(result) && 0.5 * part < smallest_part;
        if ((succeeded(result) && fraction == 1) || stuck || result.status == AlStatus::interrupted) {
            result.followed_newton_iterations = steps;
            return result;
        }
        steps += result.newton_iterations;
        if (!succeeded(result)) {
            part *= 0.5;
            continue;
        }
        reached = x;
        done = fraction;
    }
}

}  // namespace

AugmentedLagrangianParams loosened(AugmentedLagrangianParams params, const Level& level) {
    constexpr double of_constraint = 1e-3, of_gradient = 0.03;
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
    const bool from_ideal = start.lambda.empty();
    const bool may_follow = level.constraint_at && params.follow != Follow::never &&
                            (params.follow == Follow::always || params.schedule.algorithm == Algorithm::adaptive);
    int steps = 0;
    if (!may_follow || level.turn <= part_turn || !from_ideal) {
        AlResult direct = minimise(*level.energy, *level.constraint, newton,
                                   may_follow ? impatient(params.schedule) : params.schedule, x, observer, start);
        const bool hopeless = direct.status == AlStatus::infeasible || direct.status == AlStatus::max_iterations;
        if (succeeded(direct) || !may_follow || hopeless) return direct;
        steps = direct.newton_iterations;
    }
    const double part = 1 / std::max(std::ceil(level.turn / part_turn), steps > 0 ? 2.0 : 1.0);
    AlResult result = follow(level, newton, params.schedule, part, x, observer, observe_part);
    result.followed_newton_iterations += steps;
    return result;
}

}  // namespace almesh
