// x_0 = ideal mesh; for t = dt, 2 dt, ..., 1: x_t solves the problem at the fraction t of the motion, from x_{t - dt};
// a run that goes on begins at the fraction where it stood. Where an increment fails, dt is halved, and the whole motion
// is tried at once, unless it has been; at last, from a mesh with the boundary at its target.
#include "method/continuation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "method/set_boundary.hpp"

namespace almesh {
namespace {

constexpr double increment_turn = 90;  // degrees turned in one increment
constexpr double most_at_once = 180;  // beyond, the target does not tell how it is reached
constexpr double least_increment = 1.0 / 32;
constexpr int most_steps = 100;  // Newton steps of a subproblem that is not the last resort,
constexpr int most_steps_of_all = 500;  // and of all increments

bool succeeded(const AlResult& result) {
    return result.status == Status::converged || result.status == Status::interrupted;
}

AugmentedLagrangianParams impatient(AugmentedLagrangianParams params) {
    params.max_newton_iterations = std::min(params.max_newton_iterations, most_steps);
    return params;
}

struct Increments {
    std::optional<AlResult> last;  // of those that were tried
    bool ended = false;            // with the whole motion, or interrupted
    int steps = 0;                 // all Newton steps
};

// From x, where the increments up to `from` have led, and the given start. x: on return the last iterate. steps: on
// increments and attempts before.
Increments solve_increments(const Level& level, Newton& newton, const MethodParams& method, double from, double size,
                            int steps, std::vector<double>& x, const AlStart& first, const AlObserver& observer,
                            const StageObserver& observe_stage) {
    const AugmentedLagrangianParams& params = method.schedule;
    Increments all;
    all.steps = steps;
    std::vector<double> reached = x;
    increase_load(from, size, least_increment, [&](const Increment& at) {
        Standing& standing = *method.standing;
        standing.fraction = at.from;
        standing.x = at.is_last() ? std::vector<double>() : reached;
        if (at.from > from) standing.lambda.clear(), standing.mu = 0;
        if (all.steps > most_steps_of_all) return StageEnd::over;
        const auto constraint = at.is_last() ? nullptr : level.constraint_at(at.to);
        if (!at.is_last() && !constraint) return StageEnd::over;
        x = reached;
        const AlStart start = at.from > from ? AlStart::from_near(*level.constraint) : first;
        AlResult result =
            at.is_last()
                ? minimise(*level.energy, *level.constraint, newton, impatient(params), x, observer, start)
                : minimise(*level.energy, *constraint, newton, impatient(loosened(params, level)), x, {}, start);
        all.steps += result.newton_iterations;
        if (!at.is_last()) {
            if (observe_stage)
                observe_stage({level.mesh.nodes(), result.status, result.iterations.back(), result.newton_iterations,
                               at.to});
            measure(*level.energy, *level.constraint, x, result.distortion, result.iterations.back());
        }
        const bool solved = succeeded(result);
        all.ended = solved && (at.is_last() || result.status == Status::interrupted);
        all.last = std::move(result);
        if (all.ended) return StageEnd::over;
        if (solved) reached = x;
        return solved ? StageEnd::solved : StageEnd::failed;
    });
    return all;
}

// Algorithm 1 from a mesh with the boundary set on its target in so many increments, where it succeeds from there.
// steps: adds all Newton steps.
std::optional<AlResult> minimise_from_target(const Level& level, Newton& newton, MethodParams params, int increments,
                                             std::vector<double>& x, int& steps, const AlObserver& observer) {
    if (params.is_start || level.turn > most_at_once || level.energy->delta() > 0) return std::nullopt;
    params.schedule = impatient(params.schedule);
    x = level.ideal;
    AlResult result = minimise_with_boundary_set(level, newton, params, increments, x);
    steps += result.newton_iterations;
    if (result.status == Status::converged) {
        const AlStart start = AlStart::from_near(*level.constraint);
        result = minimise(*level.energy, *level.constraint, newton, params.schedule, x, observer, start);
        steps += result.newton_iterations;
    }
    if (!succeeded(result)) return std::nullopt;
    return result;
}

}  // namespace

bool Level::is_valid(const std::vector<double>& x) const {
    return std::isfinite(energy->energy(x)) && energy->certified(x);
}

std::vector<char> Level::on_boundary() const {
    std::vector<char> on(mesh.nodes(), 0);
    for (const int node : constraint->nodes()) on[node] = 1;
    return on;
}

std::vector<double> Level::with_boundary(const std::vector<double>& targets, std::vector<double> x) const {
    const std::vector<int>& nodes = constraint->nodes();
    for (std::size_t t = 0; t < nodes.size(); ++t)
        std::copy_n(&targets[offset(t, mesh.dim)], mesh.dim, point(x, nodes[t], mesh.dim));
    return x;
}

void increase_load(double from, double size, double least, const std::function<StageEnd(const Increment&)>& solve) {
    while (from < 1 && size >= least) {
        const double to = from + size < 1 - 0.5 * least ? from + size : 1;
        switch (solve({from, to, size})) {
            case StageEnd::solved: from = to; break;
            case StageEnd::failed: size *= 0.5; break;
            case StageEnd::over: return;
        }
    }
}

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

AlResult minimise_in_increments(const Level& level, Newton& newton, const MethodParams& params, std::vector<double>& x,
                                const AlStart& start, const AlObserver& observer,
                                const StageObserver& observe_stage) {
    Standing& standing = *params.standing;
    const double from = params.goes_on ? standing.fraction : 0;
    const auto at_once = [&](const AugmentedLagrangianParams& schedule) {
        standing.fraction = 1;
        standing.x.clear();
        return minimise(*level.energy, *level.constraint, newton, schedule, x, observer, start);
    };
    if (!level.constraint_at || params.continuation == Continuation::never) return at_once(params.schedule);
    const std::vector<double> first = x;
    std::optional<AlResult> at_once_failed;
    std::vector<double> x_failed;
    const bool turns_far = level.turn > increment_turn;
    const bool in_increments = params.goes_on ? from < 1 : turns_far && start.lambda.empty();
    const double size = in_increments && turns_far ? 1 / std::ceil(level.turn / increment_turn) : 0.5;
    int steps = 0;
    const auto with_all_steps = [&](AlResult result) {
        result.earlier_newton_iterations = steps - result.newton_iterations;
        return result;
    };
    const auto from_target = [&](int increments) {
        standing.fraction = 1;
        standing.x.clear();
        return minimise_from_target(level, newton, params, increments, x, steps, observer);
    };
    if (!in_increments) {
        AlResult result = at_once(impatient(params.schedule));
        const bool stalls_at_once = result.iterations.back().newton_status == Status::stalled;
        const bool hopeless = (params.is_start && stalls_at_once) || result.status == Status::max_al_iterations;
        if (succeeded(result) || hopeless) return result;
        steps = result.newton_iterations;
        if (result.status != Status::max_newton_iterations) {
            at_once_failed = std::move(result);
            x_failed = x;
        }
        if (at_once_failed)  // the cheapest where it is valid
            if (auto found = from_target(1)) return with_all_steps(std::move(*found));
    }
    const bool goes_on = params.goes_on && in_increments;
    if (!goes_on) x = level.ideal, standing.lambda.clear(), standing.mu = 0;
    Increments all = solve_increments(level, newton, params, goes_on ? from : 0, size, steps, x,
                                      goes_on ? start : AlStart(), observer, observe_stage);
    steps = all.steps;
    AlResult result;
    if (all.ended || (all.last && level.turn > most_at_once)) {  // at once it would go the shorter way
        result = std::move(*all.last);
        if (!all.ended) result.status = Status::stalled;
    } else if (at_once_failed) {  // with more steps it would end alike
        x = std::move(x_failed);
        result = std::move(*at_once_failed);
    } else {  // the last resort but one
        x = first;
        result = at_once(params.schedule);
        steps += result.newton_iterations;
    }
    if (!succeeded(result)) {
        std::vector<double> x_last = x;
        for (const int increments : {1, 10})
            if (auto found = from_target(increments)) return with_all_steps(std::move(*found));
        x = std::move(x_last);
    }
    return with_all_steps(std::move(result));
}

}  // namespace almesh
