// x_2 = argmin of the deviation; for p = 4, 8, ...: M = max eta - 1 at x, lambda <- lambda p E_p / (p' E_p'), and x_p
// from x; with the last p again with kappa <- kappa(x), until it stays.
#include "method/p_norm.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"

namespace almesh {
namespace {

constexpr double first_kappa = 0.012;      // p kappa before the first update
constexpr double square_part = 0.01;       // K
constexpr int norm_over_power = 4;         // q / p
constexpr double nearly = 0.1;             // relative change of kappa by a minimisation, for loose ones,
constexpr double settled = 1e-5;           // and in the end
constexpr int most_updates = 8;            // of kappa, to come to either
constexpr int steps_of_power = 8;          // Newton steps of a subproblem that is solved loosely
constexpr double gradient_of_power = 0.03; // its tolerance relative to |grad E| at its start, if that is smaller
constexpr double worthwhile = 2e-3;        // relative decrease of the largest eta
constexpr double undistorted = 1e-10;      // largest eta - 1 below which there is nothing to gain

// What one power leaves to the next.
struct Sharpening {
    const Level& level;
    Newton& newton;
    std::vector<double>& x;
    AlResult result;
    double mu = 0;  // in units of |1|^2
    int earlier_steps = 0;  // of Newton's method

    double largest() const { return result.distortion.max_distortion; }
    bool converged() const { return result.status == Status::converged; }
    bool interrupted() const { return result.status == Status::interrupted; }
    // Then another kappa gains nothing either.
    bool gains_nothing() const { return result.iterations.back().newton_status == Status::no_visible_gain; }

    // At this power, where the run stood.
    void begin(int p, const AlStart& start) {
        result.iterations = {measured(*level.energy, *level.constraint, x, result.distortion)};
        result.lambda = start.lambda;
        if (p > 2) level.energy->set_power({p, largest() - 1, first_kappa / p});
    }

    void take(AlResult next) {
        earlier_steps += result.newton_iterations + next.earlier_newton_iterations;
        result = std::move(next);
        result.earlier_newton_iterations = earlier_steps;
        mu = result.iterations.back().mu / std::pow(level.constraint->norm_of_one(), 2);
    }

    // The density of a power, and the multipliers to go with it; again: with M and kappa as they now are.
    void set_power(int p) {
        const PowerParams before = level.energy->power();
        const double E_before = level.energy->energy(x);
        if (p == 2) level.energy->set_power({});
        else level.energy->set_power({p, largest() - 1, first_kappa / p});
        if (p == before.p) update_kappa(*level.energy, x);
        // Where nothing is distorted no force acts.
        const double change = E_before > 0 ? p * level.energy->energy(x) / (before.p * E_before) : 1;
        for (double& lambda : result.lambda) lambda *= change;
    }

    // Minimises until that leaves kappa as it was, or fails.
    void solve(const AugmentedLagrangianParams& schedule, const AlObserver& observer) {
        for (int k = 0; k < most_updates; ++k) {
            set_power(level.energy->power().p);
            take(minimise(*level.energy, *level.constraint, newton, schedule, x, observer, {result.lambda, mu}));
            if (!converged() || gains_nothing() || update_kappa(*level.energy, x) <= settled) return;
        }
        result.status = Status::max_al_iterations;
    }

