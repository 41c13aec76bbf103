#include "problem/solve.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"
#include "check/boundary_distance.hpp"
#include "io/patch.hpp"
#include "mesh/inner_boundary.hpp"
#include "method/levels.hpp"
#include "method/p_norm.hpp"
#include "method/polish.hpp"
#include "problem/curving.hpp"
#include "problem/improve.hpp"
#include "problem/memory.hpp"
#include "problem/problem.hpp"

namespace almesh {
namespace {

bool starts_coarse(const ProblemOptions& options) {
    if (options.start == Start::automatic) return options.method.algorithm == Algorithm::adaptive;
    return options.start == Start::coarse;
}

// Whether the identity map with a large penalty is as good a start as the solution of a lower degree, at no cost: in
// 2D, if the motion keeps the boundary's vertices and only curves what is between them, and if the Hessian at the
// identity is not zero (with Eq. 5 it is).
bool identity_is_near(const ProblemOptions& options, const Problem& problem) {
    const Mesh& mesh = problem.mesh();
    if (mesh.dim != 2 || mesh.degree == 1 || !problem.target.prescribes_all()) return false;
    if (options.distortion.objective != Objective::squared) return false;
    const double rounding = 1e-9 * std::sqrt(volume(mesh, problem.ideal()));
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int i = 0; i < mesh.dim; ++i) {
            const double* const from = point(problem.ideal(), mesh.face(f)[i], mesh.dim);
            const double* const to = problem.target.node_of(mesh, f) + i * mesh.dim;
            if (std::hypot(to[0] - from[0], to[1] - from[1]) > rounding) return false;
        }
    return true;
}

// From coarse to fine: linear meshes refined 0, 1, ... times, then as fine as the deck's own of degree 1, 2, 4, ...;
// none where the identity is near.
std::vector<CoarserMesh> coarser_meshes(const ProblemOptions& options, const Problem& problem) {
    std::vector<CoarserMesh> coarser;
    if (problem.is_own_ideal || identity_is_near(options, problem)) return coarser;
    for (int refinements = 0; refinements < options.refine; ++refinements) coarser.push_back({refinements, 1});
    // The file's own curves are known from its degree on; but where nodes slide, they find their way at lower ones.
    const int of_file = problem.target.frees() ? 1 : problem.shape().degree;
    for (int degree = 1; degree < problem.mesh().degree; degree = std::max(2 * degree, of_file))
        coarser.push_back({options.refine, degree});
    return coarser;
}

// Distances of the boundary from where the motions take it. Those of faces, if the target was changed or is curved, are
// from the target of the motions, on boundaries that do not slide along another mesh.
void measure_boundary(const Problem& problem, Solution& solution) {
    const Mesh& mesh = problem.mesh();
    const BoundaryTarget& target = problem.target;
    const std::vector<double> x = final_positions(problem, solution.x);
    const auto count = [](const auto& some) { return static_cast<int>(std::count(some.begin(), some.end(), 1)); };
    solution.off_motion = off_motion(mesh, target, problem.sliding.get(), problem.node_target, x);
    solution.straight_faces = count(straight_faces(problem));
    solution.freed_nodes = count(freed_nodes(mesh, target));
    if (problem.sliding) solution.surface_distance = distance_from_surfaces(mesh, target, *problem.sliding, solution.x);
    if (solution.freed_nodes + solution.straight_faces == 0 && (problem.base.degree == 1 || target.prescribes_all()))
        return;
    std::vector<char> measured;
    for (std::size_t b = 0; b < problem.motions.size(); ++b) {
        const Motion& motion = problem.motions[b];
        const bool leaves_out = !problem.placed.empty() && !problem.placed[b].left_out.empty();
        measured.push_back(kind_of(motion) != NodeKind::free && !leaves_out && !surface_step(motion));
    }
    BoundaryTarget original = target;
    original.node = problem.curves_in_place ? target.written : problem.node_target;
    solution.distances = boundary_distances(mesh, at_target(mesh, original, x), x, measured);
}

// Whether the boundary is on its target, as far as Algorithm 1 tests it.
bool constrained(const ProblemOptions& options, const AlIteration& row) {
    const bool adaptive = options.method.algorithm == Algorithm::adaptive;
    return row.projected_constraint_norm * row.projected_constraint_norm <= options.method.epsilon_star &&
           (!adaptive || row.relative_boundary_error <= options.method.wall_tolerance);
}

AlResult minimise_objective(const ProblemOptions& options, const Level& level, Newton& newton,
                            const MethodParams& params,
                            std::vector<double>& x, const AlStart& start, const AlObserver& observer,
                            const StageObserver& observe_part) {
    constexpr int last_power = 64;
    if (options.distortion.objective != Objective::minimax)
        return minimise_in_increments(level, newton, params, x, start, observer, observe_part);
    return minimise_p_norm(level, newton, params, options.power.value_or(last_power), x, start, observer, observe_part);
}

}  // namespace

