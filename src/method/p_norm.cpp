// x_2 = argmin of the deviation; for p = 4, 8, ...: M = max eta - 1 at x, lambda <- lambda p E_p / (p' E_p'), and x_p
// from x.
#include "method/p_norm.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"

namespace almesh {
namespace {

constexpr double quadratic_part = 0.012;   // kappa_p p
constexpr int steps_of_power = 8;          // Newton steps of a subproblem of a power that is not the last
constexpr double gradient_of_power = 0.03; // such a power lowers |grad E| to this part, and more where it starts far
constexpr double worthwhile = 2e-3;        // relative decrease of the largest eta
constexpr double undistorted = 1e-10;      // largest eta - 1 below which there is nothing to gain

bool succeeded(const AlResult& result) { return result.status == Status::converged; }

// What one power leaves to the next.
struct Sharpening {
    const Level& level;
    AlResult result;
    double mu = 0;  // in units of |1|^2
    int earlier_steps = 0;  // of Newton's method

    double largest() const { return result.distortion.max_distortion; }

    void take(AlResult next) {
        earlier_steps += result.newton_iterations + next.earlier_newton_iterations;
        result = std::move(next);
        result.earlier_newton_iterations = earlier_steps;
        mu = result.iterations.back().mu / std::pow(level.constraint->norm_of_one(), 2);
    }

    // The density of another power, and the multipliers to go with it.
    AlStart set_power(int p, const std::vector<double>& x) {
        const PowerParams before = level.energy->power();
        const double E_before = level.energy->energy(x);
        if (p == 2) level.energy->set_power({});
        else level.energy->set_power({p, largest() - 1, quadratic_part / p});
        // Where nothing is distorted no force acts.
        const double change = E_before > 0 ? p * level.energy->energy(x) / (before.p * E_before) : 1;
        AlStart start{result.lambda, mu};
        for (double& lambda : start.lambda) lambda *= change;
        return start;
    }
};

double gradient_norm(const Level& level, const AlStart& start, const std::vector<double>& x) {
    const double penalty = start.mu * std::pow(level.constraint->norm_of_one(), 2);
    const AugmentedFunctional E{*level.energy, *level.constraint, start.lambda, penalty};
    return norm_2(E.gradient(x));
}

}  // namespace

AlResult minimise_p_norm(const Level& level, Newton& newton, const MethodParams& params, int last_power,
                        std::vector<double>& x, const AlStart& start, const AlObserver& observer,
                        const StageObserver& observe_stage) {
    const AugmentedLagrangianParams loose = loosened(params.schedule, level);
    MethodParams first = params;
    first.schedule = loose;
    Sharpening at{level, {}, 0};
    level.energy->set_power({});
    at.take(minimise_in_increments(level, newton, first, x, start, {}, observe_stage));
    if (!succeeded(at.result)) return at.result;

    const auto report_power = [&] {
        if (observe_stage)
            observe_stage({level.mesh.nodes(), Status::converged, at.result.iterations.back(),
                          at.result.newton_iterations, 1, level.energy->power().p});
    };
    report_power();
    const bool can_gain = at.largest() - 1 > undistorted && std::isfinite(at.largest());
    int p = 2;
    for (double before = 2 * at.largest(); can_gain && 2 * p < last_power; p *= 2) {
        // A power that has raised it is far from solved, and says nothing of the next.
        if (at.largest() <= before && at.largest() > (1 - worthwhile) * before) break;
        before = at.largest();
        const AlStart from = at.set_power(2 * p, x);
        AugmentedLagrangianParams schedule = loose;
        schedule.omega_star = std::min(loose.omega_star, gradient_of_power * gradient_norm(level, from, x));
        schedule.max_newton_iterations = steps_of_power;
        at.take(minimise(*level.energy, *level.constraint, newton, schedule, x, {}, from));
        if (at.result.status == Status::interrupted) return at.result;
        report_power();
    }
    for (p = can_gain ? std::min(2 * p, last_power) : 2;; p = std::max(2, p / 2)) {
        const AlStart from = at.set_power(p, x);
        at.take(minimise(*level.energy, *level.constraint, newton, params.schedule, x, observer, from));
        if (succeeded(at.result) || at.result.status == Status::interrupted || p == 2) return at.result;
    }
}

}  // namespace almesh
