// The library's meshes and boundaries, from arrays and back, and what it does with them: problem/.
#include "almesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "mesh/build.hpp"
#include "method/derivative.hpp"
#include "problem/base_mesh.hpp"
#include "problem/frame_solver.hpp"
#include "problem/solve.hpp"

namespace almesh {
namespace {

constexpr const char* arrays_name = "mesh arrays";

const CellType& type_of(Cell cell) {
    const CellType* const types[] = {&simplex(1), &simplex(2), &quadrilateral(), &simplex(3),
                                     &hexahedron(), &prism(), &pyramid()};  // in the order of Cell
    const auto number = static_cast<std::size_t>(cell);
    if (number >= std::size(types)) throw UsageError(arrays_name, ": a cell of no known type");
    return *types[number];
}

Cell cell_of(const CellType& type) {
    for (auto cell = Cell::line;; cell = static_cast<Cell>(static_cast<int>(cell) + 1))
        if (&type_of(cell) == &type) return cell;
}

// Appends cells with the physical group `tag`; their ids go on from those before.
void add_cells(const MeshArrays& arrays, const Cells& cells, int dim, int tag, const std::string& what, RawMesh& raw) {
    const CellType& type = type_of(cells.type);
    const auto size = static_cast<std::size_t>(type.node_count(arrays.degree));
    if (type.dim != dim) throw UsageError(arrays_name, ": ", what, ": a ", type.name, " in ", dim, " dimensions");
    if (cells.nodes.size() % size != 0)
        throw UsageError(arrays_name, ": ", what, ": ", cells.nodes.size(), " nodes, but each ", type.name,
                         " of degree ", arrays.degree, " has ", size);
    for (std::size_t first = 0; first < cells.nodes.size(); first += size) {
        raw.elements.push_back({static_cast<long long>(raw.elements.size()) + 1, raw.element_nodes.size(), 0, dim,
                                arrays.degree, tag, 0, &type});
        for (std::size_t k = first; k < first + size; ++k) {
            const int node = cells.nodes[k];
            if (node < 0 || node >= static_cast<int>(raw.nodes.size()))
                throw UsageError(arrays_name, ": ", what, ": node ", node, ", of ", raw.nodes.size());
            raw.element_nodes.push_back(node);
        }
    }
}

// Nodes and elements have their numbers in the arrays, plus one, as ids.
RawMesh raw_mesh(const MeshArrays& arrays) {
    const int dim = arrays.dim;
    if (dim != 2 && dim != 3) throw UsageError(arrays_name, ": dim = ", dim, ": a mesh has 2 or 3 dimensions");
    if (arrays.degree < 1 || arrays.degree > max_degree)
        throw UsageError(arrays_name, ": degree = ", arrays.degree, ": degrees are 1 to ", max_degree);
    if (arrays.x.empty() || arrays.x.size() % dim != 0)
        throw UsageError(arrays_name, ": ", arrays.x.size(), " coordinates are not those of nodes in ", dim,
                         " dimensions");
    RawMesh raw;
    raw.path = arrays_name;
    for (std::size_t i = 0; i < arrays.x.size() / dim; ++i) {
        RawNode node{static_cast<long long>(i) + 1, {}, 0};
        std::copy_n(point(arrays.x, i, dim), dim, node.x);
        if (!std::all_of(node.x, node.x + dim, [](double v) { return std::abs(v) <= 1e50; }))
            throw InputError(arrays_name, ": node ", i, " is not at a finite position, or beyond 1e50");
        raw.nodes.push_back(node);
    }
    for (const Cells& cells : arrays.elements) add_cells(arrays, cells, dim, 0, "elements", raw);
    for (const Faces& faces : arrays.faces) {
        const PhysicalGroup* const same = find_row(raw.groups, faces.boundary);
        const int tag = same ? same->tag : static_cast<int>(raw.groups.size()) + 1;
        if (!same) raw.groups.push_back({dim - 1, tag, faces.boundary});
        add_cells(arrays, faces.cells, dim - 1, tag, "faces of " + in_backquotes(faces.boundary), raw);
    }
    return raw;
}

// By the numbers of the arrays. ids: of what values belong to, each `size` of them.
std::vector<double> by_id(const std::vector<long long>& ids, const std::vector<double>& values, int size,
                          std::vector<double> result) {
    for (std::size_t k = 0; k < ids.size(); ++k)
        std::copy_n(&values[k * size], size, &result[static_cast<std::size_t>(ids[k] - 1) * size]);
    return result;
}

// A mesh of a higher degree on the arrays' nodes: their elements and faces, as they are numbered there.
MeshArrays arrays_of(const Mesh& mesh, const MeshArrays& given) {
    MeshArrays arrays{mesh.dim, mesh.degree, given.x, {}, {}};
    const long long last = *std::max_element(mesh.file.node_id.begin(), mesh.file.node_id.end());
    arrays.x.resize(std::max(arrays.x.size(), static_cast<std::size_t>(last) * mesh.dim));
    arrays.x = by_id(mesh.file.node_id, mesh.x, mesh.dim, std::move(arrays.x));
    const auto add = [&](const int* nodes, int count, Cells& cells) {
        for (int k = 0; k < count; ++k) cells.nodes.push_back(static_cast<int>(mesh.file.node_id[nodes[k]]) - 1);
    };
    std::vector<int> place(mesh.element_count());
    for (int e = 0; e < mesh.element_count(); ++e) place[mesh.file.element_id[e] - 1] = e;
    for (const int e : place) {
        const Cell type = cell_of(mesh.cell(e));
        if (arrays.elements.empty() || arrays.elements.back().type != type) arrays.elements.push_back({type, {}});
        add(mesh.element(e), mesh.element_nodes(e), arrays.elements.back());
    }
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::string& name = mesh.boundaries[mesh.face_boundary[f]];
        const Cell type = cell_of(mesh.face_cell(f));
        if (arrays.faces.empty() || arrays.faces.back().boundary != name || arrays.faces.back().cells.type != type)
            arrays.faces.push_back({name, {type, {}}});
        add(mesh.face(f), mesh.face_nodes(f), arrays.faces.back().cells);
    }
    return arrays;
}

// given: nodes x dim.
Motion motion_at(const Boundary& boundary, double t, const std::vector<double>& given) {
    using Kind = Boundary::Kind;
    if (boundary.kind == Kind::fixed || boundary.kind == Kind::free)
        return motion_of(boundary.kind == Kind::fixed ? NodeKind::fixed : NodeKind::free);
    if (!boundary.target.empty()) {
        std::vector<double> places = given;
        for (std::size_t k = 0; k < places.size(); ++k) places[k] += t * (boundary.target[k] - places[k]);
        return given_by(std::move(places));
    }
    Motion motion = boundary.position ? given_by(boundary.position, t, t * boundary.turn) : Motion{};
    if (boundary.kind == Kind::slides) motion.steps.push_back(motion_of(NodeKind::slides).steps[0]);
    return motion;
}

AlObserver observer_of(const Observer& observe, const Units& units) {
    if (!observe) return {};
    AlObserver observer;
    observer.iteration = [&observe, units](const AlIteration& row) {
        const AlIteration in = units.of(row);
        observe({in.iteration, 0, in.energy, in.gradient_norm, 1, in.constraint_norm});
    };
    observer.newton_step = [&observe, units](int iteration, const NewtonStep& step) {
        const NewtonStep in = units.of(step);
        observe({iteration, in.iteration, in.energy, in.gradient_norm, in.step_length, 0});
    };
    return observer;
}

Verdict verdict_of(const Mesh& mesh, const Certificate& certificate, const Injectivity& injectivity,
                   const Frame& frame) {
    Verdict verdict{certificate.valid, injectivity.certified, certificate.undecided, {}, {}};
    verdict.certified_bound = by_id(mesh.file.element_id, certificate.certified_bound, 1,
                                std::vector<double>(certificate.certified_bound.size()));
    if (!certificate.valid) verdict.reason = counts_of(certificate);
    else if (!injectivity.certified) verdict.reason = overlap_text(mesh, injectivity, frame);
    return verdict;
}

}  // namespace

