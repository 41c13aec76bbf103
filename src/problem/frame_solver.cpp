// x_k = argmin E over the meshes whose boundary is at g_D(t_k); E does not change. From y = x_{k-1}, the ideal mesh or
//
//     x_{k-1} + (t_k - t_{k-1}) / (t_{k-1} - t_{k-2}) (x_{k-1} - x_{k-2}),
//
// the first step takes the boundary to its target, and the nodes inside to the minimum of the quadratic model at y with
// it there: H_II d_I = -(g_I + H_IB d_B), d_B = g_D - y_B. Newton's method with the boundary fixed goes on. Where this
// predictor is not valid, Algorithm 1 takes the boundary to its target.
#include "problem/frame_solver.hpp"

#include <cmath>

#include "problem/solve.hpp"
#include "base/index.hpp"
#include "method/levels.hpp"
#include "method/polish.hpp"

namespace almesh {
namespace {

// Whether Algorithm 1 may start from another mesh than the ideal one.
bool may_follow(const ProblemOptions& options) {
    return options.method.moving == MovingMethod::augmented_lagrangian &&
           options.method.algorithm == Algorithm::adaptive && options.distortion.objective != Objective::minimax &&
           options.distortion.delta == 0;
}

}  // namespace

Solution FrameSolver::solve(const ProblemOptions& options, const FramesBefore& before, double t,
                            std::string& started_from, const SolveObserver& anew, const AlObserver& observer) {
    if (before.before(t) && may_follow(options)) {
        prepare(options);
        std::vector<double> x;
        started_from = start(options, t, before, x);
        if (!started_from.empty()) {
            const HessianKind kind = started_from == "ideal" ? HessianKind::damping : HessianKind::full;
            Solution solution = predict(options, x, kind);
            if (solution.al.status == Status::stalled) solution = solve_from(options, x, observer);
            const Status status = solution.al.status;
            if (status == Status::converged || status == Status::interrupted) return solution;
        }
    }
    started_from = "anew";
    return solve_anew(options, anew, observer);
}

bool FrameSolver::leads(const ProblemOptions& options, const std::vector<Motion>& before,
                        const std::vector<Motion>& now) const {
    const bool as_written = options.continuation == Continuation::always;
    for (std::size_t b = 0; b < before.size(); ++b)
        if (!leads_to(before[b], now[b], as_written)) return false;
    return true;
}

bool FrameSolver::is_valid_between(const std::vector<double>& from, const std::vector<double>& to) const {
    DistortionEnergy& energy = *problem_.level->energy;
    const QuadratureState as_it_is = energy.quadrature();
    const bool valid = energy.valid_fraction(from, to) == 1;
    energy.set_quadrature(as_it_is);  // no step has been made: nothing is to be refined
    return valid;
}

// Resets refined quadratures, and refinements that are due: each would change the functional of this frame.
void FrameSolver::prepare(const ProblemOptions& options) {
    const Level& level = *problem_.level;
    if (!level.energy || !level.energy->quadrature().refinements.empty()) set_functional(options, problem_);
    else set_constraint(options, problem_);
    level.energy->set_quadrature({});
}

// x: the admissible start nearest to the target. Returns its name, "" if there is none.
std::string FrameSolver::start(const ProblemOptions& options, double t, const FramesBefore& before,
                               std::vector<double>& x) const {
    constexpr double about_equal = 1.1;  // so that rounding does not decide
    constexpr double most_turn = 90;     // as leads_to() has it
    const Level& level = *problem_.level;
    const auto distance = [&](const std::vector<double>& y) { return level.constraint->projected_norm(y); };
    std::string name;
    if (const Moment& last = *before.before(t); leads(options, last.motions, problem_.motions)) {
        name = "before";
        const Moment* const earlier = before.before(last.t);
        x = last.x;
        const double ratio = earlier ? (t - last.t) / (last.t - earlier->t) : 0;
        std::vector<double> beyond = earlier ? earlier->x : std::vector<double>();
        for (std::size_t i = 0; i < beyond.size(); ++i) beyond[i] = x[i] + ratio * (x[i] - beyond[i]);
        if (!beyond.empty() && distance(beyond) < distance(x) && std::isfinite(level.energy->energy(beyond)) &&
            is_valid_between(x, beyond)) {
            name = "beyond";
            x.swap(beyond);
        }
    }
    const auto ideal_is_near = [&] { return name.empty() || distance(level.ideal) <= about_equal * distance(x); };
    if (level.turn <= most_turn && ideal_is_near() && level.is_valid(level.ideal)) {
        name = "ideal";
        x = level.ideal;
    }
    return name;
}

Newton& FrameSolver::newton(const ProblemOptions& options) {
    if (!newton_)
        newton_ = std::make_unique<Newton>(problem_.level->energy->hessian_pattern(), options.linear,
                                           NewtonPolicies{.forcing = options.forcing});
    newton_->forget();  // a frame does not depend on those before it
    return *newton_;
}

// Stalled where the predictor is not valid, or there is none.
Solution FrameSolver::predict(const ProblemOptions& options, const std::vector<double>& x, HessianKind kind) {
    Level& level = *problem_.level;
    Solution solution;
    solution.al.status = Status::stalled;
    if (!is_polished(options)) return solution;
    solution.x = level.with_boundary(level.constraint->targets(x), x);
    solution.al.lambda.assign(level.constraint->multipliers(), 0.0);
    const AugmentedFunctional E(*level.energy, *level.constraint, solution.al.lambda);
    if (!newton(options).predict(E, kind, level.on_boundary(), x, solution.x) ||
        !std::isfinite(level.energy->energy(solution.x)) || !is_valid_between(x, solution.x))
        return solution;
    solution.al.newton_iterations = 1;
    solution.al.iterations.emplace_back();
    polish(options, solution);
    return solution;
}

// Near the solution a large penalty costs no steps. What is polished needs no more than to come near.
Solution FrameSolver::solve_from(const ProblemOptions& options, const std::vector<double>& x,
                                 const AlObserver& observer) {
    Level& level = *problem_.level;
    Solution solution;
    solution.x = x;
    const AlStart start = AlStart::from_near(*level.constraint, largest_start_penalty);
    AugmentedLagrangianParams params = options.method;
    if (is_polished(options)) params.omega_star = std::min(1e3 * params.omega_star, std::max(1e-5, params.omega_star));
    solution.al = minimise(*level.energy, *level.constraint, newton(options), params, solution.x, observer, start);
    if (solution.al.status == Status::converged) place_inside_volumes(problem_, solution.x);
    snap(options, problem_, solution);
    if (is_polished(options) && solution.al.status == Status::converged) polish(options, solution);
    return solution;
}

Solution FrameSolver::solve_anew(const ProblemOptions& options, const SolveObserver& anew, const AlObserver& observer) {
    Solution solution = almesh::solve(options, problem_, anew);
    if (solution.al.status != Status::converged || !may_follow(options)) return solution;
    prepare(options);
    Solution nearer = solve_from(options, solution.x, observer);  // as near to the minimum as the other frames
    if (nearer.al.status != Status::converged) return solution;
    nearer.al.earlier_newton_iterations = solution.al.newton_iterations + solution.al.earlier_newton_iterations;
    nearer.coarse_newton_iterations = solution.coarse_newton_iterations;
    return nearer;
}

bool FrameSolver::is_polished(const ProblemOptions& options) const {
    return may_follow(options) && problem_.target.prescribes_all();
}

// Algorithm 1 ends within its tolerances of the target, from wherever it came: the minimum does not depend on that.
void FrameSolver::polish(const ProblemOptions& options, Solution& solution) {
    constexpr double of_tolerance = 1e-7;
    Level& level = *problem_.level;
    OnTarget E(*level.energy, *level.constraint, level.mesh.nodes());
    const double omega = of_tolerance * options.method.omega_star;
    const NewtonResult polished = almesh::polish(E, newton(options), omega, solution.x);
    add_counts(polished, solution.al);
    const bool is_solved = status_of(polished, options.method.omega0) == Status::converged;
    solution.al.status = is_solved ? Status::converged : Status::stalled;
    if (!is_solved) return;
    place_inside_volumes(problem_, solution.x);
    measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
}

}  // namespace almesh
