// Algorithm 1 of the paper, its lines numbered on the right; lines 4-6, 11-14 and 17-20 are the schedule's.
#include "method/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "method/functional.hpp"

namespace almesh {
namespace {

double square(double v) { return v * v; }

// The difference of two numbers that overflow is nan: it counts as infinite.
double or_infinity(double v) { return std::isnan(v) ? std::numeric_limits<double>::infinity() : v; }

// The row of iteration k, whose subproblem ended at x.
AlIteration row_of(const AugmentedFunctional& E, const std::vector<double>& x, DistortionStatistics& statistics,
                   const Schedule& s, const NewtonResult& solved, int k) {
    AlIteration row = measured(E.distortion, E.constraint, x, statistics);
    row.iteration = k;
    row.energy = or_infinity(solved.energy);
    row.gradient_norm = or_infinity(solved.gradient_norm);
    row.mu = s.mu;
    row.omega = solved.omega;
    row.epsilon = s.epsilon;
    row.newton_iterations = solved.iterations;
    row.newton_status = solved.status;
    return row;
}

// cold: x is the ideal mesh, without multipliers. by_gradient: the constraint holds and the last steps hardly decreased
// E, so that only |grad E| measures the distance from the minimum.
NewtonParams subproblem(const AugmentedLagrangianParams& params, const Schedule& s, bool cold, bool by_gradient,
                        bool from_coarser, const AugmentedFunctional& E) {
    constexpr int most_unseen_steps = 20;
    constexpr double useless_distortion = 20;  // a mesh with this distortion everywhere is useless
    constexpr double visible = 3e-7;  // decrease of E, over the difference of E for a uniform distortion of 2 and of 1,
    constexpr double visible_of_largest = 1e-3;  // or, with a power p > 2, relative decrease of the largest eta - 1
    const DistortionEnergy& distortion = E.distortion;
    NewtonParams newton;
    newton.omega = s.omega;
    newton.reduction = s.reduction;
    newton.omega_star = s.least_omega;
    newton.max_iterations = params.max_newton_iterations;
    newton.first = HessianKind::full;
    newton.cold_start = cold;
    newton.from_coarser = from_coarser;
    if (by_gradient) newton.max_iterations = std::min(newton.max_iterations, most_unseen_steps);
    if (const int p = distortion.power().p; E.constraint.corrects_steps() && !by_gradient) {
        if (p > 2) newton.visible_part = p * visible_of_largest;
        newton.visible_gain = visible * (distortion.uniform(2) - distortion.uniform(1));
    }
    if (cold && s.tests_reach()) newton.largest_energy = distortion.uniform(useless_distortion);
    return newton;
}

// Whether |P c_D| fell by at most 10 % in each of the last `updates` iterations although each had a larger penalty.
// Only for mu >= |1|^2: a smaller penalty is too weak against the distortion for stagnation to mean anything.
bool constraint_stalls(const std::vector<AlIteration>& rows, std::size_t updates, double one_squared) {
    if (rows.size() < updates + 2) return false;
    for (std::size_t k = rows.size() - updates; k < rows.size(); ++k)
        if (rows[k].mu <= rows[k - 1].mu || rows[k - 1].mu < one_squared ||
            rows[k].projected_constraint_norm < 0.9 * rows[k - 1].projected_constraint_norm)
            return false;
    return true;
}

// |grad E| <= omega*, or at its attainable accuracy and <= omega0.
bool is_stationary(const AlIteration& row, const AugmentedLagrangianParams& params) {
    if (row.gradient_norm <= params.omega_star) return true;
    return row.newton_status == Status::attainable_accuracy && row.gradient_norm <= params.omega0;
}

// The failure after the last of `rows`, or nothing if the method goes on or has converged. It fails if it stops
// although line 7 goes on, or if line 7 stops it before both of its tests hold. ends: by line 7.
std::optional<Status> failure(const std::vector<AlIteration>& rows, const AugmentedLagrangianParams& params,
                              double one_squared, bool constrained, bool stationary, bool ends) {
    if (ends && constrained && stationary) return std::nullopt;
    if (ends) return Status::ended_as_printed;
    const AlIteration& row = rows.back();
    const bool solved = at_floor(row.newton_status) || row.newton_status == Status::converged;
    if (row.newton_status == Status::attainable_accuracy && constrained) return row.newton_status;
    if (row.newton_status == Status::stalled) return Status::stalled;
    if (row.newton_status == Status::interrupted) return Status::interrupted;
    if (constraint_stalls(rows, solved ? 3 : 1, one_squared)) return Status::stalled;
    if (!solved) return row.newton_status;
    if (row.iteration == params.max_iterations) return Status::max_al_iterations;
    return std::nullopt;
}

}  // namespace

void add_counts(const NewtonResult& solved, AlResult& result) {
    result.newton_iterations += solved.iterations;
    result.linear_iterations += solved.linear_iterations;
    result.local_steps += solved.local_steps;
}

void measure(DistortionEnergy& distortion, Constraint& constraint, const std::vector<double>& x,
             DistortionStatistics& statistics, AlIteration& row) {
    row.projected_constraint_norm = constraint.projected_norm(x);
    row.constraint_norm = constraint.norm(x);
    row.relative_boundary_error = constraint.relative_error(x);
    statistics = distortion.statistics(x);
    row.relative_quality = statistics.relative_quality;
    row.max_distortion = statistics.max_distortion;
}

AlIteration measured(DistortionEnergy& distortion, Constraint& constraint, const std::vector<double>& x,
                     DistortionStatistics& statistics) {
    AlIteration row;
    row.gradient_norm = std::numeric_limits<double>::infinity();
    measure(distortion, constraint, x, statistics, row);
    return row;
}

AlResult minimise(DistortionEnergy& distortion, Constraint& constraint, Newton& newton,
                  const AugmentedLagrangianParams& params, std::vector<double>& x, const AlObserver& observer,
                  const AlStart& start) {
    const Stopwatch watch;
    AlResult result;
    std::vector<AlIteration>& rows = result.iterations;
    const auto observe = [&] { if (observer.iteration) observer.iteration(rows.back()); };
    const auto observe_step = [&](const NewtonStep& step) {
        if (observer.newton_step) observer.newton_step(static_cast<int>(rows.size()), step);
    };
    const auto c_squared = [&rows] { return square(rows.back().projected_constraint_norm); };
    const auto boundary_error = [&rows] { return rows.back().relative_boundary_error; };
    bool settled = false;  // a subproblem by_gradient ran out of steps or found none: see subproblem()
    const auto stationary = [&] { return settled || is_stationary(rows.back(), params); };

    AugmentedFunctional E{distortion, constraint, start.lambda, 0};
    E.lambda.resize(constraint.multipliers());                                            //  3: zero where not given
    rows.push_back(measured(distortion, constraint, x, result.distortion));
    const double one_squared = square(constraint.norm_of_one());
    Schedule s(params, start.mu, one_squared, c_squared());                               //  4-6
    const auto constrained = [&] {
        return c_squared() <= params.epsilon_star && boundary_error() <= s.wall_tolerance;
    };
    observe();
    // Row 0 cannot end the loop: the gradient of E is known only after the first subproblem.
    while (rows.size() == 1 || !s.ends(constrained(), stationary())) {                    //  7
        const bool cold = rows.size() == 1 && start.lambda.empty();
        const bool by_gradient = rows.back().newton_status == Status::no_visible_gain && constrained();
        const NewtonParams wanted = subproblem(params, s, cold, by_gradient, start.from_coarser, E);
        E.penalty = s.penalty();
        const NewtonResult solved = newton.minimise(E, wanted, x, observe_step);          //  8
        add_counts(solved, result);
        rows.push_back(row_of(E, x, result.distortion, s, solved, rows.back().iteration + 1));
        rows.back().seconds = watch.seconds();
        settled = by_gradient && constrained() && (solved.status == Status::max_newton_iterations ||
                                                   solved.status == Status::line_search_failed);
        if (settled) rows.back().newton_status = Status::no_visible_gain;
        const bool ends = s.ends(constrained(), stationary());
        if (const auto failed = failure(rows, params, one_squared, constrained(), stationary(), ends)) {
            result.status = *failed;
            result.gradient = E.gradient(x);
        }
        if (!ends && result.status != Status::converged) {
            observe();
            break;
        }
        if (c_squared() <= s.epsilon) {                                                   //  9
            constraint.update_multipliers(x, s.mu, E.lambda);                             // 10
            rows.back().update = s.tighten(c_squared(), boundary_error());                // 11-14
        } else {                                                                          // 15-16
            rows.back().update = s.raise_penalty();                                       // 17-20
        }                                                                                 // 21
        observe();
        if (observer.multipliers) observer.multipliers(E.lambda, s.mu / one_squared);
    }                                                                                     // 22
    result.lambda = std::move(E.lambda);
    newton.time.total += watch.seconds();
    return result;
}

}  // namespace almesh