Verdict certify(const MeshArrays& arrays) {
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(raw_mesh(arrays), notes, Folds::keep);
    const Certificate certificate = certify(mesh, mesh.x);
    return verdict_of(mesh, certificate, certify_injective(mesh, mesh.x, certificate), {});
}

struct MovingMesh::State {
    MeshArrays given, arrays;
    ProblemSetup setup;
    BaseMesh base;
    std::map<std::string, Boundary> boundaries;
    std::unique_ptr<Problem> problem;  // of the boundaries as they are; null: not made yet
    std::unique_ptr<FrameSolver> solver;

    State(const MeshArrays& mesh, const Options& options) : given(mesh), arrays(mesh) {
        constexpr Objective objectives[] = {Objective::deviation, Objective::squared, Objective::size_shape,
                                            Objective::minimax};  // in the order of Options::Objective
        setup.distortion.objective = objectives[static_cast<int>(options.objective)];
        setup.continuation = static_cast<Continuation>(options.continuation);
        setup.degree = options.degree;
        setup.method.omega_star = options.gradient_tolerance;
        setup.method.wall_tolerance = options.boundary_tolerance;
        setup.method.max_iterations = options.max_iterations;
        setup.method.max_newton_iterations = options.max_newton_steps;
        setup.surface = options.may_slide ? SurfaceKind::automatic : SurfaceKind::keep;
        setup.in_time = true;
        set_threads(options.threads);
        std::vector<std::string> notes;
        base = build_base_mesh(raw_mesh(mesh), setup.ideal, notes);
        if (options.degree == 0 || options.degree == mesh.degree) return;
        if (options.degree < mesh.degree)
            throw UsageError("degree = ", options.degree, ": the ", arrays_name, " have degree ", mesh.degree);
        arrays = arrays_of(raise_degree(base.mesh, options.degree), given);
    }