    // updates: of kappa, at most; as many as are worth it.
    void solve_loosely(AugmentedLagrangianParams schedule, int updates) {
        schedule.max_newton_iterations = steps_of_power;
        for (int k = 0;; ++k) {
            const double penalty = mu * std::pow(level.constraint->norm_of_one(), 2);
            const AugmentedFunctional E{*level.energy, *level.constraint, result.lambda, penalty};
            schedule.omega_star = std::min(schedule.omega_star, gradient_of_power * norm_2(E.gradient(x)));
            take(minimise(*level.energy, *level.constraint, newton, schedule, x, {}, {result.lambda, mu}));
            if (interrupted() || gains_nothing() || k == updates) return;
            if (update_kappa(*level.energy, x) <= nearly) return;
            set_power(level.energy->power().p);
        }
    }
};

// evaluate() with the density M^2 s^q.
double with_power_alone(DistortionEnergy& energy, int q, const std::function<double()>& evaluate) {
    const PowerParams power = energy.power();
    energy.set_power({q, power.M, 0});
    const double value = evaluate();
    energy.set_power(power);
    return value;
}

}  // namespace

double update_kappa(DistortionEnergy& energy, const std::vector<double>& x) {
    PowerParams power = energy.power();
    if (power.kappa == 0) return 0;
    const int q = norm_over_power * power.p;
    const double before = power.kappa;
    const double mean = with_power_alone(energy, q, [&] { return energy.energy(x) / energy.uniform(1 + power.M); });
    power.kappa = square_part * std::pow(mean, (power.p - 2.0) / q);
    energy.set_power(power);
    return std::abs(power.kappa / before - 1);
}

KappaChange change_of_kappa(DistortionEnergy& energy, const std::vector<double>& x) {
    if (energy.power().kappa == 0) return {};
    const int p = energy.power().p, q = norm_over_power * p;
    KappaChange change{std::vector<double>(x.size(), 0.0), std::vector<double>(x.size(), 0.0)};
    with_power_alone(energy, p, [&] { return energy.add_gradient(x, change.u), 0; });
    energy.pairs().fold(change.u);
    const double E_q = with_power_alone(energy, q, [&] { return energy.add_gradient(x, change.v), energy.energy(x); });
    energy.pairs().fold(change.v);
    scale(static_cast<int>(x.size()), (p - 2) / (q * E_q), change.v.data());
    return change;
}

AlResult minimise_p_norm(const Level& level, Newton& newton, const MethodParams& params, int last_power,
                        std::vector<double>& x, const AlStart& start, const AlObserver& observer,
                        const StageObserver& observe_stage) {
    const AugmentedLagrangianParams loose = loosened(params.schedule, level);
    Standing& standing = *params.standing;
    Sharpening state{level, newton, x, {}, start.mu};
    level.energy->set_power({});
    const auto report_power = [&] {
        if (observe_stage)
            observe_stage({level.mesh.nodes(), Status::converged, state.result.iterations.back(),
                          state.result.newton_iterations, 1, level.energy->power().p});
    };
    bool goes_on = params.goes_on && standing.power > 0;
    if (goes_on) {
        state.begin(standing.power, start);
    } else {
        MethodParams first = params;
        first.schedule = loose;
        state.take(minimise_in_increments(level, newton, first, x, start, {}, observe_stage));
        if (!state.converged()) return state.result;
        report_power();
        standing.power = 2;
        standing.eta_before = 2 * state.largest();
    }
    const bool can_gain = state.largest() - 1 > undistorted && std::isfinite(state.largest());
    // A power that has raised the largest eta is far from solved, and says nothing of the next.
    const auto is_worthwhile = [&] {
        return state.largest() > standing.eta_before || state.largest() <= (1 - worthwhile) * standing.eta_before;
    };
    const auto begin_power = [&] {
        state.set_power(standing.power);
        standing.x = x;
        standing.lambda = state.result.lambda;
        standing.mu = state.mu;
    };
    for (; can_gain && !standing.is_last_power; goes_on = false) {
        if (!goes_on) {
            standing.is_last_power = 2 * standing.power >= last_power || !is_worthwhile();
            standing.power = std::min(2 * standing.power, last_power);
            standing.eta_before = state.largest();
            if (standing.is_last_power) break;
        }
        begin_power();
        state.solve_loosely(loose, 0);
        if (state.interrupted()) return state.result;
        report_power();
    }
    for (int& p = standing.power;; p = std::max(2, p / 2)) {
        begin_power();
        if (p > 2) state.solve_loosely(loose, most_updates);
        if (!state.interrupted()) state.solve(params.schedule, observer);
        if (state.converged() || state.interrupted() || p == 2) return state.result;
    }
}

}  // namespace almesh
