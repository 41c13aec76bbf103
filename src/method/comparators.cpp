// x = ideal mesh; for t = 1/n, 2/n, ..., 1: the boundary to its position at the fraction t of the motion, and the
// method's own rule for the nodes inside, until a part fails.
#include "method/comparators.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/interrupt.hpp"
#include "linalg/vector_ops.hpp"
#include "method/checkpoint.hpp"
#include "method/functional.hpp"
#include "method/linear_extension.hpp"

namespace almesh {
namespace {

constexpr double least_part = 1.0 / 64;  // of an increment
constexpr double of_gradient = 0.03;     // tolerance of increments before the last, relative to their motion

// One run of such a method, as its parts see it.
struct BoundaryMove {
    const Level& level;
    Newton& newton;
    const MethodParams& params;
    LinearExtension extension;
    std::vector<char> fixed;  // per node: whether it is on the boundary
    double omega = 0;         // tolerance of |grad E| inside, for Newton's method
    std::function<void(const NewtonStep&)> observe_step = {};

    BoundaryMove(const Level& level_, Newton& newton_, const MethodParams& params_)
        : level(level_), newton(newton_), params(params_),
          extension(level_.mesh, level_.energy->hessian_pattern(), params_.linear), fixed(level_.on_boundary()) {}

    // For a load increment; the Newton steps of the last one are observed, those of others loosely converged.
    void prepare(bool last, double part, const AlObserver& observer) {
        const AugmentedLagrangianParams& schedule = params.schedule;
        omega = last ? schedule.omega_star : loosened(schedule, level, of_gradient * part).omega_star;
        observe_step = {};
        if (last && observer.newton_step) observe_step = [&](const NewtonStep& step) { observer.newton_step(1, step); };
    }

    // x with the boundary nodes at `targets` and the displacement extended inside; counts its solve in `steps`, whose
    // status tells where it failed: the nodes inside then stay.
    std::vector<double> extended(StiffnessAt stiffness, const std::vector<double>& targets,
                                 const std::vector<double>& x, NewtonResult& steps) {
        std::vector<double> moved = level.with_boundary(targets, x), u(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) u[i] = moved[i] - x[i];
        const TimeAdder adder(newton.time.linear);
        const SolveResult solved = extension.extend(stiffness, x, fixed, u);
        ++steps.iterations;
        steps.linear_iterations += solved.iterations;
        if (solved.status != SolveStatus::success) {
            steps.status = Status::linear_solver_failed;
            return moved;
        }
        for (std::size_t i = 0; i < x.size(); ++i)
            if (!fixed[i / level.mesh.dim]) moved[i] = x[i] + u[i];
        return moved;
    }

    // Elements that are inverted at a quadrature point.
    int inverted(const std::vector<double>& x) const {
        const std::vector<double> largest = level.energy->statistics(x).element_max;
        const auto infinite = [](double eta) { return !std::isfinite(eta); };
        return static_cast<int>(std::count_if(largest.begin(), largest.end(), infinite));
    }

    // The first valid mesh with the boundary at `targets` of: x with the displacement extended by elasticity, as a
    // harmonic function, not at all; where none is, the one of them with the fewest inverted elements.
    std::vector<double> best_start(const std::vector<double>& targets, const std::vector<double>& x,
                                   NewtonResult& steps) {
        std::vector<double> best;
        for (const StiffnessAt stiffness : {elastic_stiffness, harmonic_stiffness, StiffnessAt()}) {
            std::vector<double> start =
                stiffness ? extended(stiffness, targets, x, steps) : level.with_boundary(targets, x);
            if (level.is_valid(start)) return start;
            if (best.empty() || inverted(start) < inverted(best)) best = std::move(start);
        }
        return best;
    }

    // The distortion, the boundary fixed.
    AugmentedFunctional functional() const {
        return {*level.energy, *level.constraint, std::vector<double>(level.constraint->multipliers(), 0.0), 0, fixed};
    }

