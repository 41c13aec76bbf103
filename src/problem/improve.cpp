#include "problem/improve.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "problem/base_mesh.hpp"
#include "problem/corner_smoothing.hpp"
#include "problem/curving.hpp"
#include "problem/kept_surface.hpp"
#include "problem/untangling.hpp"
#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/table.hpp"
#include "check/infeasible.hpp"
#include "check/scaled_jacobian.hpp"
#include "check/target_check.hpp"
#include "geometry/patch.hpp"
#include "mesh/local_size.hpp"
#include "mesh/part.hpp"

namespace almesh {
namespace {

bool is_feasible(const Problem& problem, int e) { return problem.infeasible.empty() || problem.infeasible[e].empty(); }

// Least values over the feasible elements, which must not fall: at the corners, and of the certified bound.
struct LeastJacobian {
    double corner = std::numeric_limits<double>::infinity(), certified = corner;
    bool is_below(const LeastJacobian& other) const { return corner < other.corner || certified < other.certified; }
};

LeastJacobian least_jacobian(const Problem& problem, const std::vector<double>& x) {
    const std::vector<double> corner = corner_jacobians(problem.mesh(), x),
                              certified = certify(problem.mesh(), x).lower_bound;
    LeastJacobian least;
    for (int e = 0; e < problem.mesh().element_count(); ++e)
        if (is_feasible(problem, e))
            least = {std::min(least.corner, corner[e]), std::min(least.certified, certified[e])};
    return least;
}

// Feasible elements that are not valid.
std::vector<int> invalid_elements(const Problem& problem, const std::vector<double>& x) {
    std::vector<int> invalid = certify(problem.mesh(), x).uncertified;
    std::erase_if(invalid, [&](int e) { return !is_feasible(problem, e); });
    return invalid;
}

// Whether the file's mesh may be the result: regular ideal elements, and a boundary that stays on its surface.
bool may_stay(const ProblemOptions& options, const Problem& problem) {
    const auto stays = [](const Motion& motion) {
        return is_fixed(motion) || motion == motion_of(NodeKind::slides);
    };
    return options.ideal == IdealKind::regular && std::all_of(problem.motions.begin(), problem.motions.end(), stays);
}

// Valid and injective. With infeasible elements: the others valid, the boundary with no more faults than in the file.
bool is_certified(const Problem& problem, const std::vector<double>& x) {
    const Mesh& mesh = problem.mesh();
    const auto faults = [&](const std::vector<double>& at) {
        return check_target(mesh, at, {}, FaceBend::any).faults.size();
    };
    if (!problem.infeasible.empty())
        return invalid_elements(problem, x).empty() && faults(x) <= faults(mesh.x);
    return certified_injective(problem, x, certify(mesh, x)).certified;
}

// A run that ended at x before Algorithm 1.
Solution ended_at(const Problem& problem, std::vector<double> x, Status status) {
    Solution solution;
    Level& level = *problem.level;
    solution.x = std::move(x);
    solution.al.lambda.assign(level.constraint->multipliers(), 0.0);
    solution.al.iterations.push_back(measured(*level.energy, *level.constraint, solution.x, solution.al.distortion));
    solution.al.status = interrupted() ? Status::interrupted : status;
    return solution;
}

// Lists the elements that the boundary makes invalid: they need not become valid.
void find_infeasible_elements(const ProblemOptions& options, Problem& problem, const std::vector<double>& x,
                              std::FILE* out) {
    set_functional(options, problem);
    auto why = why_infeasible(problem.mesh(), x, *problem.level->constraint, problem.target, problem.sliding.get());
    const auto count = why.size() - std::count(why.begin(), why.end(), "");
    if (count == 0) return;
    print(out, "note: ", counted(count, "element"),
          " invalid whatever the nodes inside do: all others are made better\n");
    problem.infeasible = std::move(why);
}

// Untangles x, the first mesh, which has these invalid elements. Those that stay invalid become infeasible.
void untangle(const ProblemOptions& options, Problem& problem, const std::vector<int>& invalid, std::vector<double>& x,
              int& newton_steps, std::FILE* out) {
    const Mesh& mesh = problem.mesh();
    std::vector<double> volumes = problem.regular;
    for (int e = 0; e < mesh.element_count() && problem.regular.empty(); ++e)
        volumes.push_back(volume(mesh, problem.ideal(), e));
    set_functional(options, problem);
    const auto never = problem.infeasible.size() - std::count(problem.infeasible.begin(), problem.infeasible.end(), "");
    UntanglingResult all{invalid};
    const auto leave_out = [&](const std::vector<int>& elements) {
        if (!elements.empty()) problem.infeasible.resize(mesh.element_count());
        for (const int e : elements)
            if (is_feasible(problem, e)) problem.infeasible[e] = "no positions were found at which it is valid";
        std::erase_if(all.left, [&](int e) { return !is_feasible(problem, e); });
    };
    for (const bool again : {false, true}) {
        const std::size_t count = all.left.size();
        if (again && count > 0)  // others are in their regions
            leave_out(elements_of(
                mesh, {{}, infeasible_elements(mesh, x, held_nodes(mesh, problem.target), flat_jacobian)}));
        if (again && (all.left.empty() || all.left.size() == count)) break;
        const auto energy = make_energy(
            problem, *problem.level,
            {.objective = Objective::tangled, .curved_ideal = true, .regular = problem.regular});
        const UntanglingResult found = untangle_regions(mesh, volumes, *energy, *problem.level->constraint,
                                                        problem.target, options.linear, problem.infeasible, x);
        all = {found.left, all.regions + found.regions, all.newton_iterations + found.newton_iterations};
    }
    leave_out(std::vector(all.left));
    newton_steps += all.newton_iterations;
    const auto left = std::count_if(invalid.begin(), invalid.end(), [&](int e) { return !is_feasible(problem, e); });
    print(out, counted(invalid.size() + never, "element"), " invalid in the file, ",
          left + static_cast<std::ptrdiff_t>(never), " left after ", counted(all.newton_iterations, "Newton step"),
          " in ", counted(all.regions, "region"), "\n");
}

Solution improved(const ProblemOptions& options, Problem& problem, const Solve& solve, int& newton_steps,
                  std::FILE* out) {
    const Mesh& mesh = problem.mesh();
    // A resumed run repeats these steps; only its first solution starts from the mesh so far.
    const std::vector<double> so_far = problem.standing ? std::exchange(problem.start, {}) : std::vector<double>();
    std::vector<double> x = problem.start.empty() ? mesh.x : problem.start;
    const bool was_certified = invalid_elements(problem, x).empty();
    if (!was_certified || !may_stay(options, problem)) find_infeasible_elements(options, problem, x, out);
    const std::vector<int> invalid = invalid_elements(problem, x);
    const bool was_valid = invalid.empty();
    if (!was_valid) untangle(options, problem, invalid, x, newton_steps, out);
    if (std::find(problem.infeasible.begin(), problem.infeasible.end(), "") == problem.infeasible.end() &&
        !problem.infeasible.empty())
        return ended_at(problem, std::move(x), Status::inverted);
    if (!was_certified) {
        const std::size_t told = problem.notes.size();
        take_along_target(problem, problem.start.empty() ? mesh.x : problem.start, x);
        hold_curved_faces(options, problem, x);
        for (std::size_t k = told; k < problem.notes.size(); ++k) print(out, "note: ", problem.notes[k], "\n");
        if (options.ideal != IdealKind::mesh) problem.level->ideal = x;  // the measure of faces and heights
    }
    problem.start = so_far.empty() ? x : so_far;
    const LeastJacobian before = least_jacobian(problem, x);
    const auto is_worse = [&](const Solution& solution) {
        return was_valid && may_stay(options, problem) && least_jacobian(problem, solution.x).is_below(before);
    };
    const auto fails = [&](const Solution& solution) {
        return may_stay(options, problem) && !interrupted() &&
               !(solution.al.status == Status::converged && is_certified(problem, solution.x));
    };
    Solution solution = solve(options, problem);
    problem.start = x;
    if (is_worse(solution) && options.distortion.objective != Objective::minimax && !interrupted()) {
        print(out, "note: an element is worse than the worst of the file: again with objective = minimax\n");
        ProblemOptions other = options;
        other.distortion.objective = Objective::minimax;
        solution = solve(other, problem);
    }
    if (problem.sliding && fails(solution) && is_certified(problem, x)) {
        print(out, "note: no valid mesh was found with nodes that slide: the boundary stays as it is\n");
        fix_boundary(problem, x);
        solution = solve(options, problem);
    }
    if (is_worse(solution) || (fails(solution) && is_certified(problem, x))) {
        print(out, "note: no better mesh was found: the ", was_valid ? "" : "untangled ", "mesh stays as it is\n");
        set_functional(options, problem);
        solution = ended_at(problem, std::move(x), Status::converged);
    }
    return solution;
}

// Measures the last row for all elements, infeasible ones included.
void count_infeasible(const ProblemOptions& options, Problem& problem, Solution& solution) {
    if (problem.infeasible.empty()) return;
    std::vector<std::string> why;
    why.swap(problem.infeasible);
    set_functional(options, problem);
    measure(*problem.level->energy, *problem.level->constraint, solution.x, solution.al.distortion,
            solution.al.iterations.back());
    if (solution.al.status == Status::converged && !invalid_elements(problem, solution.x).empty())
        solution.al.status = Status::inverted;
    why.swap(problem.infeasible);
}

// A boundary on its target without sliding nodes needs no multipliers, which saves half of the Newton steps.
ProblemOptions with_boundary_set(const ProblemOptions& options, const Problem& problem) {
    const auto is_set = [&](const Motion& motion) {
        return is_fixed(motion) || (motion == motion_of(NodeKind::slides) && !problem.sliding);
    };
    ProblemOptions set = options;
    if (std::all_of(problem.motions.begin(), problem.motions.end(), is_set) &&
        options.distortion.objective != Objective::minimax &&
        options.method.moving == MovingMethod::augmented_lagrangian)
        set.method.moving = MovingMethod::boundary_set;
    return set;
}

// For linear simplices, if the file's mesh may stay and no power is asked for.
void raise_worst_corners(const ProblemOptions& options, const Problem& problem, Solution& solution, int& newton_steps,
                         std::FILE* out) {
    const Mesh& mesh = problem.mesh();
    const auto& groups = mesh.element_groups();
    const auto is_simplex = [](const ElementGroup& group) { return group.cell->is_simplex(); };
    if (!may_stay(options, problem) || mesh.degree > 1 || !std::all_of(groups.begin(), groups.end(), is_simplex) ||
        solution.al.status != Status::converged || options.power)
        return;
    const Level& level = *problem.level;
    std::vector<char> fixed = level.on_boundary();
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.element_nodes(e) && !is_feasible(problem, e); ++k) fixed[mesh.element(e)[k]] = 1;
    const CornerSmoothing found = smooth_corners(mesh, fixed, *level.energy, options.linear, solution.x);
    newton_steps += found.newton_steps;
    if (found.after == found.before) return;
    measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
    print(out, "worst corner inside: scaled Jacobian raised from ", rounded_down(found.before, 4), " to ",
          rounded_down(found.after, 4), " in ", counted(found.newton_steps, "Newton step"), "\n");
}

// A curved mesh made better by its vertices alone: the mesh with straight sides on them is improved, and what lies
// between vertices is as far from the straight sides as before. Straight elements stay straight, so that what is
// certified of them is not lowered; curved faces stay, as their vertices do. Returns where it takes the nodes, in the
// problem's frame; nothing where the mesh with straight sides cannot be improved, or faces would leave the surface.
std::vector<double> moved_vertices(const ProblemSetup& setup, const Problem& problem,
                                   const std::function<Solution(const ProblemSetup&, Problem&)>& improve_straight) try {
    ProblemSetup linear = setup;
    linear.degree = 1;
    Problem straight = make_problem(linear, {linear_part(problem.base), true});
    set_regular_elements(straight);
    hold_surface(linear, straight);
    const Solution solution = improve_straight(linear, straight);
    if (solution.al.status != Status::converged) return {};

    const Mesh& mesh = problem.mesh();
    const int dim = mesh.dim;
    Mesh moved = mesh;
    std::vector<char> is_vertex(mesh.nodes(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v < mesh.cell(e).vertices; ++v) is_vertex[mesh.element(e)[v]] = 1;
    std::size_t from = 0;
    for (std::size_t k = 0; k < mesh.x.size(); ++k) {
        if (!is_vertex[k / dim]) continue;
        const double in_file = straight.frame.to_file(solution.x[from], from, dim);
        if (solution.x[from] != straight.mesh().x[from]) moved.x[k] = problem.frame.to_run(in_file, k, dim);
        ++from;
    }
    const std::vector<double> before = straight_sided(mesh), now = straight_sided(moved);
    std::vector<double> x = mesh.x;
    for (std::size_t k = 0; k < x.size(); ++k)
        if (now[k] != before[k]) x[k] = is_vertex[k / dim] ? now[k] : x[k] + (now[k] - before[k]);
    return surface_distance(problem, x) <= setup.surface_tolerance ? x : std::vector<double>();
} catch (const Error&) {
    return {};
}

}  // namespace

void set_regular_elements(Problem& problem) {
    const Mesh& mesh = problem.mesh();
    std::vector<char> valid;
    for (const double bound : certify(mesh, mesh.x).lower_bound) valid.push_back(bound > 0);
    problem.regular = local_volumes(mesh, mesh.x, valid);
}

Solution improve(const ProblemSetup& setup, Problem& problem, const Solve& solve, int& newton_steps, std::FILE* out) {
    const auto improve_near = [&](const ProblemSetup& with, Problem& of) {
        const Solve solve_near = [&](const ProblemOptions& options, const Problem&) {
            const ProblemOptions settings = with_boundary_set(options, of);
            Solution found = best_of_powers(settings, of, solve, out);
            for (int attempt = 0; found.al.status == Status::converged &&
                                  hold_faces_off_surface(settings, of, found.x, attempt, out); ++attempt)
                found = best_of_powers(settings, of, solve, out);
            if (!setup.needs_objective || settings.distortion.objective == Objective::minimax)
                raise_worst_corners(settings, of, found, newton_steps, out);
            return found;
        };
        return improved(with, of, solve_near, newton_steps, out);
    };
    Solution solution = improve_near(setup, problem);
    const Mesh& mesh = problem.mesh();
    if (mesh.degree > 1 && solution.x == mesh.x && may_stay(setup, problem) && !interrupted()) {
        print(out, "the vertices alone are moved, as in a mesh with straight sides:\n");
        std::vector<double> x = moved_vertices(setup, problem, improve_near);
        const LeastJacobian before = least_jacobian(problem, mesh.x);
        const LeastJacobian now = x.empty() ? before : least_jacobian(problem, x);
        const bool is_better = now.corner > before.corner && !now.is_below(before) && is_certified(problem, x);
        if (!is_better) print(out, "note: the mesh with moved vertices is not better either\n");
        else fix_boundary(problem, x);
        set_functional(setup, problem);
        solution = ended_at(problem, is_better ? std::move(x) : mesh.x, Status::converged);
    }
    if (solution.al.status != Status::converged && may_stay(setup, problem) && is_certified(problem, mesh.x) &&
        surface_distance(problem, solution.x) > setup.surface_tolerance) {
        print(out, "note: faces were off the surface at the end: the mesh stays as it is\n");
        set_functional(setup, problem);
        solution = ended_at(problem, mesh.x, solution.al.status);
    }
    if (solution.al.status == Status::converged && setup.needs_tolerance &&
        surface_distance(problem, solution.x) > setup.surface_tolerance)
        solution.al.status = Status::off_surface;
    count_infeasible(setup, problem, solution);
    print_surface(out, setup, problem, solution.x);
    return solution;
}

}  // namespace almesh
