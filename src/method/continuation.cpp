#include "method/continuation.hpp"

#include <algorithm>
#include <cmath>

#include "base/interrupt.hpp"
#include "mesh/prolongation.hpp"

namespace almesh {
namespace {

double square(double v) { return v * v; }

// How far a coarse solution is taken: its interpolation on the next mesh is further from the solution there. Relative
// to the motion, whose size is |c_D| of the ideal mesh; |grad E| scales like L^(n - 1) times motion / L.
constexpr double coarse_constraint = 1e-3, coarse_gradient = 0.03;

constexpr double penalty_growth = 10, largest_start_penalty = 1e6;  // from mesh to mesh; in units of |1|^2

AugmentedLagrangianParams loosened(AugmentedLagrangianParams params, const Problem& problem,
                                   const DistortionEnergy& distortion, const BoundaryConstraint& constraint) {
    const int dim = problem.mesh.dim;
    const double motion = constraint.projected_norm(problem.ideal), L = std::pow(distortion.domain_volume(), 1.0 / dim);
    params.algorithm = Algorithm::adaptive;
    params.epsilon_star = std::max(params.epsilon_star, square(coarse_constraint * motion));
    params.omega_star = std::max(params.omega_star, coarse_gradient * motion * std::pow(L, dim - 2));
    return params;
}

// The multipliers as a field on the mesh, after the update that the end of the iterations left out.
std::vector<double> multiplier_field(const BoundaryConstraint& constraint, const std::vector<double>& x,
                                     AlResult& result) {
    constraint.update_multipliers(x, result.iterations.back().mu, result.lambda);
    std::vector<double> field(x.size(), 0.0);
    const std::size_t dim = result.lambda.size() / constraint.nodes().size();
    for (std::size_t t = 0; t < constraint.nodes().size(); ++t)
        std::copy_n(&result.lambda[t * dim], dim, &field[constraint.nodes()[t] * dim]);
    return field;
}

CoarseStage solve_stage(const Deck& deck, Problem problem, Timings& time, CoarseSolution& solution) {
    const DistortionEnergy distortion(problem.mesh, problem.ideal, deck.distortion);
    const BoundaryConstraint constraint(problem.mesh, problem.ideal, problem.target, deck.target);
    Newton newton(distortion, deck.linear, deck.forcing);
    std::vector<double> x;
    const AlStart start = start_from(solution, problem, distortion, constraint, x);
    const AugmentedLagrangianParams params = loosened(deck.method, problem, distortion, constraint);
    AlResult result = minimise(distortion, constraint, newton, params, x, time, {}, start);

    CoarseStage stage;
    stage.nodes = problem.mesh.nodes();
    stage.status = result.status;
    stage.last = result.iterations.back();
    stage.newton_iterations = result.newton_iterations;
    solution = {};
    if (result.status != AlStatus::converged) return stage;
    solution.lambda = multiplier_field(constraint, x, result);
    solution.norm_of_one = constraint.norm_of_one();
    solution.mu = stage.last.mu / square(constraint.norm_of_one());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= problem.ideal[i];
    solution.displacement = std::move(x);
    solution.ideal = std::move(problem.ideal);
    solution.mesh = std::move(problem.mesh);
    return stage;
}

}  // namespace

bool starts_coarse(const Deck& deck) {
    if (deck.start == Start::automatic) return deck.refine > 0 && deck.method.algorithm == Algorithm::adaptive;
    return deck.refine > 0 && deck.start == Start::coarse;
}

CoarseSolution solve_coarser(const Deck& deck, const Problem& problem, Timings& time,
                             const std::function<void(const CoarseStage&)>& observe) {
    CoarseSolution solution;
    if (!starts_coarse(deck)) return solution;
    for (int times = 0; times < deck.refine && !interrupted(); ++times) {
        const Stopwatch watch;
        const double before = time.total;
        CoarseStage stage = solve_stage(deck, coarser_problem(deck, problem, times), time, solution);
        stage.last.seconds = watch.seconds();
        time.total = before + stage.last.seconds;
        observe(stage);
    }
    return solution;
}

AlStart start_from(const CoarseSolution& coarse, const Problem& problem, const DistortionEnergy& distortion,
                   const BoundaryConstraint& constraint, std::vector<double>& x) {
    x = problem.ideal;
    if (coarse.displacement.empty()) return {};
    const auto carried = [&](const std::vector<double>& field) {
        return prolong(coarse.mesh, coarse.ideal, problem.mesh, problem.ideal, field);
    };
    const std::vector<double> displacement = carried(coarse.displacement);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += displacement[i];
    if (!std::isfinite(distortion.energy(x))) {
        x = problem.ideal;
        return {};
    }
    AlStart start;
    start.mu = std::max(coarse.mu, std::min(penalty_growth * coarse.mu, largest_start_penalty));
    const std::vector<double> lambda = carried(coarse.lambda);
    const std::size_t dim = problem.mesh.dim;
    const double scale = coarse.norm_of_one / constraint.norm_of_one();
    for (const int node : constraint.nodes())
        for (std::size_t a = 0; a < dim; ++a) start.lambda.push_back(scale * lambda[node * dim + a]);
    return start;
}

}  // namespace almesh
