#include "problem/curving.hpp"

#include <algorithm>
#include <set>

#include "problem/curved_part.hpp"
#include "problem/kept_surface.hpp"
#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/text.hpp"
#include "check/straightened.hpp"
#include "constraint/sliding_nodes.hpp"
#include "mesh/kept_cells.hpp"

namespace almesh {
namespace {

constexpr double small_work = 5e5;  // blocks of all elements' Hessians: about a second for all steps of a solution
constexpr int most_al_iterations = 6, most_newton_steps = 20;  // of the whole mesh, if parts may follow

// The attempts, each for elements that are still straightened: the boundary condition of a part, the largest number of
// these elements in it (as tetrahedra of degree 3), the reach around them in units of their edges, and the Newton steps
// after which the boundary must be near its target (curved_part.hpp). Planes keep their shape if nodes slide in them:
// parts may then be large.
enum class Boundary { stays, slides_inside_planes, slides_in_planes, slides, slides_around, flattens };
struct Attempt {
    Boundary boundary;
    int at_once;
    double reach;
    int first_steps;
    const char* what;
};
constexpr Attempt attempts[] = {{Boundary::stays, 48, 1, 8, "boundary as in the file"},
                                {Boundary::stays, 48, 2, 8, "boundary as in the file"},
                                {Boundary::slides_inside_planes, 3840, 1, 8, "nodes slide in planes"},
                                {Boundary::slides_in_planes, 48, 1, 8, "vertices slide in planes"},
                                {Boundary::slides, 48, 1, 4, "nodes slide"},
                                {Boundary::slides_around, 192, 1, 16, "nodes around slide"},
                                {Boundary::slides_around, 12, 1, 4, "nodes around slide"},
                                {Boundary::flattens, 48, 1, 16, "faces are flatter"}};

int count(const std::vector<char>& some) { return static_cast<int>(std::count(some.begin(), some.end(), 1)); }

class Curving {
public:
    Curving(const ProblemOptions& options, Problem& problem, const StageObserver& observe, MeshSoFar& so_far)
        : options_(options), problem_(problem), mesh_(problem.mesh()), observe_(observe), so_far_(so_far) {
        freed_.resize(mesh_.nodes(), 0);
        if (is_minimax_) options_.distortion.objective = Objective::squared;
    }

    // From where the run stood, at x. Nodes that have slid need the surfaces that they slid along.
    void go_on(const std::vector<double>& x) {
        solution_.x = x;
        bound_ = certify(mesh_, x).certified_bound;
        if (count(freed_) > 0 && !can_slide()) freed_.assign(mesh_.nodes(), 0);
    }

    // From the mesh of the file. From here on the mesh is valid.
    void straighten(std::FILE* out) {
        const StraightenedMesh found = straightened(mesh_.x);
        standing_.x.clear();  // of a solution as a whole
        is_straightened_ = found.was_at_fault;
        const int at_fault = count(found.was_at_fault);
        if (at_fault == 0)
            std::fprintf(out, "no element is invalid in the file: nothing moves (local_repair = 0: all nodes do)\n");
        else
            std::fprintf(out, "%s%d of %d elements straightened, to be curved again in parts%s:\n",
                         is_minimax_ ? "note: parts of the mesh are curved with objective = squared\n" : "",
                         at_fault, mesh_.element_count(),
                         found.injectivity.certified ? "" : ", which does not make the mesh valid and injective yet");
    }

    // Each attempt around all places, before the next one.
    void curve_parts() {
        int& number = standing_.attempt;
        if (interrupted()) return;
        if (number < 0 && count(is_straightened_) == 0) number = std::ssize(attempts);
        if (has_tried_all()) return;
        for (number = std::max(number, 0); !has_tried_all() && !interrupted();) {
            const Attempt& attempt = attempts[number];
            for (const std::vector<int>& place : places_of(mesh_, is_straightened_, attempt.at_once)) {
                if (interrupted()) break;
                if (curve_around(place, attempt))
                    for (const int e : place) is_straightened_[e] = 0;
                so_far_.keep(*problem_.level, solution_.x);
            }
            if (!interrupted()) ++number;
        }
        if (interrupted()) so_far_.write(*problem_.level, solution_.x);
        straightened(solution_.x);  // parts that overlap each other, if there are any
    }

    bool has_tried_all() const { return standing_.attempt >= std::ssize(attempts); }

    bool leaves_straight() const { return count(is_straightened_) > 0; }  // for what could not be curved again at all

    // The target is where the boundary is, and what was freed is free to slide.
    void set_target() {
        std::vector<double> at = solution_.x;
        for (std::size_t k = 0; k < at.size(); ++k)
            if (freed_[k / mesh_.dim]) at[k] = mesh_.x[k];
        fix_boundary(problem_, at);
        if (count(freed_) == 0) return;
        free_nodes(mesh_, freed_, problem_.target);
        problem_.sliding = surfaces_;
    }

