// The library's meshes and boundaries, from arrays and back, and what it does with them: problem/.
#include "almesh.hpp"

#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "library/mesh_arrays.hpp"
#include "library/session.hpp"
#include "problem/base_mesh.hpp"

namespace almesh {
namespace {

// What moves, of a mesh with nodes after those of the arrays.
MeshArrays arrays_of(const MeshView& view) {
    MeshArrays arrays{view.dim, view.degree, view.first, {}, {}};
    const auto add = [](const CellList& from, int k, Cells& to) {
        to.nodes.insert(to.nodes.end(), &from.node[from.offset[k]], &from.node[from.offset[k + 1]]);
    };
    for (int e = 0; e < std::ssize(view.elements.type); ++e) {
        const auto type = static_cast<Cell>(view.elements.type[e]);
        if (arrays.elements.empty() || arrays.elements.back().type != type) arrays.elements.push_back({type, {}});
        add(view.elements, e, arrays.elements.back());
    }
    for (std::size_t b = 0; b < view.boundaries.size(); ++b) {
        const CellList& faces = view.boundaries[b];
        for (int f = 0; f < std::ssize(faces.type); ++f) {
            const auto type = static_cast<Cell>(faces.type[f]);
            if (f == 0 || arrays.faces.back().cells.type != type)
                arrays.faces.push_back({view.boundary_names[b], {type, {}}});
            add(faces, f, arrays.faces.back().cells);
        }
    }
    return arrays;
}

// base: of the arrays.
Motion motion_at(const Boundary& boundary, double t, const Mesh& base) {
    using Kind = Boundary::Kind;
    if (boundary.kind == Kind::fixed || boundary.kind == Kind::free)
        return motion_of(boundary.kind == Kind::fixed ? NodeKind::fixed : NodeKind::free);
    if (!boundary.target.empty()) {
        std::vector<double> places = base.x;
        for (std::size_t k = 0; k < places.size(); ++k) {
            const long long node = base.file.node_id[k / base.dim] - 1;
            places[k] += t * (boundary.target[node * base.dim + k % base.dim] - places[k]);
        }
        return given_by(std::move(places));
    }
    Motion motion = boundary.position ? given_by(boundary.position, t, t * boundary.turn) : Motion{};
    if (boundary.kind == Kind::slides) motion.steps.push_back(motion_of(NodeKind::slides).steps[0]);
    return motion;
}

Verdict verdict_of(const Session& session, const Certificate& certificate, const Injectivity& injectivity) {
    Verdict verdict{certificate.valid, injectivity.certified, certificate.undecided, certificate.certified_bound,
                    session.reason(certificate, injectivity)};
    MeshView::put(certificate.certified_bound, 1, session.view.element, verdict.certified_bound);
    return verdict;
}

}  // namespace

Verdict certify(const MeshArrays& arrays) {
    const Session session(source_of(arrays), arrays_name);
    const auto [certificate, injectivity] = session.certify(session.base.x);
    return verdict_of(session, certificate, injectivity);
}

struct MovingMesh::State {
    Session session;
    MeshArrays arrays;
    bool is_checked = false;  // that each boundary has one

    State(const MeshArrays& mesh, const Options& options)
        : session(source_of(mesh), arrays_name), arrays(mesh) {
        constexpr const char *objectives[] = {"deviation", "squared", "size_shape", "minimax"},
                             *continuations[] = {"auto", "never", "always"};  // in the order of Options
        session.settings.lines = {{"objective", objectives[static_cast<int>(options.objective)]},
                            {"continuation", continuations[static_cast<int>(options.continuation)]},
                            {"degree", to_text(options.degree)},
                            {"omega_star", to_text(options.gradient_tolerance)},
                            {"wall_tolerance", to_text(options.boundary_tolerance)},
                            {"max_al_iterations", to_text(options.max_iterations)},
                            {"max_newton_iterations", to_text(options.max_newton_steps)},
                            {"surface", options.may_slide ? "auto" : "keep"},
                            {"threads", to_text(options.threads)}};
        session.deck();
        std::vector<std::string> notes;
        build_base_mesh(session.source.raw, IdealKind::automatic, notes);
        if (options.degree == 0 || options.degree == mesh.degree) return;
        if (options.degree < mesh.degree)
            throw UsageError("degree = ", options.degree, ": the ", arrays_name, " have degree ", mesh.degree);
        const Mesh raised = raise_degree(session.base, options.degree);
        session.view = MeshView(raised, session.source.raw, session.base, raised.x);
        arrays = arrays_of(session.view);
    }

    void check_boundaries() {
        if (std::exchange(is_checked, true)) return;
        Mesh mesh = session.base;
        std::vector<std::string> notes;
        const Deck deck = session.deck();
        assign_boundaries(deck, mesh, notes);
        for (const std::string& name : mesh.boundaries)
            if (!motion_for(deck, name))
                throw UsageError("boundary ", with_quotes(name), " is not set: set() says what holds its nodes");
    }

    void check_size(const std::vector<double>& x) const {
        if (x.size() != arrays.x.size())
            throw UsageError(x.size(), " numbers given, but the mesh has ", arrays.x.size(), ": nodes x dim");
    }

    // Nodes of the arrays to those of the problem.
    std::vector<double> to_run(const std::vector<double>& x) const {
        check_size(x);
        return session.view.to_mesh(x.data());
    }

    // from: null to start anew.
    Moved solve(const Moved* from, double t, const Observer& observe) {
        check_boundaries();
        session.observe = observe;
        session.before = {};
        if (from) session.set_start(from->t, to_run(from->x));
        session.frame(t);
        const Solution& solution = session.solution;
        return {session.view.x,
                t,
                solution.al.status == Status::converged,
                to_string(outcome(solution.al)),
                verdict_of(session, solution.certificate, solution.injectivity),
                solution.al.distortion.relative_quality,
                solution.al.distortion.max_distortion,
                solution.nodes_off_target,
                solution.newton_steps()};
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

    std::vector<double> differentiate(Moved& at, bool adjoint, const std::vector<double>& values) {
        if (session.run.distortion.objective == Objective::minimax) at = solve(nullptr, at.t, {});  // its last power
        if (!at.converged) throw Error(ExitCode::not_converged, "no derivative: the mesh has not converged");
        check_size(values);
        session.set_solution(at.t, to_run(at.x));
        const std::vector<double> result = session.differentiate(adjoint, values.data());
        at.x = session.view.x;
        return result;
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
    const std::size_t given = state_->session.source.raw.nodes.size() * state_->arrays.dim;
    if (!what.target.empty() && what.target.size() != given)
        throw UsageError("boundary ", with_quotes(boundary), ": a target of ", what.target.size(),
                         " numbers, but the mesh has ", given, ": nodes x dim");
    state_->is_checked = false;
    state_->session.settings.motions[boundary] = [what, &base = state_->session.base](double t) {
        return motion_at(what, t, base);
    };
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
    return state_->differentiate(at, false, velocity);
}

std::vector<double> MovingMesh::adjoint(Moved& at, const std::vector<double>& dJ_dx) {
    return state_->differentiate(at, true, dJ_dx);
}

}  // namespace almesh