    // The problem at the time t. It is made again where boundaries are held by something else than before.
    void set_time(double t) {
        setup.boundaries.clear();
        for (const auto& [name, boundary] : boundaries)
            setup.boundaries.push_back({name, motion_at(boundary, t, given.x), "boundary " + with_quotes(name)});
        if (problem) return move_target(setup, *problem);
        BaseMesh own = base;
        std::vector<std::string> notes;
        assign_boundaries(setup, own.mesh, notes);
        for (const std::string& name : own.mesh.boundaries)
            if (!motion_for(setup, name))
                throw UsageError("boundary ", with_quotes(name), " is not set: set() says what holds its nodes");
        problem = std::make_unique<Problem>(make_problem(setup, std::move(own)));
        solver = std::make_unique<FrameSolver>(*problem);
    }

    // Nodes of the arrays to those of the problem.
    std::vector<double> to_run(const std::vector<double>& x) const {
        if (x.size() != arrays.x.size())
            throw UsageError(x.size(), " numbers given, but the mesh has ", arrays.x.size(), ": nodes x dim");
        const Mesh& mesh = problem->mesh();
        std::vector<double> y(mesh.x.size());
        for (int i = 0; i < mesh.nodes(); ++i)
            for (int a = 0; a < mesh.dim; ++a)
                y[offset(i, mesh.dim, a)] = x[offset(static_cast<int>(mesh.file.node_id[i]) - 1, mesh.dim, a)];
        return y;
    }

    // others: of nodes that the problem does not have; empty: 0.
    std::vector<double> to_arrays(const std::vector<double>& values, std::vector<double> others) const {
        others.resize(arrays.x.size(), 0.0);
        return by_id(problem->mesh().file.node_id, values, arrays.dim, std::move(others));
    }

    Moved result(Solution solution, double t) {
        round_as_file(*problem, solution.x);
        examine(setup, *problem, solution);
        Moved moved;
        moved.x = to_arrays(final_positions(*problem, solution.x), arrays.x);
        moved.t = t;
        moved.converged = solution.al.status == Status::converged;
        moved.status = to_string(outcome(solution.al));
        moved.verdict = verdict_of(problem->mesh(), solution.certificate, solution.injectivity, problem->frame);
        moved.relative_quality = solution.al.distortion.relative_quality;
        moved.max_distortion = solution.al.distortion.max_distortion;
        moved.nodes_off_target = solution.nodes_off_target;
        moved.newton_steps = solution.newton_steps();
        return moved;
    }

