// x_0 = ideal mesh; for t = dt, 2 dt, ..., 1: x_t solves the problem at the fraction t of the motion, from x_{t - dt};
// a resumed run begins at the fraction that it had reached. If an increment fails, dt is halved; if that does not help,
// the whole motion is tried at once, unless it has been, and at last from a mesh with the boundary at its target.
#include "method/continuation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "method/set_boundary.hpp"

namespace almesh {
namespace {

constexpr double increment_turn = 90;  // degrees turned in one increment
constexpr double most_at_once = 180;  // beyond, the direction of the turn is ambiguous
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

// The ways to the target that are tried one after the other, until one succeeds. x: always the last iterate.
struct Ways {
    const Level& level;
    Newton& newton;
    const MethodParams& method;
    std::vector<double>& x;
    const AlObserver& observer;
    const StageObserver& observe_stage;
    Standing& standing = *method.standing;
    int steps = 0;  // of Newton's method, on all of them

    AlResult solve(Constraint& constraint, const AugmentedLagrangianParams& schedule, const AlStart& start,
                   const AlObserver& observe) {
        AlResult result = minimise(*level.energy, constraint, newton, schedule, x, observe, start);
        steps += result.newton_iterations;
        return result;
    }

    void stand_at_whole_motion() {
        standing.fraction = 1;
        standing.x.clear();
    }

    AlResult at_once(const AugmentedLagrangianParams& schedule, const AlStart& start) {
        stand_at_whole_motion();
        return solve(*level.constraint, schedule, start, observer);
    }

    // From a mesh with the boundary set on its target in so many increments; nothing where that does not succeed.
    std::optional<AlResult> from_target(int increments) {
        stand_at_whole_motion();
        if (method.is_start || level.turn > most_at_once || level.energy->delta() > 0) return std::nullopt;
        MethodParams params = method;
        params.schedule = impatient(params.schedule);
        x = level.ideal;
        AlResult result = minimise_with_boundary_set(level, newton, params, increments, x);
        steps += result.newton_iterations;
        if (result.status == Status::converged)
            result = solve(*level.constraint, params.schedule, AlStart::from_near(*level.constraint), observer);
        return succeeded(result) ? std::optional(std::move(result)) : std::nullopt;
    }

    // From x, where the increments up to `from` have led, with this start. last: of those that were tried. Whether they
    // end with the whole motion, or interrupted.
    bool in_increments(double from, double size, const AlStart& first, std::optional<AlResult>& last) {
        std::vector<double> reached = x;
        bool ended = false;
        climb(from, 1, size, least_increment, [&](const Increment& at) {
            standing.fraction = at.from;
            standing.x = at.is_last ? std::vector<double>() : reached;
            if (at.from > from) standing.lambda.clear(), standing.mu = 0;
            if (steps > most_steps_of_all) return StageEnd::over;
            const auto part = at.is_last ? nullptr : level.constraint_at(at.to);
            if (!at.is_last && !part) return StageEnd::over;
            x = reached;
            const AlStart start = at.from > from ? AlStart::from_near(*level.constraint) : first;
            last = part ? solve(*part, impatient(loosened(method.schedule, level)), start, {})
                        : solve(*level.constraint, impatient(method.schedule), start, observer);
            AlIteration& row = last->iterations.back();
            if (part && observe_stage)
                observe_stage({level.mesh.nodes(), last->status, row, last->newton_iterations, at.to});
            if (part) measure(*level.energy, *level.constraint, x, last->distortion, row);
            if (!succeeded(*last)) return StageEnd::failed;
            ended = at.is_last || last->status == Status::interrupted;
            reached = x;
            return ended ? StageEnd::over : StageEnd::solved;
        });
        return ended;
    }

    AlResult run(const AlStart& start) {
        if (!level.constraint_at || method.continuation == Continuation::never) return at_once(method.schedule, start);
        const std::vector<double> first = x;
        std::vector<double> x_failed;
        std::optional<AlResult> at_once_failed, last;
        const bool turns_far = level.turn > increment_turn;
        const bool in_parts = method.goes_on ? standing.fraction < 1 : turns_far && start.lambda.empty();
        const bool goes_on = method.goes_on && in_parts;
        if (!in_parts) {
            AlResult result = at_once(impatient(method.schedule), start);
            const bool stalls_at_once = result.iterations.back().newton_status == Status::stalled;
            const bool hopeless = (method.is_start && stalls_at_once) || result.status == Status::max_al_iterations;
            if (succeeded(result) || hopeless) return result;
            if (result.status != Status::max_newton_iterations) {
                at_once_failed = std::move(result);
                x_failed = x;
                if (auto found = from_target(1)) return std::move(*found);  // the cheapest where it is valid
            }
        }
        const double size = in_parts && turns_far ? 1 / std::ceil(level.turn / increment_turn) : 0.5;
        if (!goes_on) x = level.ideal, standing.lambda.clear(), standing.mu = 0;
        const bool ended = in_increments(goes_on ? standing.fraction : 0, size, goes_on ? start : AlStart(), last);
        AlResult result;
        if (ended || (last && level.turn > most_at_once)) {  // at once, it would turn the shorter way
            result = std::move(*last);
            if (!ended) result.status = Status::stalled;
        } else if (at_once_failed) {  // more steps would not help
            x = std::move(x_failed);
            result = std::move(*at_once_failed);
        } else {  // the last resort but one
            x = first;
            result = at_once(method.schedule, start);
        }
        if (succeeded(result)) return result;
        x_failed = x;
        for (const int increments : {1, 10})
            if (auto found = from_target(increments)) return std::move(*found);
        x = std::move(x_failed);
        return result;
    }
};

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
    Ways ways{level, newton, params, x, observer, observe_stage};
    AlResult result = ways.run(start);
    result.earlier_newton_iterations = ways.steps - result.newton_iterations;
    return result;
}

}  // namespace almesh
