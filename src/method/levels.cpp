// u_fine = interpolation of u_coarse, lambda_fine = lambda_coarse |1|_coarse / |1|_fine, mu_fine = 100 mu_coarse.
#include "method/levels.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/interrupt.hpp"
#include "mesh/mesh.hpp"

namespace almesh {
namespace {

constexpr double penalty_growth = 100;  // from mesh to mesh
constexpr double nearer = 0.5;  // distance to the target over the ideal mesh's: else curving is all that is left
constexpr int few_steps = 20;  // on a level that is worth little
constexpr double of_gradient = 0.0005;  // tolerance on coarser meshes: a step there is cheaper than one more here

Stage solve_level(const MethodParams& params, Timings& time, std::unique_ptr<Level> level, CoarseSolution& solution) {
    Newton newton(level->energy->hessian_pattern(), params.linear, {.forcing = params.forcing});
    if (params.observe_iterate)
        newton.observe_iterates([&](int, const std::vector<double>& at) { params.observe_iterate(*level, at); });
    std::vector<double> x;
    const AlStart start = start_from(solution, *level, x);
    MethodParams loose = params;
    loose.schedule = loosened(params.schedule, *level, of_gradient);
    loose.is_start = true;
    if (level->is_worth_little) {
        loose.schedule.max_newton_iterations = std::min(loose.schedule.max_newton_iterations, few_steps);
        loose.continuation = Continuation::never;
    }
    const AlResult result = minimise_in_increments(*level, newton, loose, x, start);
    if (result.status == Status::interrupted && params.observe_iterate) params.observe_iterate(*level, x);
    time += newton.time;

    const Stage stage{level->mesh.nodes(), result.status, result.iterations.back(),
                      result.newton_iterations + result.earlier_newton_iterations};
    solution = {};
    if (result.status != Status::converged) return stage;
    params.standing->fraction = 1;
    const std::vector<double> zero(x.size(), 0.0);
    solution.multipliers = level->with_boundary(level->constraint->multiplier_field(result.lambda), zero);
    solution.mu = stage.last.mu / std::pow(level->constraint->norm_of_one(), 2);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= level->ideal[i];
    solution.displacement = std::move(x);
    level->energy.reset();  // the largest part of it
    solution.level = std::move(level);
    return stage;
}

}  // namespace

CoarseSolution solve_coarser(int levels, const std::function<std::unique_ptr<Level>(int)>& make_level,
                             const MethodParams& params, Timings& time, const StageObserver& observe) {
    CoarseSolution solution;
    for (int k = 0; k < levels && !interrupted(); ++k) {
        const Stopwatch watch;
        const double before = time.total;
        Stage stage = solve_level(params, time, make_level(k), solution);
        stage.last.seconds = watch.seconds();
        time.total = before + stage.last.seconds;
        observe(stage);
    }
    return solution;
}

AlStart start_from(const CoarseSolution& coarse, const Level& level, std::vector<double>& x) {
    x = level.ideal;
    if (!coarse.level) return {};
    const auto carried = [&](const std::vector<double>& field) {
        return prolong(coarse.level->mesh, coarse.level->ideal, level.mesh, level.ideal, field);
    };
    const std::vector<double> displacement = carried(coarse.displacement);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += displacement[i];
    const auto distance = [&](const std::vector<double>& at) { return level.constraint->projected_norm(at); };
    const bool useless = level.mesh.degree > coarse.level->mesh.degree && distance(x) > nearer * distance(level.ideal);
    if (useless || !level.is_valid(x)) {
        x = level.ideal;
        return {};
    }
    AlStart start;
    start.from_coarser = true;
    start.mu = std::max(coarse.mu, std::min(penalty_growth * coarse.mu, largest_start_penalty));
    const std::vector<double> multipliers = carried(coarse.multipliers);
    const double scale = coarse.level->constraint->norm_of_one() / level.constraint->norm_of_one();
    std::vector<double> field;
    for (const int node : level.constraint->nodes())
        for (int a = 0; a < level.mesh.dim; ++a) field.push_back(scale * point(multipliers, node, level.mesh.dim)[a]);
    start.lambda = level.constraint->multipliers_of_field(field);
    return start;
}

}  // namespace almesh
