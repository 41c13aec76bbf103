#include "method/newton.hpp"

#include <algorithm>
#include <cmath>

#include "base/interrupt.hpp"
#include "linalg/vector_ops.hpp"
#include "method/line_search.hpp"
#include "method/pockets.hpp"

namespace almesh {
namespace {

// Forcing term where no ratio of gradients tells how good the model is: in the first step of a subproblem and after a
// step that was cut. From 1e-9 to 1e-4 the decks of the aircraft with Eq. (5) take the same numbers of steps.
constexpr double careful_forcing = 1e-4;

// The damping falls after a full step and grows after one that was cut; above `full_below` no step is worth trying
// without it.
constexpr double damping_shrinks = 0.2, damping_grows = 4, full_below = 0.1;

constexpr int steps_without_pockets = 10;
constexpr double worthwhile = 0.01;  // decrease of a local step, in units of that of the global step before

// The next Hessian to try where `kind` gave no descent direction; false where there is none.
bool fall_back(HessianKind& kind) {
    if (kind == HessianKind::squared_projected) return false;
    kind = kind == HessianKind::full ? HessianKind::projected : HessianKind::squared_projected;
    return true;
}

}  // namespace

const char* to_string(NewtonStatus status) {
    switch (status) {
        case NewtonStatus::converged: return "converged";
        case NewtonStatus::rounding_floor: return "rounding_floor";
        case NewtonStatus::max_iterations: return "max_newton_iterations";
        case NewtonStatus::line_search_failed: return "line_search_failed";
        case NewtonStatus::linear_solver_failed: return "linear_solver_failed";
        case NewtonStatus::interrupted: return "interrupted";
        case NewtonStatus::out_of_reach: return "out_of_reach";
    }
    return "";
}

const char* to_string(HessianKind kind) {
    switch (kind) {
        case HessianKind::full: return "full";
        case HessianKind::projected: return "projected";
        case HessianKind::squared_projected: return "squared_projected";
    }
    return "";
}

double forcing_term(double g_before, double g, double omega, double floor) {
    const double order = (1 + std::sqrt(5.0)) / 2;
    const double eta = std::max(0.9 * std::pow(g / g_before, order), 0.5 * omega / g);
    return std::max(std::min(eta, largest_forcing), floor);
}

Newton::Newton(const DistortionEnergy& distortion, const LinearSolverParams& linear, Forcing forcing)
    : H_(distortion.hessian_pattern()),
      solver_(H_.d, linear),
      forcing_(forcing),
      linear_tolerance_(linear.tolerance),
      g_(H_.size()),
      minus_g_(H_.size()),
      d_(H_.size()),
      trial_(H_.size()) {}

// Solves H d = -grad E, weakening the Hessian until d is a descent direction. energy: E(x). Names what it used in
// `step`.
bool Newton::find_direction(const AugmentedFunctional& E, const std::vector<double>& x, double energy, NewtonStep& step,
                            Timings& time) {
    for (std::size_t i = 0; i < g_.size(); ++i) minus_g_[i] = -g_[i];
    do {
        {
            const TimeAdder adder(time.assembly);
            const double damping = step.hessian == HessianKind::projected ? damping_ * E.mean_distortion(x, energy) : 0;
            E.hessian(x, step.hessian, H_, damping);
        }
        if (observe_system_) observe_system_(H_, minus_g_);
        const TimeAdder adder(time.linear);
        const SolveResult solve = solver_.solve(H_, minus_g_, d_, step.hessian == HessianKind::full);
        step.linear_iterations += solve.iterations;
        step.solver = solve.used;
        step.shift = solve.diagonal_shift;
        step.fallback = solve.failed_first;
        if (solve.status == SolveStatus::success && dot(g_, d_) < 0) return true;
    } while (fall_back(step.hessian));
    return false;
}

// A direction and a length along it, from weaker Hessians where the first one gives none; `converged` if there was one.
NewtonStatus Newton::take_step(const AugmentedFunctional& E, std::vector<double>& x, double& energy, NewtonStep& step,
                               bool& by_rounding, Timings& time) {
    do {
        if (!find_direction(E, x, energy, step, time)) return NewtonStatus::linear_solver_failed;
        const TimeAdder adder(time.line_search);
        const auto energy_of = [&E](const std::vector<double>& y) { return E.energy(y); };
        const LineSearchResult found = line_search(energy_of, energy, dot(g_, d_), d_, x, trial_);
        by_rounding = found.by_rounding;
        step.cuts_inverted += found.cuts_inverted;
        step.cuts_decrease += found.cuts_decrease;
        step.step_length = found.step_length;
        if (found.step_length == 0) continue;
        energy = found.energy;
        return NewtonStatus::converged;
    } while (fall_back(step.hessian));
    return NewtonStatus::line_search_failed;
}

// Minimises over the nodes that hold up the others, where there are such. gained: decrease of E by the step.
void Newton::relax(const AugmentedFunctional& E, double gained, std::vector<double>& x, double& energy,
                   NewtonStep& step, Timings& time) {
    relaxes_ = relaxes_ || step.iteration > steps_without_pockets;
    if (!relaxes_) return;
    const TimeAdder adder(time.pockets);
    E.gradient(x, g_);
    const Relaxation relaxed = relax_pockets(E, H_, g_, worthwhile * gained, x, energy);
    step.pocket_nodes = relaxed.nodes;
    step.pocket_steps = relaxed.steps;
}

NewtonResult Newton::minimise(const AugmentedFunctional& E, const NewtonParams& params, std::vector<double>& x,
                              Timings& time, const NewtonObserver& observe) {
    const auto evaluate_gradient = [&] {
        const TimeAdder adder(time.assembly);
        E.gradient(x, g_);
        return norm_2(g_);
    };
    NewtonResult result;
    const auto end = [&result](NewtonStatus status) {
        result.status = status;
        return result;
    };
    result.energy = E.energy(x);
    result.gradient_norm = evaluate_gradient();
    const double wanted = params.wanted_reduction < 1 ? params.wanted_reduction * result.gradient_norm : params.omega;
    const double omega = result.omega = std::max(std::min(params.omega, wanted), params.omega_star);
    HessianKind kind = params.first;
    double eta = forcing_ == Forcing::fixed ? linear_tolerance_ : std::max(careful_forcing, linear_tolerance_);
    if (kind == HessianKind::squared_projected) {
        damping_ = 1;
        relaxes_ = false;
    }
    while (!(result.gradient_norm <= omega)) {
        if (result.iterations == params.max_iterations) return end(NewtonStatus::max_iterations);
        if (interrupted()) return end(NewtonStatus::interrupted);
        const double energy_before = result.energy;
        NewtonStep step;
        step.iteration = ++result.iterations;
        step.hessian = kind;
        solver_.set_tolerance(eta);
        bool by_rounding = false;
        const NewtonStatus failure = take_step(E, x, result.energy, step, by_rounding, time);
        result.linear_iterations += step.linear_iterations;
        if (failure != NewtonStatus::converged) return end(failure);
        if (!by_rounding) relax(E, energy_before - result.energy, x, result.energy, step, time);
        result.pocket_steps += step.pocket_steps;
        const double before = result.gradient_norm;
        result.gradient_norm = step.gradient_norm = evaluate_gradient();
        if (forcing_ == Forcing::automatic)
            eta = step.step_length >= 1 ? forcing_term(before, result.gradient_norm, omega, linear_tolerance_)
                                        : std::max(careful_forcing, linear_tolerance_);
        const double gained = energy_before - result.energy;
        step.energy = result.energy;
        if (observe) observe(step);
        if (result.energy > params.largest_energy && step.step_length >= 1 && gained < 1e-3 * result.energy &&
            E.distortion.energy(x) < 0.1 * result.energy)
            return end(NewtonStatus::out_of_reach);
        if (by_rounding && result.gradient_norm > 0.5 * before && result.gradient_norm > omega)
            return end(NewtonStatus::rounding_floor);
        damping_ = step.step_length >= 1 ? damping_shrinks * damping_ : std::min(1.0, damping_grows * damping_);
        kind = step.step_length >= 1 && damping_ <= full_below ? HessianKind::full : HessianKind::projected;
    }
    return end(NewtonStatus::converged);
}

}  // namespace almesh