    // before: null to start anew.
    Moved solve(const Moved* before, double t, const Observer& observe) {
        FramesBefore moments;
        if (before) {
            set_time(before->t);
            std::vector<double> x = to_run(before->x);
            problem->frame.take_to_run(x, arrays.dim);
            moments.push({before->t, std::move(x), problem->motions});
        }
        set_time(t);
        const AlObserver observer = observer_of(observe, {arrays.dim, problem->frame.length});
        std::string started_from;
        return result(solver->solve(setup, moments, t, started_from, {observer}, observer), t);
    }

    Moved follow(const Moved& before, double t, int halvings, const Observer& observe) {
        Moved moved = solve(&before, t, observe);
        if (moved.is_good() || halvings == 0) return moved;
        const int steps = moved.newton_steps;
        const Moved middle = follow(before, 0.5 * (before.t + t), halvings - 1, observe);
        if (middle.is_good()) moved = follow(middle, t, halvings - 1, observe);
        moved.newton_steps = middle.newton_steps + (middle.is_good() ? moved.newton_steps : 0) + steps;
        return moved;
    }

    Derivative derivative(Moved& at) {
        if (setup.distortion.objective == Objective::minimax) at = solve(nullptr, at.t, {});  // its last power
        if (!at.converged) throw Error(ExitCode::not_converged, "no derivative: the mesh has not converged");
        set_time(at.t);
        std::vector<double> x = to_run(at.x);
        problem->frame.take_to_run(x, arrays.dim);
        const Level& level = *problem->level;
        if (setup.distortion.objective != Objective::minimax) set_functional(setup, *problem);
        Derivative derivative(level.mesh, *level.energy, *level.constraint, setup.linear);
        derivative.polish(x);
        at.x = to_arrays(final_positions(*problem, x), arrays.x);
        return derivative;
    }
};

MovingMesh::MovingMesh(const MeshArrays& mesh, const Options& options)
    : state_(std::make_unique<State>(mesh, options)) {}
MovingMesh::MovingMesh(MovingMesh&&) noexcept = default;
MovingMesh& MovingMesh::operator=(MovingMesh&&) noexcept = default;
MovingMesh::~MovingMesh() = default;

const MeshArrays& MovingMesh::arrays() const { return state_->arrays; }

void MovingMesh::set(const std::string& boundary, const Boundary& what) {
    using Kind = Boundary::Kind;
    if (what.kind == Kind::moves && !what.position == what.target.empty())
        throw UsageError("boundary ", with_quotes(boundary), " moves: give it a position or a target, one of them");
    if (!what.target.empty() && what.target.size() != state_->given.x.size())
        throw UsageError("boundary ", with_quotes(boundary), ": a target of ", what.target.size(),
                         " numbers, but the mesh has ", state_->given.x.size(), ": nodes x dim");
    const auto [place, is_new] = state_->boundaries.try_emplace(boundary, what);
    if (is_new || place->second.kind != what.kind || place->second.target.empty() != what.target.empty())
        state_->problem.reset();
    place->second = what;
}

Moved MovingMesh::move(double t, const Observer& observe) { return state_->solve(nullptr, t, observe); }

Moved MovingMesh::follow(const Moved& before, double t, const Observer& observe) {
    constexpr int most_halvings = 6;
    if (!before.is_good()) throw UsageError("follow: the mesh before is not good: start from another one, or move()");
    return state_->follow(before, t, most_halvings, observe);
}

Verdict MovingMesh::certify(const std::vector<double>& x) const {
    MeshArrays at = state_->arrays;
    if (x.size() != at.x.size())
        throw UsageError("certify: ", x.size(), " numbers, but the mesh has ", at.x.size(), ": nodes x dim");
    at.x = x;
    return almesh::certify(at);
}

std::vector<double> MovingMesh::tangent(Moved& at, const std::vector<double>& velocity) {
    Derivative derivative = state_->derivative(at);
    const std::vector<double> shift = state_->to_run(velocity);
    return state_->to_arrays(derivative.tangent({shift, std::vector<double>(shift.size(), 0.0)}), {});
}

std::vector<double> MovingMesh::adjoint(Moved& at, const std::vector<double>& dJ_dx) {
    Derivative derivative = state_->derivative(at);
    return state_->to_arrays(derivative.adjoint(state_->to_run(dJ_dx)).shift, {});
}

}  // namespace almesh
