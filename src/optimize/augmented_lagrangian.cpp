#include "optimize/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>

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

constexpr double wanted_reduction = 0.1;  // of |c_D| per iteration, else the penalty grows

AlUpdate update_adaptive(double constraint, double previous_constraint, Schedule& s) {
    s.omega *= 0.1;
    if (constraint <= wanted_reduction * previous_constraint) return AlUpdate::multipliers;
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
    return AlStatus::linear_solver_failed;
}

}  // namespace

const char* to_string(AlStatus status) {
    switch (status) {
        case AlStatus::converged: return "converged";
        case AlStatus::max_iterations: return "max_al_iterations";
        case AlStatus::infeasible: return "infeasible";
        case AlStatus::ended_as_printed: return "ended_as_printed";
        case AlStatus::max_newton_iterations: return "max_newton_iterations";
        case AlStatus::line_search_failed: return "line_search_failed";
        case AlStatus::linear_solver_failed: return "linear_solver_failed";
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
                  Objective objective, const AugmentedLagrangianParams& params, std::vector<double>& x, Timings& time,
                  const AlObserver& observer) {
    const bool literal = params.algorithm == Algorithm::literal;
    const double one_squared = constraint.norm_of_one() * constraint.norm_of_one(), mu0 = params.mu0 * one_squared;
    Schedule s = {m0, mu0, params.omega0, params.epsilon0};
    AugmentedFunctional E{distortion, constraint, std::vector<double>(constraint.size(), 0.0), 0};
    AlResult result;
    Stopwatch watch;

    const auto record = [&](AlIteration row) {
        row.iteration = static_cast<int>(result.iterations.size());
        row.constraint_norm = constraint.norm(x);
        row.projected_constraint_norm = constraint.projected_norm(x);
        const DistortionStatistics statistics = distortion.statistics(x);
        row.relative_quality = statistics.relative_quality;
        row.max_distortion = statistics.max_distortion;
        row.seconds = watch.seconds();
        result.iterations.push_back(row);
    };
    record({});
    if (observer.iteration) observer.iteration(result.iterations.back());

    for (;;) {
        E.penalty = literal ? s.mu * s.mu : s.mu;
        NewtonParams newton_params;
        newton_params.omega = s.omega;
        newton_params.omega_star = literal ? 0 : params.omega_star;
        if (params.algorithm == Algorithm::adaptive) newton_params.wanted_reduction = 0.1;
        newton_params.max_iterations = params.max_newton_iterations;
        const bool first = result.iterations.size() == 1;
        newton_params.first = !first                                ? HessianKind::full
                              : objective == Objective::deviation ? HessianKind::squared_projected
                                                                  : HessianKind::projected;
        const int k = static_cast<int>(result.iterations.size());
        const NewtonResult solved = newton.minimise(E, newton_params, x, time, [&](const NewtonStep& step) {
            if (observer.newton_step) observer.newton_step(k, step);
        });
        result.newton_iterations += solved.iterations;
        result.linear_iterations += solved.linear_iterations;

        AlIteration row;
        row.energy = solved.energy;
        row.gradient_norm = solved.gradient_norm;
        row.mu = s.mu;
        row.omega = std::max(newton_params.omega, newton_params.omega_star);
        row.epsilon = s.epsilon;
        row.newton_iterations = solved.iterations;
        row.newton_status = solved.status;
        record(row);
        AlIteration& current = result.iterations.back();
        const double c = current.projected_constraint_norm;
        const bool usable = solved.status == NewtonStatus::converged || solved.status == NewtonStatus::rounding_floor;
        const bool constrained = c * c <= params.epsilon_star;
        result.rounding_floor = solved.status == NewtonStatus::rounding_floor && solved.gradient_norm > params.omega_star;
        const bool stationary = solved.gradient_norm <= params.omega_star || result.rounding_floor;

        bool done = true;
        if (constrained && stationary) result.status = AlStatus::converged;
        else if (literal && (constrained || stationary)) result.status = AlStatus::ended_as_printed;
        else if (constraint_stalls(result.iterations, usable ? 3 : 1, one_squared)) result.status = AlStatus::infeasible;
        else if (!usable) result.status = failure_of(solved.status);
        else if (k == params.max_iterations) result.status = AlStatus::max_iterations;
        else done = false;
        if (!done) {
            const double mu = s.mu;
            if (params.algorithm == Algorithm::adaptive)
                current.update = update_adaptive(c, result.iterations[k - 1].projected_constraint_norm, s);
            else if (params.algorithm == Algorithm::paper) current.update = update_paper(params, mu0, c * c, s);
            else current.update = update_literal(params, mu0, c * c, s);
            if (current.update != AlUpdate::penalty) constraint.update_multipliers(x, mu, E.lambda);
        }
        if (observer.iteration) observer.iteration(current);
        if (done) break;
    }
    result.lambda = std::move(E.lambda);
    time.total += watch.seconds();
    return result;
}

}  // namespace almesh