    // Newton's method on it, from x; adds to what `sum` counts.
    void minimise(const NewtonParams& wanted, std::vector<double>& x, NewtonResult& sum) {
        NewtonResult solved =
            minimise_or_recall(params.schedule.checkpoint, newton, functional(), wanted, x, observe_step);
        solved.iterations += sum.iterations;
        solved.linear_iterations += sum.linear_iterations;
        solved.local_steps += sum.local_steps;
        sum = solved;
    }
};

// What came of one load increment; `solved` counts all its Newton steps and linear solves.
struct PartResult {
    Status status = Status::converged;
    NewtonResult solved = {};
};

// Takes the boundary of x to `targets`.
using Rule = PartResult (*)(BoundaryMove&, const std::vector<double>& targets, std::vector<double>& x);

template <StiffnessAt stiffness>
PartResult extend(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x) {
    PartResult result;
    x = move.extended(stiffness, targets, x, result.solved);
    if (result.solved.status != Status::converged) result.status = Status::linear_solver_failed;
    else if (!move.level.is_valid(x)) result.status = Status::inverted;
    return result;
}

// As Algorithm 1 has it: an attainable accuracy up to omega0 counts as converged.
Status status_of(const NewtonResult& solved, double omega0) {
    return at_floor(solved.status) && solved.gradient_norm <= omega0 ? Status::converged : solved.status;
}

// Newton's method to the tolerance omega, from x, which is valid.
void minimise_with_boundary_fixed(BoundaryMove& move, std::vector<double>& x, PartResult& result) {
    NewtonParams wanted;
    wanted.omega = move.omega;
    wanted.max_iterations = move.params.schedule.max_newton_iterations;
    move.minimise(wanted, x, result.solved);
    result.status = status_of(result.solved, move.params.schedule.omega0);
}

// Where no start is valid there is nothing to minimise, since the energy is infinite: x is the one of them with the
// fewest inverted elements.
PartResult minimise_inside(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x) {
    PartResult result;
    x = move.best_start(targets, x, result.solved);
    if (move.level.is_valid(x)) minimise_with_boundary_fixed(move, x, result);
    else result.status = Status::invalid_start;
    return result;
}

// A part whose start is inverted is halved, and where that does not help either the run ends with the last valid mesh
// (the paper's references 3, 13 and 23 proceed so).
PartResult minimise_or_stay(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x) {
    std::vector<double> moved = x;
    const PartResult result = minimise_inside(move, targets, moved);
    if (result.status != Status::invalid_start) x = std::move(moved);
    return result;
}

// The distortion is minimised with the regularised determinant sigma_delta of Eq. 3, which is positive for inverted
// elements too (Escobar and others, Comput. Methods Appl. Mech. Eng. 192, 2003), for delta = 0.3, 0.1, 0.03, ..., until
// the mesh is valid; then without regularisation. det F has no unit, and is 1 in an element that keeps its size. Where
// the mesh is not valid with the least delta, it stays inverted. From 1 on an aircraft that has pitched takes many
// times as long, from 0.1 on a plate that has turned by 180 degrees stays inverted.
PartResult untangle(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x) {
    constexpr double first_delta = 0.3, least_delta = 1e-6;
    constexpr int steps_of_delta = 30;  // Newton steps for one delta
    PartResult result;
    x = move.best_start(targets, x, result.solved);
    DistortionEnergy& distortion = *move.level.energy;
    for (double delta = first_delta; delta >= least_delta && !move.level.is_valid(x) && !interrupted(); delta /= 3) {
        distortion.set_delta(delta);
        NewtonParams newton;
        newton.max_iterations = steps_of_delta;
        newton.reduction = 0.01;
        newton.omega_star = move.params.schedule.omega_star;
        move.minimise(newton, x, result.solved);
        distortion.set_delta(0);
    }
    if (move.level.is_valid(x)) minimise_with_boundary_fixed(move, x, result);
    else result.status = interrupted() ? Status::interrupted : Status::inverted;
    return result;
}

Rule rule_of(MovingMethod method) {
    switch (method) {
        case MovingMethod::harmonic: return extend<harmonic_stiffness>;
        case MovingMethod::elasticity: return extend<elastic_stiffness>;
        case MovingMethod::incremental: return minimise_or_stay;
        case MovingMethod::untangle: return untangle;
        default: return minimise_inside;
    }
}

// Of the constraint's nodes at a fraction of the motion. Where the motions of boundaries that share nodes do not agree
// there, on the straight way.
std::vector<double> targets_at(const Level& level, double fraction) {
    std::vector<double> targets = level.constraint->targets(level.ideal);
    if (fraction == 1) return targets;
    if (const auto part = level.constraint_at ? level.constraint_at(fraction) : nullptr)
        return part->targets(level.ideal);
    const int dim = level.mesh.dim;
    const std::vector<int>& nodes = level.constraint->nodes();
    for (std::size_t t = 0; t < nodes.size(); ++t)
        for (int a = 0; a < dim; ++a) {
            const double from = level.ideal[offset(nodes[t], dim, a)];
            targets[offset(t, dim, a)] = from + fraction * (targets[offset(t, dim, a)] - from);
        }
    return targets;
}

// Of E over the nodes inside; empty where the mesh is not valid.
std::vector<double> gradient(const BoundaryMove& move, const std::vector<double>& x) {
    return move.level.is_valid(x) ? move.functional().gradient(x) : std::vector<double>();
}

// The row of a part that ended at x.
AlIteration row_of(const BoundaryMove& move, const PartResult& part, const std::vector<double>& x,
                   DistortionStatistics& statistics) {
    AlIteration row = measured(*move.level.energy, *move.level.constraint, x, statistics);
    row.iteration = 1;
    row.energy = move.level.energy->energy(x);
    if (const std::vector<double> g = gradient(move, x); !g.empty()) row.gradient_norm = norm_2(g);
    row.omega = move.omega;
    row.epsilon = std::numeric_limits<double>::infinity();
    row.newton_iterations = part.solved.iterations;
    row.newton_status = part.solved.status;
    return row;
}

}  // namespace

bool sets_boundary(MovingMethod method) {
    return method != MovingMethod::augmented_lagrangian && method != MovingMethod::penalty;
}

AlResult move_with_boundary(const Level& level, Newton& newton, const MethodParams& params, int increments,
                            std::vector<double>& x, const AlObserver& observer, const StageObserver& observe_stage) {
    const Stopwatch watch;
    const Rule rule = rule_of(params.schedule.moving);
    const bool may_halve = params.schedule.moving == MovingMethod::incremental;
    AlResult result;
    BoundaryMove move(level, newton, params);
    const auto add_row = [&](const AlIteration& row) {
        result.iterations.push_back(row);
        if (observer.iteration) observer.iteration(row);
    };
    add_row(measured(*level.energy, *level.constraint, x, result.distortion));
    const double size = 1.0 / increments;
    PartResult made;
    increase_load(size, may_halve ? least_part * size : size, [&](const Increment& at) {
        const Stopwatch part_watch;
        move.prepare(at.is_last(), at.size, observer);
        made = rule(move, targets_at(level, at.to), x);
        result.status = interrupted() ? Status::interrupted : made.status;
        add_counts(made.solved, result);
        if (may_halve && result.status == Status::invalid_start) return StageEnd::failed;
        if (at.is_last() || result.status != Status::converged) return StageEnd::over;
        AlIteration row = row_of(move, made, x, result.distortion);
        row.seconds = part_watch.seconds();
        const int steps = made.solved.iterations;
        if (observe_stage) observe_stage({level.mesh.nodes(), result.status, row, steps, at.to});
        result.earlier_newton_iterations += steps;
        return StageEnd::solved;
    });
    AlIteration row = row_of(move, made, x, result.distortion);
    row.seconds = watch.seconds();
    add_row(row);
    result.newton_iterations -= result.earlier_newton_iterations;
    if (result.status != Status::converged) result.gradient = gradient(move, x);
    result.lambda.assign(level.constraint->multipliers(), 0.0);
    newton.time.total += watch.seconds();
    return result;
}

}  // namespace almesh
