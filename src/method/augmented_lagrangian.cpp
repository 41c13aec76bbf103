#include "method/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace almesh {
namespace {

// The parameters of one iteration of Algorithm 1.
struct Schedule {
    double m, mu, omega, epsilon;
};

constexpr double m0 = 10;              // line 4
constexpr double penalty_growth = 100;  // line 17

// Lines 9-21 as they must be meant: m/m0 where m0/m is printed, so that the tolerances tighten.
AlUpdate update_paper(const AugmentedLagrangianParams& p, double mu0, double squared_constraint, Schedule& s) {
    if (squared_constraint <= s.epsilon) {
        s.epsilon /= std::pow(s.m, 0.9);
        s.omega /= s.m;
        return AlUpdate::multipliers;
    }
    s.m *= penalty_growth;
    s.mu = mu0 * (s.m / m0);
    s.epsilon = p.epsilon0 / std::pow(s.m / m0, 0.1);
    s.omega = p.omega0 / (s.m / m0);
    return AlUpdate::penalty;
}

// Lines 9-21 as printed.
AlUpdate update_literal(const AugmentedLagrangianParams& p, double mu0, double squared_constraint, Schedule& s) {
    if (squared_constraint <= s.epsilon) {
        s.epsilon /= std::pow(s.m, 0.9);
        s.omega /= s.mu;
        return AlUpdate::multipliers;
    }
    s.m *= penalty_growth;
    s.mu = mu0 / (m0 / s.m);
    s.epsilon = p.epsilon0 / std::pow(m0 / s.m, 0.1);
    s.omega = p.omega0 / (m0 / s.m);
    return AlUpdate::penalty;
}

// The adaptive schedule. The constraint is linear, so a large penalty makes no subproblem less convex, and the boundary
// holds almost at once; the first subproblem is solved loosely, because the multipliers change the next one.
constexpr double adaptive_mu0 = 1e5;     // in units of |1|^2
constexpr double adaptive_omega0 = 1e3;  // in units of omega_star
constexpr double wanted_reduction = 0.1;  // of |c_D| per iteration, else the penalty grows tenfold

// Where the constraint holds already only |grad E| has to follow: its tolerance becomes the final one, the penalty
// stays.
AlUpdate update_adaptive(const AugmentedLagrangianParams& p, double constraint, double previous_constraint,
                         Schedule& s) {
    const bool holds = constraint * constraint <= p.epsilon_star;
    s.omega = holds ? p.omega_star : 0.1 * s.omega;
    if (holds || constraint <= wanted_reduction * previous_constraint) return AlUpdate::multipliers;
    s.mu *= 10;
    return AlUpdate::both;
}

// The constraint stands still (to 10 %) for `updates` iterations in a row although each had a larger penalty. Below
// `weak` the penalty is no match for the distortion, and standing still tells nothing.
bool constraint_stalls(const std::vector<AlIteration>& rows, std::size_t updates, double weak) {
    if (rows.size() < updates + 2) return false;
    for (std::size_t k = rows.size() - updates; k < rows.size(); ++k)
        if (rows[k].mu <= rows[k - 1].mu || rows[k - 1].mu < weak ||
            rows[k].projected_constraint_norm < 0.9 * rows[k - 1].projected_constraint_norm)
            return false;
    return true;
}

AlStatus failure_of(NewtonStatus status) {
    if (status == NewtonStatus::max_iterations) return AlStatus::max_newton_iterations;
    if (status == NewtonStatus::line_search_failed) return AlStatus::line_search_failed;
    if (status == NewtonStatus::interrupted) return AlStatus::interrupted;
    return AlStatus::linear_solver_failed;
}

// Mean density of meshes that are of no use: q is then 0.05 (integral of eta^2).
constexpr double useless_density = 400;

// first: without multipliers, from the ideal mesh.
NewtonParams subproblem(const AugmentedLagrangianParams& p, const Schedule& s, bool first, double volume) {
    NewtonParams newton;
    newton.omega = s.omega;
    newton.omega_star = p.algorithm == Algorithm::literal ? 0 : p.omega_star;
    newton.wanted_reduction = p.algorithm == Algorithm::adaptive ? 0.1 : 1;
    newton.max_iterations = p.max_newton_iterations;
    if (first && p.algorithm != Algorithm::literal) newton.largest_energy = useless_density * volume;
    newton.first = first ? HessianKind::squared_projected : HessianKind::full;
    return newton;
}

// Line 7 and what else can end the loop after the last of `rows`; nothing while it goes on. weak: |1|^2, the penalty
// below which a standing constraint tells nothing.
std::optional<AlStatus> verdict(const AugmentedLagrangianParams& p, const std::vector<AlIteration>& rows, double weak) {
    const AlIteration& row = rows.back();
    const bool literal = p.algorithm == Algorithm::literal;
    const bool at_floor = row.newton_status == NewtonStatus::rounding_floor;
    const bool usable = at_floor || row.newton_status == NewtonStatus::converged;
    const bool constrained = row.projected_constraint_norm * row.projected_constraint_norm <= p.epsilon_star;
    const bool stationary = row.gradient_norm <= p.omega_star || (at_floor && row.gradient_norm <= p.omega0);
    if (constrained && stationary) return AlStatus::converged;
    if (literal && (constrained || stationary)) return AlStatus::ended_as_printed;
    if (constrained && at_floor) return AlStatus::rounding_floor;
    if (row.newton_status == NewtonStatus::out_of_reach) return AlStatus::infeasible;
    const bool failed = !usable && row.newton_status != NewtonStatus::interrupted;
    if (constraint_stalls(rows, failed ? 1 : 3, weak)) return AlStatus::infeasible;
    if (!usable) return failure_of(row.newton_status);
    if (row.iteration == p.max_iterations) return AlStatus::max_iterations;
    return std::nullopt;
}

// Lines 9-21 after the last of `rows`.
AlUpdate update(const AugmentedLagrangianParams& p, const std::vector<AlIteration>& rows, double mu0, Schedule& s) {
    const double c = rows.back().projected_constraint_norm;
    if (p.algorithm == Algorithm::paper) return update_paper(p, mu0, c * c, s);
    if (p.algorithm == Algorithm::literal) return update_literal(p, mu0, c * c, s);
    return update_adaptive(p, c, rows[rows.size() - 2].projected_constraint_norm, s);
}

AlIteration measure(const DistortionEnergy& distortion, const BoundaryConstraint& constraint,
                    const std::vector<double>& x, DistortionStatistics& statistics) {
    AlIteration row;
    row.projected_constraint_norm = constraint.projected_norm(x);
    row.constraint_norm = std::hypot(row.projected_constraint_norm, constraint.floor());
    statistics = distortion.statistics(x);
    row.relative_quality = statistics.relative_quality;
    row.max_distortion = statistics.max_distortion;
    return row;
}

}  // namespace

