// x_k = argmin E over the meshes whose boundary is at g_D(t_k); E does not change. From y = x_{k-1}, the ideal mesh or
//
//     x_{k-1} + (t_k - t_{k-1}) / (t_{k-1} - t_{k-2}) (x_{k-1} - x_{k-2}),
//
// the first step takes the boundary to its target, and the nodes inside to the minimum of the quadratic model at y with
// it there: H_II d_I = -(g_I + H_IB d_B), d_B = g_D - y_B. Newton's method with the boundary fixed goes on. Where that
// step is not valid, Algorithm 1 takes the boundary to its target.
#include "problem/frame_solver.hpp"

#include <cmath>
#include <limits>

#include "problem/solve.hpp"
#include "report/iteration_table.hpp"
#include "base/index.hpp"
#include "method/functional.hpp"
#include "method/levels.hpp"
#include "method/snap.hpp"

namespace almesh {
namespace {

// Whether Algorithm 1 may start from another mesh than the ideal one.
bool may_follow(const ProblemOptions& options) {
    return options.method.moving == MovingMethod::augmented_lagrangian &&
           options.method.algorithm == Algorithm::adaptive && options.distortion.objective != Objective::minimax &&
           options.distortion.delta == 0;
}

// Of a minimisation with the boundary fixed, as Algorithm 1 has it.
bool is_solved(const NewtonResult& result, const AugmentedLagrangianParams& params) {
    return result.status == Status::converged ||
           (at_floor(result.status) && result.gradient_norm <= params.omega0);
}

// Nothing but the distortion, of the nodes that are not fixed. Near its minimum the rounding of eta counts: the energy
// of (eta - 1)^2 is known to 2 (eta - 1) eps, however small it is.
struct Distortion : AugmentedFunctional {
    double rounding = 0;

