#include "method/set_boundary.hpp"

#include <cmath>
#include <limits>

#include "base/interrupt.hpp"
#include "constraint/sliding_nodes.hpp"
#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"

namespace almesh {
namespace {

constexpr double least_part = 1.0 / 64;  // of an increment
constexpr double of_gradient = 0.03;     // tolerance of increments before the last, relative to their motion

// x with the boundary nodes at `targets`: x itself where they are there, else the first valid one of: moved inside as
// an elastic solid, not moved there; empty where neither is valid.
std::vector<double> valid_start(const Level& level, const AugmentedFunctional& E, Newton& newton,
                                const std::vector<double>& targets, const std::vector<double>& x, int& solves) {
    const std::vector<double> set = level.with_boundary(targets, x);
    if (set == x) return level.is_valid(x) ? x : std::vector<double>();
    std::vector<double> moved = set;
    ++solves;
    const AugmentedFunctional of_all_nodes(E.distortion, E.constraint, E.lambda);
    if (newton.predict(of_all_nodes, HessianKind::damping, E.fixed, x, moved) && level.is_valid(moved)) return moved;
    return level.is_valid(set) ? set : std::vector<double>();
}

}  // namespace

std::vector<double> targets_at(const Level& level, double fraction) {
    std::vector<double> targets = level.constraint->targets(level.ideal);
    if (fraction == 1) return targets;
    if (const auto part = level.constraint_at ? level.constraint_at(fraction) : nullptr)
        return part->targets(level.ideal);
    const int dim = level.mesh.dim;
    const std::vector<int>& nodes = level.constraint->nodes();
    for (int t = 0; t < static_cast<int>(nodes.size()); ++t) {
        const Vec<3> from = at_node(level.ideal, nodes[t], dim);
        set_node(targets, t, dim, from + fraction * (at_node(targets, t, dim) - from));
    }
    return targets;
}

AlResult minimise_with_boundary_set(const Level& level, Newton& newton, const MethodParams& params, int increments,
                                    std::vector<double>& x, const AlObserver& observer) {
    const Stopwatch watch;
    const AugmentedLagrangianParams& schedule = params.schedule;
    const std::vector<double> lambda(level.constraint->multipliers(), 0.0);
    const AugmentedFunctional E(*level.energy, *level.constraint, lambda, 0, level.on_boundary());
    AlResult result;
    const auto add_row = [&](const AlIteration& row) {
        result.iterations.push_back(row);
        if (observer.iteration) observer.iteration(row);
    };
    add_row(measured(*level.energy, *level.constraint, x, result.distortion));
    NewtonParams wanted;
    wanted.max_iterations = schedule.max_newton_iterations;
    NewtonResult solved;  // of the last increment
    const double size = 1.0 / increments;
    climb(0, 1, size, increments > 1 ? least_part * size : size, [&](const Increment& at) {
        wanted.omega = at.is_last ? schedule.omega_star : loosened(schedule, level, of_gradient * at.size).omega_star;
        const std::vector<double> start =
            valid_start(level, E, newton, targets_at(level, at.to), x, result.newton_iterations);
        result.status = interrupted() ? Status::interrupted : Status::invalid_start;
        if (start.empty()) return increments > 1 && !interrupted() ? StageEnd::failed : StageEnd::over;
        x = start;
        solved = newton.minimise(E, wanted, x, [&](const NewtonStep& step) {
            if (at.is_last && observer.newton_step) observer.newton_step(1, step);
        });
        add_counts(solved, result);
        result.status = interrupted() ? Status::interrupted : status_of(solved, schedule.omega0);
        return result.status == Status::converged && !at.is_last ? StageEnd::solved : StageEnd::over;
    });
    AlIteration row = measured(*level.energy, *level.constraint, x, result.distortion);
    row.iteration = 1;
    row.energy = level.energy->energy(x);
    const std::vector<double> gradient = std::isfinite(row.energy) ? E.gradient(x) : std::vector<double>();
    row.gradient_norm = norm_2(gradient);
    row.omega = wanted.omega;
    row.epsilon = std::numeric_limits<double>::infinity();
    row.newton_iterations = result.newton_iterations;
    row.newton_status = solved.status;
    row.seconds = watch.seconds();
    add_row(row);
    if (result.status != Status::converged) result.gradient = gradient;
    result.lambda = lambda;
    newton.time.total += watch.seconds();
    return result;
}

}  // namespace almesh
