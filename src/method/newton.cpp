// Newton's method:   g = grad E(x);   until |g| <= omega:   H d = -g,   x <- x + t d with E decreasing.
#include "method/newton.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"
#include "method/stopping_tests.hpp"

namespace almesh {

NewtonResult Newton::minimise(const Functional& E, const NewtonParams& params, std::vector<double>& x,
                              const NewtonObserver& observe) {
    NewtonResult at = start(E, params, x);                                    // E(x), g = grad E(x), omega
    StoppingTests tests(params);
    std::optional<Status> ended;
    while (!ended && !(ended = tests.before_step(at))) {                      // |g| <= omega
        refine_quadrature(E, x, at);
        const NewtonResult before = at;
        NewtonStep step{.iteration = ++at.iterations, .hessian = hessian_};
        do {
            if (find_direction(E, x, at, step)) search(E, x, at, step);       // H d = -g,   x <- x + t d
        } while (step.step_length == 0 && filter_more(step.hessian));
        if (step.step_length == 0 && refine_quadrature(E, x, at)) continue;
        if (step.step_length > 0) {
            at.gradient_norm = gradient(E, x);                                // g = grad E(x)
            step.is_last = tests.is_last(before, at);
            eliminate_locally(E, before.energy - at.energy, x, at, step);
            report(at, x, step, observe);
        }
        ended = tests.after_step(step, before, at, E, x);
        if (!ended) adapt(step, before, at);                                  // the next H
    }
    at.status = *ended;
    return at;
}

NewtonResult Newton::start(const Functional& E, const NewtonParams& params, const std::vector<double>& x) {
    if (params.cold_start) {
        damping_.reset();
        filtering_ = EigenvalueFiltering::of_mesh();
        elimination_.was_hard = elimination_.is_hard = false;
    }
    elimination_.from_coarser = params.from_coarser;
    hessian_ = params.cold_start ? HessianKind::damping : params.first;
    forcing_.start();
    NewtonResult at;
    at.start_energy = at.energy = E.energy(x);
    at.gradient_norm = gradient(E, x);
    const double reduced = params.reduction < 1 ? params.reduction * at.gradient_norm : params.omega;
    at.omega = std::max(std::min(params.omega, reduced), params.omega_star);
    return at;
}

// Refines the quadrature, and so changes E, if a trial step inverted elements between its points, or elements are bent.
bool Newton::refine_quadrature(const Functional& E, const std::vector<double>& x, NewtonResult& at) {
    if (!E.refine_quadrature(x)) return false;
    at.start_energy = at.energy = E.energy(x);
    at.gradient_norm = gradient(E, x);
    return true;
}

double Newton::gradient(const Functional& E, const std::vector<double>& x) {
    const TimeAdder adder(time.assembly);
    E.gradient(x, g_);
    return norm_2(g_);
}

// Solves H d = -g; returns whether d is a descent direction. Records the solver in `step`.
bool Newton::find_direction(const Functional& E, const std::vector<double>& x, NewtonResult& at, NewtonStep& step) {
    for (std::size_t i = 0; i < g_.size(); ++i) minus_g_[i] = -g_[i];
    const bool projected = step.hessian == HessianKind::projected;
    const bool may_be_indefinite = projected ? filtering_.kept > 0 : step.hessian == HessianKind::full;
    {
        const TimeAdder adder(time.assembly);
        Projection projection{.kept_negative = filtering_.kept};
        if (projected && damping_.is_used)
            projection.damping = damping_.factor * E.distortion.mean_slope(E.distortion_energy(x, at.energy));
        E.hessian(x, projected && projection.is_full() ? HessianKind::full : step.hessian, H_, projection);
    }
    const TimeAdder adder(time.linear);
    solver_.set_tolerance(forcing_.value);
    const SolveResult solve = solver_.solve(H_, minus_g_, d_, may_be_indefinite);
    const double work = E.distortion.hessian_work() + solve.work;
    elimination_.work_of_newton += work;
    at.work += work;
    E.fix(d_);  // some solvers move fixed nodes by rounding errors
    at.linear_iterations += solve.iterations;
    step.linear_iterations += solve.iterations;
    step.solver = solve.used;
    step.ilu_shift = solve.diagonal_shift;
    step.preconditioner = solve.used == SolverKind::cholesky ? PreconditionerKind::automatic : solve.preconditioner;
    step.fallback = solve.failed_first;
    // Every iterate of conjugate gradients with a positive definite preconditioner is a descent direction (truncated
    // Newton: Nocedal & Wright, sec. 7.1). If the Hessian is indefinite, another Hessian is better.
    const bool truncated = !may_be_indefinite && (solve.status == SolveStatus::stagnated ||
                                                  solve.status == SolveStatus::max_iterations ||
                                                  solve.status == SolveStatus::not_positive_definite);
    return step.has_direction = (solve.status == SolveStatus::success || truncated) && dot(g_, d_) < 0;
}

// Moves x along d and takes over the energy there. Nothing changes where no step length is accepted. A corrected step
// that is cut is tried again with the inside corrected as well, which takes another linear system: not where these are
// solved by iterations, whose preconditioners go from one system to the next.
void Newton::search(const Functional& E, std::vector<double>& x, NewtonResult& at, NewtonStep& step) {
    const auto energy_of = [&E](const std::vector<double>& y) { return E.energy(y); };
    const auto valid_fraction = [&E](const std::vector<double>& y, const std::vector<double>& to) {
        return E.valid_fraction(y, to);
    };
    const double rounding = E.rounding_error(x, trial_);
    const auto search_along = [&](const Correction& correct, std::vector<double>& from) {
        const TimeAdder adder(time.line_search);
        return line_search(energy_of, valid_fraction, at.energy, dot(g_, d_), d_, from, trial_, correct, rounding);
    };
    start_ = x;
    const Correction correct = E.correction(start_, d_);
    LineSearchResult found = search_along(correct, x);
    if (correct && found.step_length < 1 && step.solver == SolverKind::cholesky && !step.fallback) {
        std::vector<double> y = start_;
        std::vector<double> w = correction_of_inside(start_, correct, at);
        if (!w.empty()) E.distortion.pairs().spread(w);
        const Correction correct_all = [&](double t, std::vector<double>& z) {
            for (std::size_t i = 0; i < w.size(); ++i) z[i] += t * t * w[i];
            correct(t, z);
        };
        const LineSearchResult corrected = w.empty() ? LineSearchResult() : search_along(correct_all, y);
        if (corrected.step_length > 0 && (found.step_length == 0 || corrected.energy < found.energy)) {
            found = corrected;
            x.swap(y);
        }
    }
    if (found.step_length > 0) at.energy = found.energy;
    step.cuts_inverted += found.cuts_inverted;
    step.cuts_decrease += found.cuts_decrease;
    step.step_length = found.step_length;
    step.by_rounding = found.by_rounding;
}

// The boundary of x + t d is corrected by t^2 B, to second order in t, which is measured at a small t. The inside
// follows by t^2 w, so that cells beside the boundary keep their heights: w = B at nodes that are corrected, H w = 0 at
// the others. Empty where none is.
std::vector<double> Newton::correction_of_inside(const std::vector<double>& x, const Correction& correct,
                                                 NewtonResult& at) {
    constexpr double small_move = 1e-4, flat = 1e-6;  // in units of the run; flat: curvature
    double longest = 0;
    for (const double component : d_) longest = std::max(longest, std::abs(component));
    const double t = std::min(1.0, small_move / longest);
    std::vector<double> B(x.size()), y(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) B[i] = y[i] = x[i] + t * d_[i];
    correct(t, y);
    std::vector<char> is_corrected(x.size() / H_.d, 0);
    for (std::size_t i = 0; i < x.size(); ++i) {
        B[i] = (y[i] - B[i]) / (t * t);
        if (std::abs(B[i]) > flat * longest * longest) is_corrected[i / H_.d] = 1;
    }
    if (std::count(is_corrected.begin(), is_corrected.end(), 1) == 0) return {};
    return with_inside(is_corrected, {}, std::move(B), at);
}

bool Newton::predict(const Functional& E, HessianKind kind, const std::vector<char>& fixed,
                     const std::vector<double>& x, std::vector<double>& to) {
    if (H_.in_half()) return false;  // whose parts take part in no product
    gradient(E, x);
    E.hessian(x, kind, H_);
    NewtonResult counts;
    forcing_.start();
    solver_.set_tolerance(forcing_.value);
    std::vector<double> d(x.size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = to[i] - x[i];
    d = with_inside(fixed, g_, std::move(d), counts);
    if (!d.empty()) E.distortion.pairs().spread(d);
    for (std::size_t i = 0; i < d.size(); ++i)
        if (!fixed[i / H_.d]) to[i] += d[i];
    return !d.empty();
}

// d + e, where e minimises the model over the free nodes: H_II e_I = -(g + H d)_I. Empty if the solver fails.
std::vector<double> Newton::with_inside(const std::vector<char>& fixed, const std::vector<double>& g,
                                        std::vector<double> d, NewtonResult& at) {
    const TimeAdder adder(time.linear);
    BlockCsr of_inside = H_;
    std::vector<double> force = times_at_nodes(H_, d), inside;
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = g.empty() ? -force[i] : -force[i] - g[i];
    fix_nodes(fixed, H_.d, force);
    fix_nodes(fixed, of_inside);
    const SolveResult solve = solver_.solve(of_inside, force, inside);
    at.work += solve.work;
    if (solve.status != SolveStatus::success) return {};
    for (std::size_t i = 0; i < d.size(); ++i) d[i] += inside[i];
    return d;
}

// Where `kind` gave no step, the next Hessian to try: with less of its negative eigenvalues, at last the damping alone.
// False where there is none.
bool Newton::filter_more(HessianKind& kind) {
    if (kind == HessianKind::damping) return false;
    if (kind == HessianKind::full) kind = HessianKind::projected;
    else if (filtering_.kept > 0) filtering_.filter_more();
    else if (damping_.is_used) kind = HessianKind::damping;
    else return false;
    return true;
}

// gained: decrease of E by the last step. Changes x, and E if it refines the quadrature.
void Newton::eliminate_locally(const Functional& E, double gained, std::vector<double>& x, NewtonResult& at,
                               NewtonStep& step) {
    const TimeAdder adder(time.elimination);
    if (step.by_rounding || step.is_last || !elimination_.is_due(step.iteration, H_, g_, gained)) return;
    step.local = elimination_.eliminate(E, H_, g_, gained, x, at.energy);
    at.local_steps += step.local.steps;
    at.work += step.local.work;
    at.gradient_norm = gradient(E, x);
}

void Newton::report(const NewtonResult& at, const std::vector<double>& x, NewtonStep& step,
                    const NewtonObserver& observe) {
    step.energy = at.energy;
    step.gradient_norm = at.gradient_norm;
    ++steps_;
    if (observe) observe(step);
    if (observe_iterate_) observe_iterate_(steps_, x);
}

// Chooses the next Hessian and the tolerance of its linear system.
void Newton::adapt(const NewtonStep& step, const NewtonResult& before, const NewtonResult& at) {
    forcing_.after_step(step.step_length, before.gradient_norm, at.gradient_norm, at.omega);
    if (filtering_.only_direct && step.solver != SolverKind::cholesky) filtering_ = EigenvalueFiltering::of_mesh();
    else if (step.hessian == HessianKind::projected) filtering_.after_step(step.step_length);
    hessian_ = damping_.after_step(step.step_length);
}

void Newton::forget() {
    damping_ = {};
    filtering_ = EigenvalueFiltering::of_mesh();
    elimination_ = {};
    solver_.forget();
}

Newton::Newton(BlockCsr pattern, const LinearSolverParams& linear, const NewtonPolicies& policies)
    : H_(std::move(pattern)),
      solver_(H_.d, linear),
      g_(H_.size()),
      minus_g_(H_.size()),
      d_(H_.size()),
      trial_(H_.size()),
      forcing_{policies.forcing, linear.tolerance},
      damping_(policies.damping),
      filtering_(policies.filtering),
      elimination_(policies.elimination) {}

}  // namespace almesh
