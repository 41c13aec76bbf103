#include "problem/improve.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "problem/base_mesh.hpp"
#include "problem/corner_smoothing.hpp"
#include "problem/curving.hpp"
#include "problem/improvement_guard.hpp"
#include "problem/kept_surface.hpp"
#include "problem/untangling.hpp"
#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/stopwatch.hpp"
#include "base/table.hpp"
#include "check/infeasible.hpp"
#include "check/scaled_jacobian.hpp"
#include "check/target_check.hpp"
#include "constraint/sliding_nodes.hpp"
#include "mesh/local_size.hpp"
#include "mesh/part.hpp"

namespace almesh {
namespace {

// Feasible elements that are not valid.
std::vector<int> invalid_elements(const Problem& problem, const std::vector<double>& x) {
    std::vector<int> invalid = certify(problem.mesh(), x).uncertified;
    std::erase_if(invalid, [&](int e) { return !problem.is_feasible(e); });
    return invalid;
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
    const auto never = problem.infeasible.size() - std::count(problem.infeasible.begin(), problem.infeasible.end(), "");
    set_functional(options, problem);
    const UntanglingResult found = almesh::untangle(options, problem, invalid, x);
    newton_steps += found.newton_iterations;
    const auto left = std::count_if(invalid.begin(), invalid.end(), [&](int e) { return !problem.is_feasible(e); });
    print(out, counted(invalid.size() + never, "element"), " invalid in the file, ",
          left + static_cast<std::ptrdiff_t>(never), " left after ", counted(found.newton_iterations, "Newton step"),
          " in ", counted(found.regions, "region"), "\n");
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

// One mesh, made valid and then better.
class Improvement {
public:
    std::string sizes_text;          // of a mesh that was made better,
    std::optional<double> distance;  // and how far its surface is from the file's, if that was measured

    Improvement(const ProblemSetup& setup, Problem& problem, const Solve& solve, MeshSoFar& so_far, int& newton_steps,
                std::FILE* out)
        : setup_(setup), problem_(problem), solve_(solve), so_far_(so_far), newton_steps_(newton_steps), out_(out) {}

    Solution run() {
        const Mesh& mesh = problem_.mesh();
        std::vector<double> x = problem_.start.empty() ? mesh.x : problem_.start;
        if (!make_valid(x)) return ended_at(problem_, std::move(x), Status::inverted);
        problem_.start = x;
        const bool stays = may_stay(setup_, problem_.motions);
        const bool minimises = !stays || setup_.needs_objective || mesh.degree > 1;
        Solution solution = at(x);
        if (setup_.stops_valid || interrupted()) return solution;
        const bool was_valid = problem_.infeasible.empty() && invalid_elements(problem_, mesh.x).empty();
        const bool is_drawn = std::any_of(problem_.motions.begin(), problem_.motions.end(), goes_onto);
        const ImprovementGuard guard(setup_, problem_, was_valid && !is_drawn ? mesh.x : x);
        if (minimises) solution = minimised(x, stays ? &guard : nullptr);
        if (!stays || solution.al.status != Status::converged) return solution;
        if (mesh.degree == 1 && (!setup_.needs_objective || setup_.distortion.objective == Objective::minimax))
            raise_least_corner(guard, x, solution);
        sizes_text = guard.sizes_text(solution.x);
        return solution;
    }

    // The run as if it had ended at x.
    Solution at(std::vector<double> x) {
        set_functional(setup_, problem_);
        const bool is_valid = problem_.infeasible.empty() || invalid_elements(problem_, x).empty();
        return ended_at(problem_, std::move(x), is_valid ? Status::converged : Status::inverted);
    }

private:
    const ProblemSetup& setup_;
    Problem& problem_;
    const Solve& solve_;
    MeshSoFar& so_far_;
    int& newton_steps_;
    std::FILE* out_;

    // Whether anything can be made better then.
    bool make_valid(std::vector<double>& x) {
        const std::vector<double> came = x;
        const bool was_certified = invalid_elements(problem_, x).empty();
        if (!was_certified || !may_stay(setup_, problem_.motions)) find_infeasible_elements(setup_, problem_, x, out_);
        if (const std::vector<int> invalid = invalid_elements(problem_, x); !invalid.empty())
            untangle(setup_, problem_, invalid, x, newton_steps_, out_);
        const auto& why = problem_.infeasible;
        if (!why.empty() && std::find(why.begin(), why.end(), "") == why.end()) return false;
        if (was_certified) return true;
        const std::size_t told = problem_.notes.size();
        take_along_target(problem_, came, x);
        hold_curved_faces(setup_, problem_, x);
        for (std::size_t k = told; k < problem_.notes.size(); ++k) print(out_, "note: ", problem_.notes[k], "\n");
        if (setup_.ideal != IdealKind::mesh) problem_.level->ideal = x;  // the measure of faces and heights
        return true;
    }

    // The distortion relative to the ideal elements minimised, from x on. guard: of a mesh that may also stay at x; nodes
    // that lose what is guarded stay there; null for others.
    Solution minimised(const std::vector<double>& x, const ImprovementGuard* guard) {
        const auto fails = [&](const Solution& solution) {
            return guard && !interrupted() &&
                   !(solution.al.status == Status::converged && is_certified(problem_, solution.x));
        };
        Solution solution = solve_(setup_, problem_);
        if (problem_.sliding && fails(solution) && is_certified(problem_, x)) {
            print(out_, "note: no valid mesh was found with nodes that slide: the boundary stays as it is\n");
            fix_boundary(problem_, x);
            solution = solve_(setup_, problem_);
        }
        if (!guard || interrupted() || solution.x == x) return solution;
        std::vector<double> to = solution.x;
        const bool is_taken = !fails(solution) && guard->take(x, to, &distance) && is_certified(problem_, to);
        if (is_taken && to == solution.x) return solution;
        if (!is_taken) distance.reset();
        print(out_, "note: ", is_taken ? "some nodes stay, where an element would become worse than the worst before\n"
                                       : "no better mesh was found: the mesh stays as it is\n");
        return at(is_taken ? std::move(to) : x);
    }

    void raise_least_corner(const ImprovementGuard& guard, const std::vector<double>& start, Solution& solution) {
        const Mesh& mesh = problem_.mesh();
        std::vector<double> x = solution.x;
        const auto smooth = [&] {
            const std::vector<char> moves = moving_nodes(guard, x);
            const MovingNodes moving{mesh, moves, *problem_.level->constraint, problem_.level->pairs,
                                     guard.size_change(), [this](int step, int most) { foresee(step, most); }};
            const auto taken = [&](const std::vector<double>& from, std::vector<double>& to) {
                if (!guard.take(from, to, nullptr)) return false;
                so_far_.keep(*problem_.level, to);
                return true;
            };
            watch_ = Stopwatch();
            const std::vector<double> from = x;
            const int steps = smooth_corners(moving, taken, x);
            if (problem_.sliding && !guard.take(from, x, &distance)) x = from, distance.reset();
            print(out_, guard.least_text(from, x, moves, steps), "\n");
        };
        smooth();
        if (problem_.sliding && !interrupted() && !is_certified(problem_, x) && is_certified(problem_, start)) {
            print(out_, "note: no valid mesh was found with nodes that slide: the boundary stays as it is\n");
            x = start;
            distance.reset();
            fix_boundary(problem_, x);
            set_functional(setup_, problem_);
            smooth();
        }
        if (x != solution.x) {
            take_along_target(problem_, solution.x, x);
            const Status status = solution.al.status;
            solution = at(std::move(x));
            if (interrupted()) so_far_.write(*problem_.level, solution.x);
            else solution.al.status = status;
        }
    }

    // Those that the constraint does not hold, but for nodes of boundaries with layers.
    std::vector<char> moving_nodes(const ImprovementGuard& guard, const std::vector<double>& x) const {
        const Mesh& mesh = problem_.mesh();
        std::vector<char> moves = guard.on_layers();
        for (char& of : moves) of = !of;
        const std::vector<int> held = held_directions(*problem_.level->constraint, x, mesh.dim);
        for (const int i : problem_.level->constraint->nodes())
            if (held.empty() || held[i] == mesh.dim) moves[i] = 0;
        for (const PeriodicPairs::Pair& pair : problem_.level->pairs.pairs)
            moves[pair.slave] = moves[pair.master] = moves[pair.slave] && moves[pair.master];
        return moves;
    }

    Stopwatch watch_;
    bool has_foreseen_ = false;

    // Once, of what takes longer than a few seconds.
    void foresee(int step, int most) {
        constexpr double seconds_before = 1, worth_telling = 4;
        const double seconds = watch_.seconds(), all = seconds / step * most;
        if (has_foreseen_ || seconds < seconds_before || step < 10) return;
        has_foreseen_ = true;
        if (all > worth_telling) print(out_, "this takes at most about ", to_text(all, 2), " s\n"), std::fflush(out_);
    }
};

struct NotKept : MeshSoFar {
    void keep(const Level&, const std::vector<double>&) override {}
    void write(const Level&, const std::vector<double>&) override {}
};

// A curved mesh is improved as the mesh with straight sides on its vertices, and then curved again to the boundary of
// the file as any mesh is (curving.hpp): inside, no side is more curved than the boundary needs. Returns where that
// takes the nodes, in the problem's frame; nothing where the mesh with straight sides cannot be made valid.
std::vector<double> curved_again(const ProblemSetup& setup, const Problem& problem, const Solve& solve,
                                 int& newton_steps) try {
    NotKept nowhere;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> silent(std::fopen("/dev/null", "w"), std::fclose);
    std::FILE* const out = silent.get();
    if (!out) return {};
    ProblemSetup linear = setup;
    linear.degree = 1;
    Problem straight = make_problem(linear, {linear_part(problem.base), true});
    set_regular_elements(straight);
    hold_surface(linear, straight);
    const Solution solution = Improvement(linear, straight, solve, nowhere, newton_steps, out).run();
    if (solution.al.status != Status::converged) return {};

    const Mesh& mesh = problem.mesh();
    const int dim = mesh.dim;
    Mesh moved = mesh;
    std::vector<char> is_vertex(mesh.nodes(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v < mesh.cell(e).vertices; ++v) is_vertex[mesh.element(e)[v]] = 1;
    moved.x = problem.file_x;
    const std::vector<double> before = straight_sided(moved);
    std::size_t from = 0;
    for (std::size_t k = 0; k < mesh.x.size(); ++k) {
        if (!is_vertex[k / dim]) continue;
        if (solution.x[from] != straight.mesh().x[from])
            moved.x[k] = straight.frame.to_file(solution.x[from], from, dim);
        ++from;
    }
    const std::vector<double> now = straight_sided(moved);
    for (std::size_t k = 0; k < moved.x.size(); ++k)
        if (!is_vertex[k / dim]) moved.x[k] += now[k] - before[k];

    ProblemSetup curving = setup;
    curving.ideal = IdealKind::straight;
    curving.start = Start::automatic;
    curving.refine = curving.degree = 0;
    if (setup.stops_valid) curving.local_repair = LocalRepair::yes;
    for (BoundaryMotion& boundary : curving.boundaries) boundary.motion = motion_of(NodeKind::fixed);
    Problem curved = make_problem(curving, {std::move(moved)});
    const StageObserver count = [&](const Stage& part) { newton_steps += part.newton_iterations; };
    const Solution found = curve_in_place(curving, curved, solve, count, nowhere, out);
    std::vector<double> x = final_positions(curved, found.x);
    for (std::size_t k = 0; k < x.size(); ++k)
        x[k] = x[k] == problem.file_x[k] ? mesh.x[k] : problem.frame.to_run(x[k], k, dim);
    return x;
} catch (const Error&) {
    return {};
}

// Of a curved mesh, whose certified bound counts, and then its corners. distance: of the surface, where it is better.
bool is_better(const ProblemOptions& options, Problem& problem, std::vector<double>& x,
               std::optional<double>& distance) {
    const Mesh& mesh = problem.mesh();
    if (x.empty() || x == mesh.x || !is_certified(problem, x)) return false;
    std::optional<double> off;
    if (invalid_elements(problem, mesh.x).empty()) {
        const ImprovementGuard guard(options, problem, mesh.x);
        if (!guard.take(mesh.x, x, &off) || !is_certified(problem, x)) return false;
        const auto bound = [&](const std::vector<double>& at) { return certify(mesh, at).min_certified_bound; };
        if (bound(x) == bound(mesh.x) && least_corner_jacobian(mesh, x) <= least_corner_jacobian(mesh, mesh.x))
            return false;
    } else off = surface_distance(problem, x);
    if (options.needs_tolerance && *off > options.surface_tolerance) return false;
    distance = off;
    fix_boundary(problem, x);
    return true;
}

}  // namespace

void set_regular_elements(Problem& problem) {
    const Mesh& mesh = problem.mesh();
    std::vector<char> valid;
    for (const double bound : certify(mesh, mesh.x).certified_bound) valid.push_back(bound > 0);
    problem.regular = local_volumes(mesh, mesh.x, valid);
}

Solution improve(const ProblemSetup& setup, Problem& problem, const Solve& solve, MeshSoFar& so_far,
                 int& newton_steps, std::FILE* out) {
    std::vector<double> x;
    if (problem.mesh().degree > 1 && may_stay(setup, problem.motions) && !setup.needs_objective)
        x = curved_again(setup, problem, solve, newton_steps);
    Improvement improvement(setup, problem, solve, so_far, newton_steps, out);
    std::optional<double>& distance = improvement.distance;
    Solution solution;
    if (is_better(setup, problem, x, distance)) {
        const Certificate before = certify(problem.mesh(), problem.mesh().x), after = certify(problem.mesh(), x);
        print(out, counted(before.uncertified.size(), "element"), " invalid in the file, ", after.uncertified.size(),
              " left after ", counted(newton_steps, "Newton step"), ": ",
              setup.stops_valid ? "" : "improved with straight sides, and ", "curved again; certified bound from ",
              rounded_down(before.min_certified_bound, 4), " to ",
              rounded_down(after.min_certified_bound, 4), "\n");
        if (interrupted()) so_far.write(*problem.level, x);
        solution = improvement.at(std::move(x));
    } else solution = improvement.run();
    if (!distance) distance = surface_distance(problem, solution.x);
    if (solution.al.status == Status::converged && setup.needs_tolerance && *distance > setup.surface_tolerance)
        solution.al.status = Status::off_surface;
    count_infeasible(setup, problem, solution);
    print_surface(out, setup, problem, solution.x, *distance, improvement.sizes_text);
    return solution;
}

}  // namespace almesh