const char* to_string(AlStatus status) {
    switch (status) {
        case AlStatus::converged: return "converged";
        case AlStatus::max_iterations: return "max_al_iterations";
        case AlStatus::infeasible: return "infeasible";
        case AlStatus::rounding_floor: return "rounding_floor";
        case AlStatus::ended_as_printed: return "ended_as_printed";
        case AlStatus::max_newton_iterations: return "max_newton_iterations";
        case AlStatus::line_search_failed: return "line_search_failed";
        case AlStatus::linear_solver_failed: return "linear_solver_failed";
        case AlStatus::interrupted: return "interrupted";
    }
    return "";
}

const char* to_string(AlUpdate update) {
    switch (update) {
        case AlUpdate::none: return "-";
        case AlUpdate::multipliers: return "lambda";
        case AlUpdate::penalty: return "mu";
        case AlUpdate::both: return "lambda+mu";
    }
    return "";
}

AlResult minimise(const DistortionEnergy& distortion, const BoundaryConstraint& constraint, Newton& newton,
                  const AugmentedLagrangianParams& params, std::vector<double>& x, Timings& time,
                  const AlObserver& observer, const AlStart& start) {
    const Stopwatch watch;
    const double one_squared = constraint.norm_of_one() * constraint.norm_of_one();
    const bool adaptive = params.algorithm == Algorithm::adaptive;
    const double mu0 = (start.mu > 0 ? start.mu : adaptive ? adaptive_mu0 : params.mu0) * one_squared;
    AlResult result;
    std::vector<AlIteration>& rows = result.iterations;
    rows.push_back(measure(distortion, constraint, x, result.distortion));
    if (observer.iteration) observer.iteration(rows.back());

    AugmentedFunctional E{distortion, constraint, start.lambda, 0};
    E.lambda.resize(constraint.size());
    Schedule s = {m0, mu0, adaptive ? adaptive_omega0 * params.omega_star : params.omega0, params.epsilon0};
    for (int k = 1;; ++k) {
        E.penalty = params.algorithm == Algorithm::literal ? s.mu * s.mu : s.mu;
        const NewtonParams wanted = subproblem(params, s, k == 1 && start.lambda.empty(), distortion.domain_volume());
        const NewtonResult solved = newton.minimise(E, wanted, x, time, [&](const NewtonStep& step) {
            if (observer.newton_step) observer.newton_step(k, step);
        });
        result.newton_iterations += solved.iterations;
        result.linear_iterations += solved.linear_iterations;
        result.pocket_steps += solved.pocket_steps;

        AlIteration row = measure(distortion, constraint, x, result.distortion);
        row.iteration = k;
        row.energy = solved.energy;
        row.gradient_norm = solved.gradient_norm;
        row.mu = s.mu;
        row.omega = solved.omega;
        row.epsilon = s.epsilon;
        row.newton_iterations = solved.iterations;
        row.newton_status = solved.status;
        row.seconds = watch.seconds();
        rows.push_back(row);

        const std::optional<AlStatus> end = verdict(params, rows, one_squared);
        if (!end) {
            const double mu = s.mu;
            rows.back().update = update(params, rows, mu0, s);
            if (rows.back().update != AlUpdate::penalty) constraint.update_multipliers(x, mu, E.lambda);
        }
        if (observer.iteration) observer.iteration(rows.back());
        if (!end) continue;
        result.status = *end;
        result.lambda = std::move(E.lambda);
        time.total += watch.seconds();
        return result;
    }
}

}  // namespace almesh