std::vector<double> final_positions(const Problem& problem, const std::vector<double>& solution) {
    const Mesh& mesh = problem.mesh();
    const int dim = mesh.dim;
    std::vector<double> x = problem.frame.to_file(solution, dim);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (solution[i] == mesh.x[i]) x[i] = problem.file_x[i];
    for (std::size_t k = mesh.faces.size(); k-- > 0;)  // the first face that holds a node decides
        if (const int i = mesh.faces[k]; std::equal(point(solution, i, dim), point(solution, i, dim) + dim,
                                                    &problem.target.node[k * dim]))
            std::copy_n(&problem.node_target[k * dim], dim, point(x, i, dim));
    problem.pairs.settle(problem.file_x, x);
    return x;
}

void place_inside_volumes(const Problem& problem, std::vector<double>& x) {
    const Mesh& mesh = problem.mesh();
    const int dim = mesh.dim;
    const auto is_volume = [](const std::string& name) { return name.starts_with(volume_group("")); };
    if (std::none_of(mesh.boundaries.begin(), mesh.boundaries.end(), is_volume)) return;
    const std::vector<double> X = problem.frame.to_file(mesh.x, dim);
    std::vector<char> is_on_face(mesh.nodes(), 0);
    for (const int node : mesh.faces) is_on_face[node] = 1;
    std::vector<double> trial = x;
    for (const GroupCells& volume : volume_groups(mesh)) {
        const int boundary = mesh.boundary_index(volume_group(volume.name));
        if (boundary < 0) continue;
        const PlacedNodes& placed = problem.level_placed;
        const std::vector<double>& from = placed.empty() || placed[boundary].x.empty() ? X : placed[boundary].x;
        for (const int e : volume.cells)
            for (int i = 0; i < mesh.element_nodes(e); ++i) {
                const int node = mesh.element(e)[i];
                if (is_on_face[node]) continue;
                double at[3] = {};
                std::copy_n(point(from, node, dim), dim, at);
                if (!apply(problem.motions[boundary], dim, at)) continue;
                for (int a = 0; a < dim; ++a) point(trial, node, dim)[a] = problem.frame.to_run(at[a], a, dim);
            }
    }
    DistortionEnergy& energy = *problem.level->energy;
    if (trial != x && std::isfinite(energy.energy(trial)) && energy.valid_fraction(x, trial) == 1) x = std::move(trial);
}

// Measures the last row for the mesh that is written.
void snap(const ProblemOptions& options, const Problem& problem, Solution& solution) {
    const bool converged = solution.al.status == Status::converged;
    const bool adaptive = options.method.algorithm == Algorithm::adaptive;
    const bool all = adaptive && converged;
    if (!all && (options.method.moving != MovingMethod::augmented_lagrangian || !(adaptive || converged) ||
                 !std::isfinite(solution.al.distortion.max_distortion)))
        return;
    Level& level = *problem.level;
    level.pairs.settle(level.mesh.x, solution.x);
    std::vector<char> fixed(level.mesh.nodes(), all);
    const BoundaryTarget& target = problem.target;
    for (std::size_t k = 0; k < level.mesh.faces.size(); ++k)
        if (std::min(target.kind[k], target.written_kind[k]) == NodeKind::fixed) fixed[level.mesh.faces[k]] = 1;
    snap_to_targets(*level.energy, *level.constraint, solution.x, fixed);
    measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
}

// What is certified is what will be read: far from the file's origin its numbers have fewer digits than those of the
// run, a file may have short ones, and nodes that it does not have lie where others put them.
void round_as_file(const Problem& problem, std::vector<double>& x) {
    if (problem.frame.origin == Vec<3>{} && is_read_back(problem.mesh().file)) return;
    x = read_back(problem.mesh().file, final_positions(problem, x));
    problem.frame.take_to_run(x, problem.mesh().dim);
}

void examine(const ProblemOptions& options, const Problem& problem, Solution& solution) {
    const TimeAdder adder(solution.time.certify);
    Level& level = *problem.level;
    solution.certificate = certify(level.mesh, solution.x);
    solution.injectivity = certified_injective(problem, solution.x, solution.certificate);
    solution.size_skew = size_skew(level.mesh, level.ideal, solution.x);
    solution.refined_elements = level.energy->refined_elements();
    solution.max_boundary_error =
        std::max(level.constraint->max_error(solution.x), level.constraint->error_between_nodes(solution.x));
    solution.nodes_off_target = nodes_off_target(*level.constraint, solution.x);
    measure_boundary(problem, solution);
    solution.diagnosis = diagnose(options, problem, solution);
}

Diagnosis diagnose(const ProblemOptions& options, const Problem& problem, const Solution& solution) {
    Level& level = *problem.level;
    const Status status = solution.al.status;
    if (status == Status::converged && solution.injectivity.certified) return {};
    const LastMesh last = {level.mesh,        level.ideal,    solution.x,
                           *level.constraint, problem.target, solution.al.distortion.element_max};
    const auto farthest = [&] { return farthest_off_target(last); };
    const auto unbalanced = [&] { return least_balanced(last, solution.al.gradient); };
    switch (status_row(status).cause) {
        case Cause::validity:
            if (!solution.certificate.valid) return least_valid(last, solution.certificate.certified_bound);
            return status == Status::converged ? overlapping(last, solution.injectivity) : farthest();
        case Cause::gradient: return unbalanced();
        case Cause::distortion: return most_distorted(last);
        case Cause::boundary: return farthest();
        case Cause::boundary_or_gradient:
            return constrained(options, solution.al.iterations.back()) ? unbalanced() : farthest();
    }
    return {};
}