    Solution solution() {
        Level& level = *problem_.level;
        set_functional(options_, problem_);
        solution_.al.lambda.assign(level.constraint->multipliers(), 0.0);
        AlIteration row = measured(*level.energy, *level.constraint, solution_.x, solution_.al.distortion);
        row.gradient_norm = standing_.gradient_norm;
        solution_.al.iterations.push_back(row);
        solution_.al.status = interrupted() ? Status::interrupted : Status::converged;
        solution_.time.total = watch_.seconds();
        return std::move(solution_);
    }

private:
    const Stopwatch watch_;
    ProblemOptions options_;
    const bool is_minimax_ = options_.distortion.objective == Objective::minimax;
    Problem& problem_;
    const Mesh& mesh_;
    const StageObserver& observe_;
    MeshSoFar& so_far_;
    Standing& standing_ = *so_far_.standing;
    Solution solution_;
    std::vector<char>& freed_ = standing_.freed;  // per node: whether it has slid, or could have
    std::vector<char>& is_straightened_ = standing_.straight;  // per element: by straighten(), not curved again yet
    std::vector<double> bound_;          // certified, per element
    std::set<std::vector<int>> slid_;    // sets for which slides_around has failed
    std::shared_ptr<SlidingSurfaces> surfaces_;  // null: not made yet
    bool has_no_surfaces_ = false;
    std::vector<char> is_in_planes_;  // per node of the boundary: whether all faces at it are; with surfaces_

    // Takes the mesh from these positions to a certified one.
    StraightenedMesh straightened(const std::vector<double>& x) {
        StraightenedMesh found =
            straighten_invalid(mesh_, problem_.ideal(), x, options_.min_certified_bound);
        for (std::size_t k = 0; k < x.size(); ++k)
            if (found.x[k] != x[k]) freed_[k / mesh_.dim] = 0;
        solution_.x = std::move(found.x);
        bound_ = found.certificate.certified_bound;
        return found;
    }

    bool can_slide() {
        if (options_.surface == SurfaceKind::straighten || has_no_surfaces_) return false;
        if (surfaces_) return true;
        try {
            surfaces_ = surfaces_in_place(options_, problem_);
        } catch (const InputError&) {  // the file's boundary is such that they are not known
            has_no_surfaces_ = true;
            return false;
        }
        is_in_planes_ = nodes_of_features(mesh_);  // which are not to slide
        for (char& is : is_in_planes_) is = !is;
        for_face_nodes(mesh_, [&](int f, std::size_t k) {
            if (!surfaces_->surface(surfaces_->part(mesh_, f)).is_flat()) is_in_planes_[mesh_.faces[k]] = 0;
        });
        return true;
    }

    // Whether the elements of the place are curved then.
    bool curve_around(const std::vector<int>& place, const Attempt& attempt) {
        std::vector<char> is_of_place(mesh_.element_count(), 0);
        std::vector<double> curved = solution_.x;
        for (const int e : place) {
            is_of_place[e] = 1;
            for (int k = 0; k < mesh_.element_nodes(e); ++k) {
                const int i = mesh_.element(e)[k];
                if (!freed_[i]) std::copy_n(point(mesh_.x, i, mesh_.dim), mesh_.dim, point(curved, i, mesh_.dim));
            }
        }
        if (curved == solution_.x) return true;  // by the parts around
        if (attempt.boundary == Boundary::slides_around && slid_.contains(place)) return false;
        CurvedPart part(problem_, surroundings(mesh_, is_of_place, attempt.reach), solution_.x, curved);
        return release(part, is_of_place, attempt.boundary) && curve(part, attempt, place);
    }

    // Gives the boundary of the part the freedom of the attempt. Whether that may help.
    bool release(CurvedPart& part, const std::vector<char>& is_of_place, Boundary boundary) {
        const double bound = options_.min_certified_bound;
        if (boundary == Boundary::stays) return part.find_infeasible(bound).none();
        if (boundary == Boundary::flattens) {
            const CurvedPart held = part;
            if (can_slide()) part.free_nodes_in(is_in_planes_, true);
            if (part.find_infeasible(bound).none()) part = held;
            if (part.find_infeasible(bound).none()) return false;
            part.flatten(bound);
            return true;
        }
        if (!can_slide()) return false;
        if (boundary == Boundary::slides_inside_planes || boundary == Boundary::slides_in_planes) {
            part.free_nodes_in(is_in_planes_, boundary == Boundary::slides_in_planes);
            return !part.freed.empty() && part.find_infeasible(bound).none();
        }
        Infeasible infeasible = part.find_infeasible(bound);
        if (infeasible.none())
            for (int e = 0; e < part.element_count(); ++e)
                if (is_of_place[part.element_of[e]]) infeasible.elements.push_back({e, 0, true});
        part.free_nodes(part.nodes_to_free(infeasible, boundary == Boundary::slides_around));
        return true;
    }