    Distortion(const Level& level, const std::vector<double>& x, std::vector<char> nodes)
        : AugmentedFunctional(*level.energy, *level.constraint,
                              std::vector<double>(level.constraint->multipliers(), 0.0), 0, std::move(nodes)) {
        constexpr double unit = 4 * std::numeric_limits<double>::epsilon();
        rounding = unit * distortion.mean_slope(distortion.energy(x)) * distortion.domain_volume();
    }
    double rounding_error(const std::vector<double>&, std::vector<double>&) const override { return rounding; }
};

}  // namespace

Solution FrameSolver::solve(const ProblemOptions& options, const FramesBefore& before, FrameRow& row,
                            const AlObserver& observer) {
    if (before.before(row.t) && may_follow(options)) {
        prepare(options);
        std::vector<double> x;
        row.started_from = start(options, row.t, before, x);
        if (!row.started_from.empty()) {
            const HessianKind kind = row.started_from == "ideal" ? HessianKind::damping : HessianKind::full;
            Solution solution = lead(options, x, kind);
            if (solution.al.status == Status::stalled) solution = solve_from(options, x, observer);
            const Status status = solution.al.status;
            if (status == Status::converged || status == Status::interrupted) return solution;
        }
    }
    row.started_from = "anew";
    return solve_anew(options, row, observer);
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

// A quadrature that was refined on the way would be another functional, and so would one that is about to be.
void FrameSolver::prepare(const ProblemOptions& options) {
    const Level& level = *problem_.level;
    if (!level.energy || !level.energy->quadrature().refinements.empty()) set_functional(options, problem_);
    else set_constraint(options, problem_);
    level.energy->set_quadrature({});
}

// x: the nearest to the target of those that lead there. Returns its name, "" for none.
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

// Stalled where the first step is not valid, or there is none.
Solution FrameSolver::lead(const ProblemOptions& options, const std::vector<double>& x, HessianKind kind) {
    Level& level = *problem_.level;
    Solution solution;
    solution.al.status = Status::stalled;
    if (!settles(options)) return solution;
    solution.x = level.with_boundary(level.constraint->targets(x), x);
    std::vector<double> d(x.size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = solution.x[i] - x[i];
    const std::vector<char> fixed = level.on_boundary();
    if (!newton(options).lead(Distortion(level, x, {}), kind, fixed, x, d)) return solution;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (!fixed[i / level.mesh.dim]) solution.x[i] += d[i];
    if (!std::isfinite(level.energy->energy(solution.x)) || !is_valid_between(x, solution.x)) return solution;
    solution.al.newton_iterations = 1;
    solution.al.lambda.assign(level.constraint->multipliers(), 0.0);
    solution.al.iterations.emplace_back();
    solution.al.status = Status::converged;
    settle(options, solution);
    return solution;
}

// Near the solution a large penalty costs no steps. What settles needs no more than to come near.
Solution FrameSolver::solve_from(const ProblemOptions& options, const std::vector<double>& x,
                                 const AlObserver& observer) {
    Level& level = *problem_.level;
    Solution solution;
    solution.x = x;
    const AlStart start = AlStart::from_near(*level.constraint, largest_start_penalty);
    AugmentedLagrangianParams params = options.method;
    if (settles(options)) params.omega_star = std::min(1e3 * params.omega_star, std::max(1e-5, params.omega_star));
    solution.al = minimise(*level.energy, *level.constraint, newton(options), params, solution.x, observer, start);
    if (solution.al.status == Status::converged) place_inside_volumes(problem_, solution.x);
    snap(options, problem_, solution);
    if (settles(options)) settle(options, solution);
    return solution;
}

Solution FrameSolver::solve_anew(const ProblemOptions& options, FrameRow& row, const AlObserver& outer) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> nowhere(std::fopen("/dev/null", "w"), std::fclose);
    IterationTable report(nowhere.get(), {problem_.mesh().dim, problem_.frame.length}, problem_.run_id);
    SolveObserver observer;
    observer.iteration = [&](const AlIteration& of) {
        report.add(of);
        if (outer.iteration) outer.iteration(of);
    };
    observer.newton_step = [&](int al_iteration, const NewtonStep& step) {
        report.add(al_iteration, step);
        if (outer.newton_step) outer.newton_step(al_iteration, step);
    };
    observer.stage = [&report](const Stage& stage) { report.add(stage); };
    Solution solution = almesh::solve(options, problem_, observer);
    row.history += report.rows();
    solution.reached = report.reached;
    if (solution.al.status != Status::converged || !may_follow(options)) return solution;
    prepare(options);
    Solution nearer = solve_from(options, solution.x, outer);  // as near to the minimum as the other frames
    if (nearer.al.status != Status::converged) return solution;
    nearer.al.earlier_newton_iterations = solution.al.newton_iterations + solution.al.earlier_newton_iterations;
    nearer.coarse_newton_iterations = solution.coarse_newton_iterations;
    return nearer;
}

bool FrameSolver::settles(const ProblemOptions& options) const {
    return may_follow(options) && problem_.target.prescribes_all();
}

// Algorithm 1 ends within its tolerances of the target, from wherever it came. With the boundary on the target to the
// last bit, the nodes inside go to their minimum as nearly as it can be computed.
void FrameSolver::settle(const ProblemOptions& options, Solution& solution) {
    Level& level = *problem_.level;
    if (solution.al.status != Status::converged) return;
    solution.al.status = Status::stalled;
    if (nodes_off_target(*level.constraint, solution.x) > 0) return;
    constexpr double of_tolerance = 1e-7;
    const Distortion inside(level, solution.x, level.on_boundary());
    NewtonParams wanted;
    wanted.omega = of_tolerance * options.method.omega_star;
    wanted.first = HessianKind::full;
    const NewtonResult settled = newton(options).minimise(inside, wanted, solution.x);
    add_counts(settled, solution.al);
    if (!is_solved(settled, options.method)) return;
    solution.al.status = Status::converged;
    place_inside_volumes(problem_, solution.x);
    measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
}

}  // namespace almesh
