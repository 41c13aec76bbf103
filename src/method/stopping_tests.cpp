// Out of reach: E_before - E < 1e-3 E and distortion < 0.1 E. At the attainable accuracy: g > g_before / 2. Futile,
// three times in a row: t <= 1e-8 and E_before - E <= 1e-14 E. The last local step: E_before - E <= 1e-3 (E_start - E).
#include "method/stopping_tests.hpp"

#include <algorithm>
#include <cmath>

#include "base/interrupt.hpp"
#include "method/functional.hpp"

namespace almesh {
namespace {

constexpr double short_step = 1e-8, unchanged = 1e-14;  // unchanged: relative difference of two energies
constexpr int most_futile_steps = 3;
constexpr double most_invisible = 3, shortest_invisible = 0.25;  // together; what a shorter step counts as
constexpr double part_of_gain = 1e-3;  // of all steps so far: a local step that gains less is not worth another

bool is_finite(const NewtonResult& at) { return std::isfinite(at.energy) && std::isfinite(at.gradient_norm); }

}  // namespace

bool is_out_of_reach(double largest_energy, double energy_before, double energy, double step_length,
                     double distortion) {
    return energy > largest_energy && step_length >= 1 && energy_before - energy < 1e-3 * energy &&
           distortion < 0.1 * energy;
}

bool at_attainable_accuracy(bool by_rounding, double g_before, double g, double omega) {
    return by_rounding && g > 0.5 * g_before && g > omega;
}

std::optional<Status> StoppingTests::before_step(const NewtonResult& at) const {
    if (at.gradient_norm <= at.omega) return Status::converged;
    if (!is_finite(at)) return Status::overflow;
    if (at.iterations == params_.max_iterations) return Status::max_newton_iterations;
    if (interrupted()) return Status::interrupted;
    return std::nullopt;
}

bool StoppingTests::is_last(const NewtonResult& before, const NewtonResult& at) const {
    if (!params_.least_gain) return false;
    const double gained = before.energy - at.energy;
    return gained <= *params_.least_gain || gained <= part_of_gain * (at.start_energy - at.energy) ||
           at.work > params_.most_work || at.iterations == params_.max_iterations;
}

std::optional<Status> StoppingTests::after_step(const NewtonStep& step, const NewtonResult& before,
                                                const NewtonResult& at, const Functional& E,
                                                const std::vector<double>& x) {
    if (!step.has_direction) return Status::linear_solver_failed;
    if (step.step_length == 0) return Status::line_search_failed;
    if (params_.least_gain) return step.is_last ? std::optional(Status::converged) : std::nullopt;
    const bool moves = step.step_length > short_step || before.energy - at.energy > unchanged * std::abs(at.energy);
    futile_steps_ = moves ? 0 : futile_steps_ + 1;
    if (futile_steps_ == most_futile_steps) return Status::line_search_failed;
    if (!is_finite(at)) return Status::overflow;
    invisible_gain_ += before.energy - at.energy;
    invisible_length_ += std::clamp(step.step_length, shortest_invisible, 1.0);
    const double visible = params_.visible_part > 0 ? params_.visible_part * E.distortion_energy(x, at.energy)
                                                    : params_.visible_gain;
    if (invisible_gain_ >= visible) invisible_gain_ = invisible_length_ = 0;
    if (visible > 0 && invisible_length_ >= most_invisible && at.gradient_norm > at.omega)
        return Status::no_visible_gain;
    if (at.energy > params_.largest_energy) {
        const double lost = E.lost_energy(x);
        if (is_out_of_reach(params_.largest_energy, before.energy - lost, at.energy - lost, step.step_length,
                            E.distortion_energy(x, at.energy)))
            return Status::stalled;
    }
    if (at_attainable_accuracy(step.by_rounding, before.gradient_norm, at.gradient_norm, at.omega))
        return Status::attainable_accuracy;
    return std::nullopt;
}

}  // namespace almesh