    // Whether the part is certified, and makes no element worse than it may be.
    bool curve(const CurvedPart& part, const Attempt& attempt, const std::vector<int>& place) {
        const Stopwatch watch;
        const CurvedPartResult found = almesh::curve(options_, part, surfaces_.get(), attempt.first_steps);
        bool is_better = found.certificate.valid;
        for (std::size_t e = 0; e < part.element_of.size() && is_better; ++e)
            is_better = found.certificate.certified_bound[e] >
                        std::min(options_.min_certified_bound, 0.999 * bound_[part.element_of[e]]);
        AlIteration last = found.al.iterations.back();
        last.seconds = watch.seconds();
        const Vec<3> at = problem_.frame.to_file(element_centre(mesh_, mesh_.x, place[0]));
        observe_({part.nodes(), is_better ? Status::converged : Status::stalled, last, found.al.newton_iterations, 1, 0,
                  concat(part.element_count(), " elements around ", position_text(at.data(), mesh_.dim), ": ",
                         attempt.what)});
        int& steps = is_better ? solution_.al.newton_iterations : solution_.al.earlier_newton_iterations;
        steps += found.al.newton_iterations;
        if (!is_better && attempt.boundary == Boundary::slides_around && !found.certificate.certified_bound.empty())
            slid_.insert(place);
        if (!is_better) return false;
        standing_.gradient_norm = std::max(standing_.gradient_norm, last.gradient_norm);
        for (std::size_t e = 0; e < part.element_of.size(); ++e)
            bound_[part.element_of[e]] = found.certificate.certified_bound[e];
        for (int k = 0; k < part.nodes(); ++k) {
            const double* const to = point(found.x, k, mesh_.dim);
            double* const x = point(solution_.x, part.node_of[k], mesh_.dim);
            char& is_freed = freed_[part.node_of[k]];
            is_freed = (!part.freed.empty() && part.freed[k]) || (is_freed && std::equal(to, to + mesh_.dim, x));
            std::copy_n(to, mesh_.dim, x);
        }
        return true;
    }
};

ProblemOptions impatient(ProblemOptions options) {
    options.method.max_iterations = std::min(options.method.max_iterations, most_al_iterations);
    options.method.max_newton_iterations = std::min(options.method.max_newton_iterations, most_newton_steps);
    if (options.continuation == Continuation::automatic) options.continuation = Continuation::never;
    return options;
}

bool is_small(const Mesh& mesh) {
    double work = 0;
    for (int e = 0; e < mesh.element_count(); ++e) work += work_of(mesh, e);
    return work <= small_work;
}

bool is_certified(const Problem& problem, const Solution& solution) {
    if (solution.al.status != Status::converged) return false;
    const Certificate certificate = certify(problem.mesh(), solution.x);
    return certified_injective(problem, solution.x, certificate).certified;
}

}  // namespace

Injectivity certified_injective(const Problem& problem, const std::vector<double>& x, const Certificate& certificate) {
    if (!problem.curves_in_place) return certify_injective(problem.mesh(), x, certificate);
    const Injectivity found = certify_curved(problem.mesh(), problem.ideal(), problem.mesh().x, x, certificate);
    if (found.certified || !certificate.valid) return found;
    Mesh mesh = problem.mesh();
    mesh.x = problem.ideal();
    Injectivity straight = certify_injective(mesh, mesh.x, certify(mesh, mesh.x));
    if (straight.certified) return found;
    straight.reason = "with straight sides too, " + straight.reason;
    return straight;
}

Solution curve_in_place(const ProblemOptions& options, Problem& problem, const Solve& solve,
                        const StageObserver& observe, MeshSoFar& so_far, std::FILE* out) {
    const bool as_whole = options.local_repair == LocalRepair::no ||
                          (options.local_repair == LocalRepair::automatic && is_small(problem.mesh()));
    const ProblemOptions settings = options.local_repair == LocalRepair::no ? options : impatient(options);
    const bool keeps_boundary =
        as_whole && find_infeasible(problem.mesh(), problem.ideal(), problem.target,
                                    options.min_certified_bound).none();
    const bool stood_in_parts = so_far.standing->attempt >= 0;
    if (keeps_boundary && !stood_in_parts) {
        Solution whole = solve(settings, problem);
        if (is_certified(problem, whole)) return whole;
    }
    Curving curving(options, problem, observe, so_far);
    if (stood_in_parts) curving.go_on(problem.start);
    else curving.straighten(out);
    curving.curve_parts();
    curving.set_target();
    Solution solution = curving.solution();
    if (as_whole && !keeps_boundary && !curving.leaves_straight() && !interrupted()) {
        ProblemOptions from_parts = settings;
        from_parts.start = Start::file;
        problem.start = solution.x;
        Solution whole = solve(from_parts, problem);
        if (is_certified(problem, whole) &&
            whole.al.distortion.max_distortion <= solution.al.distortion.max_distortion)
            return whole;
        if (interrupted()) solution.al.status = Status::interrupted;
    }
    if (interrupted() && curving.has_tried_all()) so_far.write(*problem.level, solution.x);
    return solution;
}

}  // namespace almesh
