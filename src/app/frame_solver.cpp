// x_k = argmin E over the meshes whose boundary is at g_D(t_k), from x_{k-1} or from the ideal mesh; E does not change.
#include "app/frame_solver.hpp"

#include <cmath>

#include "app/solve.hpp"
#include "app/volumes.hpp"
#include "method/functional.hpp"
#include "method/levels.hpp"
#include "method/snap.hpp"

namespace almesh {
namespace {

// Whether Algorithm 1 may start from another mesh than the ideal one.
bool may_follow(const Deck& deck) {
    return deck.method.moving == MovingMethod::augmented_lagrangian &&
           deck.method.algorithm == Algorithm::adaptive && deck.distortion.objective != Objective::minimax &&
           deck.distortion.delta == 0;
}

// Of a minimisation with the boundary fixed, as Algorithm 1 has it.
bool is_solved(const NewtonResult& result, const AugmentedLagrangianParams& params) {
    return result.status == Status::converged ||
           (at_floor(result.status) && result.gradient_norm <= params.omega0);
}

bool is_valid(const Level& level, const std::vector<double>& x) {
    return std::isfinite(level.energy->energy(x)) && level.energy->certified(x);
}

}  // namespace

Solution FrameSolver::solve(const Deck& deck, const FrameBefore& before, std::string& started_from) {
    if (!before.x.empty() && may_follow(deck)) {
        prepare(deck);
        if (const std::vector<double>* const x = start(deck, before, started_from)) {
            Solution solution = solve_from(deck, *x);
            const Status status = solution.al.status;
            if (status == Status::converged || status == Status::interrupted) return solution;
        }
    }
    started_from = "anew";
    return solve_anew(deck);
}

// A quadrature that was refined on the way would be another functional.
void FrameSolver::prepare(const Deck& deck) {
    const Level& level = *problem_.level;
    if (!level.energy || !level.energy->quadrature().refinements.empty()) set_functional(deck, problem_);
    else set_constraint(deck, problem_);
}

// The nearer to the target of the ideal mesh and the one before, of those that lead there; null for none.
const std::vector<double>* FrameSolver::start(const Deck& deck, const FrameBefore& before, std::string& started_from) {
    constexpr double about_equal = 1.1;  // so that rounding does not decide
    constexpr double most_turn = 90;     // as leads_to() has it
    const Level& level = *problem_.level;
    const bool as_written = deck.continuation == Continuation::always;
    bool from_before = true;
    for (std::size_t b = 0; b < before.motions.size(); ++b)
        from_before = from_before && leads_to(before.motions[b], problem_.motions[b], as_written);
    const auto distance = [&](const std::vector<double>& x) { return level.constraint->projected_norm(x); };
    const bool from_ideal = level.turn <= most_turn && is_valid(level, level.ideal) &&
                            (!from_before || distance(level.ideal) <= about_equal * distance(before.x));
    started_from = from_ideal ? "ideal" : "before";
    return from_ideal ? &level.ideal : from_before ? &before.x : nullptr;
}

Newton& FrameSolver::newton(const Deck& deck) {
    if (!newton_) {
        newton_ = std::make_unique<Newton>(problem_.level->energy->hessian_pattern(), deck.linear,
                                           NewtonPolicies{.forcing = deck.forcing});
        fresh_ = newton_->memory();
    }
    newton_->recall(fresh_);
    return *newton_;
}

// Near the solution a large penalty costs no steps. What settles needs no more than to come near.
Solution FrameSolver::solve_from(const Deck& deck, const std::vector<double>& x) {
    Level& level = *problem_.level;
    Solution solution;
    solution.x = x;
    AlStart start;
    start.lambda.assign(level.constraint->multipliers(), 0.0);
    start.mu = largest_start_penalty;
    AugmentedLagrangianParams params = deck.method;
    if (settles(deck)) params.omega_star = std::min(1e3 * params.omega_star, std::max(1e-5, params.omega_star));
    solution.al = minimise(*level.energy, *level.constraint, newton(deck), params, solution.x, {}, start);
    if (solution.al.status == Status::converged) place_inside_volumes(problem_, solution.x);
    snap(deck, level, solution);
    if (settles(deck)) settle(deck, solution);
    return solution;
}

Solution FrameSolver::solve_anew(const Deck& deck) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> nowhere(std::fopen("/dev/null", "w"), std::fclose);
    Report report(nowhere.get(), {problem_.mesh().dim, problem_.frame.length}, problem_.run_id);
    Solution solution = almesh::solve(deck, problem_, nullptr, report, nowhere.get());
    solution.reached = report.reached;
    if (solution.al.status != Status::converged || !may_follow(deck)) return solution;
    prepare(deck);
    Solution nearer = solve_from(deck, solution.x);  // as near to the minimum as the other frames
    if (nearer.al.status != Status::converged) return solution;
    nearer.al.earlier_newton_iterations = solution.al.newton_iterations + solution.al.earlier_newton_iterations;
    nearer.coarse_newton_iterations = solution.coarse_newton_iterations;
    return nearer;
}

bool FrameSolver::settles(const Deck& deck) const {
    return may_follow(deck) && deck.snap != Snap::no && problem_.target.prescribes_all();
}

// Algorithm 1 ends within its tolerances of the target, from wherever it came. With the boundary on the target to the
// last bit, the nodes inside go to their minimum as nearly as it can be computed.
void FrameSolver::settle(const Deck& deck, Solution& solution) {
    Level& level = *problem_.level;
    if (solution.al.status != Status::converged) return;
    solution.al.status = Status::stalled;
    if (nodes_off_target(*level.constraint, solution.x) > 0) return;
    constexpr double of_tolerance = 1e-7;
    std::vector<char> fixed(level.mesh.nodes(), 0);
    for (const int node : level.constraint->nodes()) fixed[node] = 1;
    const AugmentedFunctional inside(*level.energy, *level.constraint,
                                     std::vector<double>(level.constraint->multipliers(), 0.0), 0, fixed);
    NewtonParams wanted;
    wanted.omega = of_tolerance * deck.method.omega_star;
    wanted.first = HessianKind::full;
    const NewtonResult settled = newton(deck).minimise(inside, wanted, solution.x);
    add_counts(settled, solution.al);
    if (!is_solved(settled, deck.method)) return;
    solution.al.status = Status::converged;
    place_inside_volumes(problem_, solution.x);
    measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
}

}  // namespace almesh