Solution solve(const ProblemOptions& options, const Problem& problem, const SolveObserver& observer, MeshSoFar* so_far,
               bool goes_on) {
    const Stopwatch watch;
    Solution solution;
    const bool coarse_first = starts_coarse(options) && problem.start.empty();
    const auto coarser = coarse_first ? coarser_meshes(options, problem) : std::vector<CoarserMesh>();
    const auto make_level = [&](int k) { return coarser_level(options, problem, coarser[k]); };
    const auto add_stage = [&](const Stage& stage) {
        if (observer.stage) observer.stage(stage);
        solution.coarse_newton_iterations += stage.newton_iterations;
    };
    const StageObserver add_part = [&](const Stage& stage) {
        if (observer.stage) observer.stage(stage);
        if (stage.status == Status::converged && stage.fraction < 1)
            solution.reached = std::max(solution.reached, stage.fraction);
    };
    MethodParams params = {options.method, options.linear, options.forcing, continuation_of(options)};
    params.goes_on = goes_on;
    if (so_far) {
        params.observe_iterate = [so_far](const Level& level, const std::vector<double>& x) { so_far->keep(level, x); };
        params.standing = so_far->standing;
        if (!goes_on) *params.standing = {};
    }
    const CoarseSolution coarse =
        solve_coarser(static_cast<int>(coarser.size()), make_level, params, solution.time, add_stage);
    solution.time.coarse = solution.time.total;

    Level& level = *problem.level;
    set_functional(options, problem);  // Eq. 6

    Standing& standing = *params.standing;
    AlObserver observe_al = observer;
    observe_al.multipliers = [&standing](const std::vector<double>& lambda, double mu) {
        standing.lambda = lambda;
        standing.mu = mu;
        standing.x.clear();
    };
    const bool from_file = !problem.start.empty();
    if (from_file) solution.x = problem.start;
    AlStart start = from_file ? AlStart::from_near(*level.constraint) : start_from(coarse, level, solution.x);
    if (goes_on) start.mu = standing.mu;
    if (goes_on && standing.lambda.size() == start.lambda.size()) start.lambda = standing.lambda;
    if (starts_coarse(options) && identity_is_near(options, problem)) start.mu = largest_start_penalty;
    Newton newton(level.energy->hessian_pattern(), options.linear, {.forcing = options.forcing});
    if (observer.begins) observer.begins(newton, solution.x);
    solution.time.setup = watch.seconds() - solution.time.coarse;
    solution.al = minimise_objective(options, level, newton, params, solution.x, start, observe_al, add_part);
    solution.time += newton.time;
    if (so_far && solution.al.status == Status::interrupted) so_far->write(level, solution.x);
    if (solution.al.status == Status::linear_solver_failed)
        solution.refused_bytes = newton.linear_solver().refused_bytes();
    if (solution.al.status == Status::converged) place_inside_volumes(problem, solution.x);
    snap(options, problem, solution);
    return solution;
}

Solution solve_as_needed(const ProblemSetup& setup, Problem& problem, const WholeObserver& observer, MeshSoFar& so_far,
                         std::FILE* out) {
    const Stopwatch watch;
    const bool improves = is_improved(setup.ideal);
    bool goes_on = problem.standing && !improves;
    if (goes_on) *so_far.standing = *problem.standing;
    goes_on = goes_on && problem.standing->attempt < 0;  // the first solution, which is of the whole mesh
    int newton_steps = 0;  // of all solutions, parts and attempts, whatever became of them
    const Solve solve_one = [&](const ProblemOptions& options, const Problem& of) {
        const bool is_kept = so_far.standing->attempt < 0 && &of == &problem;
        MeshSoFar* const kept = is_kept ? &so_far : nullptr;
        Solution found = solve(options, of, observer.solution(of, kept), kept, std::exchange(goes_on, false));
        newton_steps += found.newton_steps();
        return found;
    };
    const StageObserver add_part = [&](const Stage& part) {
        observer.part(part);
        newton_steps += part.newton_iterations;
    };
    Solution solution = problem.curves_in_place ? curve_in_place(setup, problem, solve_one, add_part, so_far, out)
                        : improves              ? improve(setup, problem, solve_one, so_far, newton_steps, out)
                                                : solve_one(setup, problem);
    solution.al.earlier_newton_iterations += newton_steps - solution.newton_steps();
    if (problem.curves_in_place || improves) solution.time.total = watch.seconds();
    solution.predicted_bytes = predicted_bytes(problem.mesh(), linear_of(setup, problem.pairs));
    return solution;
}

}  // namespace almesh
