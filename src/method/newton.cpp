// Newton's method:   g = grad E(x);   until |g| <= omega:   H d = -g,   x <- x + t d with E decreasing.
#include "method/newton.hpp"

#include <algorithm>
#include <cmath>

#include "base/interrupt.hpp"
#include "base/text.hpp"
#include "linalg/vector_ops.hpp"
#include "method/checkpoint.hpp"
#include "method/functional.hpp"
#include "method/rounding_floor.hpp"

namespace almesh {
namespace {

// Every iterate of conjugate gradients with a positive definite preconditioner is a descent direction (truncated
// Newton: Nocedal & Wright, sec. 7.1). Of an indefinite Hessian it is better to take another one.
bool is_truncated(SolveStatus status) {
    return status == SolveStatus::stagnated || status == SolveStatus::max_iterations ||
           status == SolveStatus::not_positive_definite;
}

std::string hash_of_numbers(const std::vector<double>& numbers) {
    return hash_of({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

// A step that leads nowhere: nodes hang where the surface along which they slide has a kink, or elements are jammed.
constexpr double short_step = 1e-8, unchanged = 1e-14;  // unchanged: relative difference of two energies
constexpr int most_futile_steps = 3;                    // in a row

bool is_finite(const NewtonResult& at) { return std::isfinite(at.energy) && std::isfinite(at.gradient_norm); }

}  // namespace

NewtonResult Newton::minimise(const AugmentedFunctional& E, const NewtonParams& params, std::vector<double>& x,
                              const NewtonObserver& observe) {
    NewtonResult at = start(E, params, x);  // E(x), g = grad E(x), the tolerance omega
    if (resume(E, x, at, observe)) return at;
    const auto end = [&](NewtonStatus status) {
        at.status = status;
        save(E, x, at, status != NewtonStatus::interrupted);
        return at;
    };
    while (!(at.gradient_norm <= at.omega)) {
        if (!is_finite(at)) return end(NewtonStatus::overflow);
        if (at.iterations == params.max_iterations) return end(NewtonStatus::max_iterations);
        if (interrupted()) return end(NewtonStatus::interrupted);
        if (checkpoint_ && checkpoint_->is_due()) save(E, x, at, false);
        refine_quadrature(E, x, at);
        const NewtonResult before = at;
        NewtonStep step(++at.iterations, hessian_);
        LineSearchResult found;
        do {
            if (!find_direction(E, x, at, step)) return end(NewtonStatus::linear_solver_failed);  // H d = -g
            found = search(E, x, at, step);                                                       // x <- x + t d
        } while (found.step_length == 0 && weaken(step.hessian));
        if (found.step_length == 0 && refine_quadrature(E, x, at)) continue;
        if (found.step_length == 0) return end(NewtonStatus::line_search_failed);
        at.gradient_norm = gradient(E, x);                                                        // g = grad E(x)
        const double gained = before.energy - at.energy;
        if (!found.by_rounding && eliminate_locally(E, gained, x, at, step))
            at.gradient_norm = gradient(E, x);
        accept(step.reached(at.energy, at.gradient_norm), observe);
        if (observe_iterate_) observe_iterate_(accepted_steps_, x);
        if (futile_steps_ == most_futile_steps) return end(NewtonStatus::line_search_failed);
        if (!is_finite(at)) continue;
        const auto distortion = [&] { return E.distortion.energy(x); };
        if (params.reach.found(before.energy, at.energy, found.step_length, distortion))
            return end(NewtonStatus::out_of_reach);
        if (at_rounding_floor(found.by_rounding, before.gradient_norm, at.gradient_norm, at.omega))
            return end(NewtonStatus::rounding_floor);
        forcing_.after_step(found.step_length, before.gradient_norm, at.gradient_norm, at.omega);
        if (step.solver != SolverKind::cholesky) negative_part_ = {};
        else if (step.hessian == HessianKind::projected) negative_part_.after_step(found.step_length);
        hessian_ = damping_.after_step(found.step_length);
    }
    return end(NewtonStatus::converged);
}

NewtonResult Newton::start(const AugmentedFunctional& E, const NewtonParams& params, const std::vector<double>& x) {
    if (params.cold_start) {
        damping_.reset();
        negative_part_ = {};
        elimination_.reset();
    }
    elimination_.set_from_coarser(params.from_coarser);
    hessian_ = params.cold_start ? HessianKind::damping : params.first;
    forcing_.start();
    NewtonResult at;
    at.energy = last_energy_ = E.energy(x);
    futile_steps_ = 0;
    at.gradient_norm = gradient(E, x);
    const double reduced = params.reduction < 1 ? params.reduction * at.gradient_norm : params.omega;
    at.omega = std::max(std::min(params.omega, reduced), params.omega_star);
    return at;
}

// Takes over what was saved of this minimisation. Whether that was its end.
bool Newton::resume(const AugmentedFunctional& E, std::vector<double>& x, NewtonResult& at,
                    const NewtonObserver& observe) {
    if (!checkpoint_) return false;
    start_ = concat(hash_of_numbers(x), " ", at.energy, " ", at.gradient_norm, " ", at.omega);
    steps_.clear();
    const std::optional<NewtonState> saved = checkpoint_->next(start_);
    if (!saved) return false;
    x = saved->x;
    at = saved->at;
    hessian_ = saved->hessian;
    forcing_.value = saved->forcing;
    damping_.factor = saved->damping;
    negative_part_.value = saved->negative_part;
    elimination_.set_state(saved->elimination);
    solver_.set_state(saved->solver);
    E.distortion.set_quadrature(saved->quadrature);
    for (const NewtonStep& step : saved->steps) accept(step, observe);
    if (!saved->has_ended) gradient(E, x);
    return saved->has_ended;
}

void Newton::save(const AugmentedFunctional& E, const std::vector<double>& x, const NewtonResult& at, bool has_ended) {
    if (!checkpoint_) return;
    checkpoint_->save({start_, has_ended, at, hessian_, forcing_.value, damping_.factor, negative_part_.value,
                       elimination_.state(), solver_.state(), E.distortion.quadrature(), x, steps_});
}

void Newton::accept(const NewtonStep& step, const NewtonObserver& observe) {
    ++accepted_steps_;
    const bool moves = step.step_length > short_step || last_energy_ - step.energy > unchanged * std::abs(step.energy);
    futile_steps_ = moves ? 0 : futile_steps_ + 1;
    last_energy_ = step.energy;
    if (checkpoint_) steps_.push_back(step);
    if (observe) observe(step);
}

// Where the step before folded elements unseen: another E from now on, at the same x.
bool Newton::refine_quadrature(const AugmentedFunctional& E, const std::vector<double>& x, NewtonResult& at) {
    if (!E.distortion.refine_quadrature()) return false;
    at.energy = E.energy(x);
    at.gradient_norm = gradient(E, x);
    return true;
}

double Newton::gradient(const AugmentedFunctional& E, const std::vector<double>& x) {
    const TimeAdder adder(time.assembly);
    E.gradient(x, g_);
    return norm_2(g_);
}

// The next Hessian to try where `kind` gave no step; false where there is none.
bool Newton::weaken(HessianKind& kind) {
    if (kind == HessianKind::damping) return false;
    if (kind == HessianKind::full) kind = HessianKind::projected;
    else if (negative_part_.value > 0) negative_part_.weaken();
    else kind = HessianKind::damping;
    return true;
}

// Solves H d = -g, weakening the Hessian until d is a descent direction. Names what it used in `step`.
bool Newton::find_direction(const AugmentedFunctional& E, const std::vector<double>& x, NewtonResult& at,
                            NewtonStep& step) {
    for (std::size_t i = 0; i < g_.size(); ++i) minus_g_[i] = -g_[i];
    solver_.set_tolerance(forcing_.value);
    do {
        const bool projected = step.hessian == HessianKind::projected;
        const bool may_be_indefinite = projected ? negative_part_.value > 0 : step.hessian == HessianKind::full;
        {
            const TimeAdder adder(time.assembly);
            Projection projection;
            if (projected) projection = {damping_.factor * E.mean_slope(x, at.energy), negative_part_.value};
            E.hessian(x, step.hessian, H_, projection);
        }
        if (observe_system_) {
            std::vector<double> b;
            to_rows(H_, minus_g_, b);
            observe_system_(H_, b);
        }
        const TimeAdder adder(time.linear);
        const SolveResult solve = solver_.solve(H_, minus_g_, d_, may_be_indefinite);
        elimination_.add_work_of_newton(E.distortion.hessian_passes() + solve.passes);
        hold(E.held, E.distortion.dim(), d_);  // some solvers move them and move them back, to rounding
        at.linear_iterations += solve.iterations;
        step.linear_iterations += solve.iterations;
        step.solver = solve.used;
        step.ilu_shift = solve.diagonal_shift;
        step.preconditioner = solve.used == SolverKind::cholesky ? PreconditionerKind::automatic
                                                                 : solve.preconditioner;
        step.fallback = solve.failed_first;
        const bool truncated = !may_be_indefinite && is_truncated(solve.status);
        if ((solve.status == SolveStatus::success || truncated) && dot(g_, d_) < 0) return true;
    } while (weaken(step.hessian));
    return false;
}

// Moves x along d and takes over the energy there. Nothing changes where no step length is accepted.
LineSearchResult Newton::search(const AugmentedFunctional& E, std::vector<double>& x, NewtonResult& at,
                                NewtonStep& step) {
    const TimeAdder adder(time.line_search);
    const auto energy_of = [&E](const std::vector<double>& y) { return E.energy(y); };
    const auto valid_fraction = [&E](const std::vector<double>& y, const std::vector<double>& to) {
        return E.valid_fraction(y, to);
    };
    BendFunction bend;
    if (E.constraint.bends_steps()) bend = [&](double t, std::vector<double>& y) { E.constraint.bend(x, d_, t, y); };
    const LineSearchResult found = line_search(energy_of, valid_fraction, at.energy, dot(g_, d_), d_, x, trial_,
                                               bend, E.rounding_error(x, trial_));
    if (found.step_length > 0) at.energy = found.energy;
    step.cuts_inverted += found.cuts_inverted;
    step.cuts_decrease += found.cuts_decrease;
    step.step_length = found.step_length;
    return found;
}

// Whether x may be another, or E by a finer quadrature. g_: grad E(x).
bool Newton::eliminate_locally(const AugmentedFunctional& E, double gained, std::vector<double>& x, NewtonResult& at,
                               NewtonStep& step) {
    const TimeAdder adder(time.elimination);
    if (!elimination_.is_due(step.iteration, H_, g_, gained)) return false;
    step.local = elimination_.eliminate(E, H_, g_, gained, x, at.energy);
    at.local_steps += step.local.steps;
    return true;
}

Newton::Newton(BlockCsr pattern, const LinearSolverParams& linear, Forcing forcing)
    : H_(std::move(pattern)),
      solver_(H_.d, linear),
      g_(H_.size()),
      minus_g_(H_.size()),
      d_(H_.size()),
      trial_(H_.size()),
      forcing_{forcing, linear.tolerance} {}

const char* to_string(NewtonStatus status) {
    switch (status) {
        case NewtonStatus::converged: return "converged";
        case NewtonStatus::rounding_floor: return "rounding_floor";
        case NewtonStatus::max_iterations: return "max_newton_iterations";
        case NewtonStatus::line_search_failed: return "line_search_failed";
        case NewtonStatus::linear_solver_failed: return "linear_solver_failed";
        case NewtonStatus::overflow: return "overflow";
        case NewtonStatus::interrupted: return "interrupted";
        case NewtonStatus::out_of_reach: return "out_of_reach";
    }
    return "";
}

const char* to_string(HessianKind kind) {
    switch (kind) {
        case HessianKind::full: return "full";
        case HessianKind::projected: return "projected";
        case HessianKind::damping: return "damping";
    }
    return "";
}

}  // namespace almesh
