#include "problem/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "constraint/sliding_boundary.hpp"
#include "method/functional.hpp"
#include "method/newton.hpp"
#include "problem/surface_pairing.hpp"

namespace almesh {
namespace {

constexpr double work = 1e4;  // simple operations that finding a closest point takes, at least
constexpr Mat<3> identity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

// Where boundary nodes are to go, per node of the mesh.
struct Goals {
    std::vector<Vec<3>> move;          // from where they are
    std::vector<Vec<3>> exact;         // to a point of the surface
    std::vector<Mat<3>> across;        // P, the projector onto the directions that leave surface or edge
    double farthest = 0;               // node from its surface, of the size of its faces

    explicit Goals(int nodes) : move(nodes, Vec<3>{}), exact(move), across(nodes, identity) {}
};

// r = W (x - goal), W = P + along (I - P): a node is held less along the surface than across.
class PullToGoals final : public Dirichlet {
public:
    PullToGoals(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                const std::vector<Mat<3>>& across, double along)
        : Dirichlet(mesh, ideal, target), across_(across), along_(along) {}

    SurfaceDistance distance(int t, const Vec<3>& x) const override {
        SurfaceDistance from = Dirichlet::distance(t, x);
        const Mat<3>& P = across_[nodes()[t]];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) from.slope[i][j] = along_ * (i == j) + (1 - along_) * P[i][j];
        from.r = times(from.slope, from.r);
        return from;
    }

private:
    const std::vector<Mat<3>>& across_;
    double along_;
};

// A node is pulled to the closest point of the surface, and a node of the surface pulls the closest point of the
// boundary, in shares of the area; with `on` along the boundary only, and nodes of edges and corners go to those of the
// surface.
void add_goals(const Mesh& mesh, const std::vector<double>& x, const SurfacePairing& to, bool on, Goals& goals) {
    const PatchedFaces own(mesh, x, to.own);
    const std::vector<Vec<3>> normal = own.normals_at_nodes();
    double same_way = 0, area = 0, of_samples = 0;
    for (std::size_t k = 0; k < own.patch.size(); ++k) {
        area += length(own.normal[k]);
        same_way += dot(own.normal[k], to.faces.normal[to.faces.points.find(own.patch[k][0]).patch]);
    }
    const double side = same_way < 0 ? -1 : 1;  // the surface is turned inward
    std::vector<ClosestPoint::Place> place(to.samples.size());
    parallel_for(static_cast<int>(place.size()),
                 [&](int s) { place[s] = own.facing(to.samples[s].x, side * to.samples[s].normal); }, work);
    const std::vector<std::set<int>> parts = on ? to.parts_at_edges(own, side) : std::vector<std::set<int>>();
    std::vector<double> weight(mesh.nodes(), 0.0), off(weight);
    std::vector<Vec<3>> pull(mesh.nodes(), Vec<3>{});
    for (const SurfacePairing::Sample& sample : to.samples) of_samples += length(sample.normal);
    for (std::size_t s = 0; s < place.size(); ++s) {
        if (place[s].patch < 0) continue;
        const double share = length(to.samples[s].normal) / of_samples;
        for (int v = 0; v < mesh.dim; ++v) {
            const int i = own.patches.corner(own.number[place[s].patch], v);
            weight[i] += share * area * place[s].at[v];
            pull[i] = pull[i] + share * area * place[s].at[v] * (to.samples[s].x - place[s].position);
        }
    }
    parallel_for(mesh.nodes(), [&](int i) {
        const double own_area = length(normal[i]);
        if (own_area == 0) return;
        const Vec<3> X = at_node(x, i, mesh.dim);
        const double size = std::pow(own_area, 1.0 / (mesh.dim - 1));
        const ClosestPoint::Place closest = to.faces.facing(X, side * normal[i], on ? 0.5 : 0);
        Vec<3> forward = closest.patch < 0 ? Vec<3>{} : closest.position - X;
        const Vec<3> both = 1 / (own_area + weight[i]) * (own_area * forward + pull[i]), n = unit(normal[i]);
        goals.move[i] = both;
        if (!on) return;
        goals.across[i] = {n[0] * n, n[1] * n, n[2] * n};
        if (!parts[i].empty()) to.take_feature(parts[i], X, forward, goals.across[i]);
        goals.move[i] = both + times(goals.across[i], forward - both);
        goals.exact[i] = forward;
        off[i] = length(times(goals.across[i], forward)) / size;
    }, work);
    goals.farthest = std::max(goals.farthest, *std::max_element(off.begin(), off.end()));
}

// Minimises energy + penalty of the distance from where the nodes are to go, which follows the iterate, from x on.
// mesh: of the problem; ideal, target: of it; all in the file's frame. is_near: x was drawn there, on another mesh.
std::vector<double> drawn(const ProblemOptions& options, const Problem& problem, Mesh mesh, std::vector<double> ideal,
                          BoundaryTarget target, std::vector<double> x, bool is_near) {
    constexpr double first = 0.01, growth = 2, on_from = 1000;  // penalties; the mesh has the volume 1
    constexpr int most_rounds = 60, steps = 5;
    constexpr double near = 1e-3, last = 1e7;
    prescribe_shared_nodes(mesh, target);
    for (std::vector<double>* const field : {&target.node, &target.sample, &mesh.x, &ideal, &x})
        problem.frame.take_to_run(*field, mesh.dim);
    DistortionParams params = distortion_of(options);
    params.curved_ideal = problem.is_own_ideal;
    const auto energy = make_energy(mesh, ideal, params);
    if (!std::isfinite(energy->energy(x)))
        throw InputError(problem.name, ": `onto` needs a valid mesh to begin with; `almesh improve` makes it valid");
    const std::vector<char> held = prescribed_nodes(mesh, target);
    std::replace(target.kind.begin(), target.kind.end(), NodeKind::slides, NodeKind::target);
    const std::list<SurfacePairing> surfaces = surface_pairings(options, problem, mesh, problem.frame);
    for (const SurfacePairing& to : surfaces) to.check_place(mesh, x);
    Newton newton(energy->hessian_pattern(), options.linear, {.forcing = options.forcing});
    double penalty = is_near ? growth * on_from : first;
    for (int round = 0; round < most_rounds && !interrupted(); ++round, penalty *= growth) {
        const bool on = penalty > on_from;
        Goals goals(mesh.nodes());
        for (const SurfacePairing& to : surfaces) add_goals(mesh, x, to, on, goals);
        for (int i = 0; i < mesh.nodes(); ++i)
            if (held[i]) goals.across[i] = identity;
        if (on && (goals.farthest < near || penalty > last)) break;
        for_face_nodes(mesh, [&](int f, std::size_t k) {
            const int i = mesh.faces[k];
            if (goes_onto(problem.motions[mesh.face_boundary[f]]) && !held[i])
                set_node(target.node, static_cast<int>(k), mesh.dim, at_node(x, i, mesh.dim) + goals.move[i]);
        });
        PullToGoals pull(mesh, ideal, target, goals.across, on ? std::sqrt(on_from / penalty) : 1);
        const AugmentedFunctional E(*energy, pull, std::vector<double>(pull.multipliers(), 0.0), penalty);
        NewtonParams wanted{.omega = std::numeric_limits<double>::max(), .reduction = 0.1};
        wanted.max_iterations = steps;
        wanted.cold_start = round == 0;
        newton.minimise(E, wanted, x);
    }
    return problem.frame.to_file(x, mesh.dim);
}

// Where the motions take the nodes of problem.mesh(), which are at x, in the file's frame: those of such boundaries to
// the closest points of their surfaces.
std::vector<double> on_the_surfaces(const ProblemOptions& options, const Problem& problem, std::vector<double> x) {
    const Mesh& mesh = problem.mesh();
    const std::vector<double> from = x;
    for (const SurfacePairing& to : surface_pairings(options, problem, mesh, Frame())) {
        Goals goals(mesh.nodes());
        add_goals(mesh, from, to, true, goals);
        for (int i = 0; i < mesh.nodes(); ++i) set_node(x, i, mesh.dim, at_node(x, i, mesh.dim) + goals.exact[i]);
    }
    for_face_nodes(mesh, [&](int, std::size_t k) {
        if (is_prescribed(problem.target.kind[k]))
            std::copy_n(&problem.target.node[k * mesh.dim], mesh.dim, point(x, mesh.faces[k], mesh.dim));
    });
    return x;
}

// x with the nodes at y, but for those whose elements would lose half their certified bound. Their number.
int take_where_valid(const Mesh& mesh, const std::vector<double>& y, std::vector<double>& x) {
    constexpr double least_part = 0.5;
    const std::vector<double> before = certify(mesh, x).certified_bound, from = std::exchange(x, y);
    int left = 0;
    for (bool some = true; some;) {
        some = false;
        const std::vector<double> bound = certify(mesh, x).certified_bound;
        for (int e = 0; e < mesh.element_count(); ++e)
            for (int k = 0; k < mesh.element_nodes(e) && !(bound[e] > least_part * before[e]); ++k) {
                const int i = mesh.element(e)[k];
                if (at_node(x, i, mesh.dim) == at_node(from, i, mesh.dim)) continue;
                set_node(x, i, mesh.dim, at_node(from, i, mesh.dim));
                ++left;
                some = true;
            }
    }
    return left;
}

}  // namespace

void draw_onto(const ProblemOptions& options, Problem& problem) {
    if (std::none_of(problem.motions.begin(), problem.motions.end(), goes_onto)) return;
    if (options.in_time) throw SettingError("frames", "`onto` has no frames: give them to a run that starts from its "
                                            "final mesh");
    const Mesh &shape = problem.shape(), &mesh = problem.mesh();
    const std::vector<double> x = drawn(
        options, problem, shape, problem.ideal_of(shape),
        make_target(shape, shape.x, problem.motions, problem.placed, problem.shared), shape.x, false);
    std::vector<double> start = on_level(shape, x, *problem.level);
    if (mesh.nodes() > shape.nodes())
        start = drawn(options, problem, mesh, problem.ideal(), problem.target, std::move(start), true);
    const std::vector<double> goal = on_the_surfaces(options, problem, start);
    if (const int left = take_where_valid(mesh, goal, start))
        problem.notes.push_back(concat(counted(left, "boundary node"), left == 1 ? " stays" : " stay", " off the "
                                       "surface: elements there would be inverted, or nearly so"));
    problem.placed.resize(problem.motions.size());
    problem.level_placed.resize(problem.motions.size());
    for (std::size_t b = 0; b < problem.motions.size(); ++b) {
        if (!goes_onto(problem.motions[b])) continue;
        problem.placed[b].x = x;
        problem.level_placed[b].x = start;
    }
    problem.target = make_target(mesh, mesh.x, problem.motions, problem.level_placed, problem.shared);
    prescribe_shared_nodes(mesh, problem.target);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (!goes_onto(problem.motions[mesh.face_boundary[f]])) return;
        const bool is_left = at_node(goal, mesh.faces[k], mesh.dim) != at_node(start, mesh.faces[k], mesh.dim);
        std::copy_n(point(goal, mesh.faces[k], mesh.dim), mesh.dim, &problem.target.written[k * mesh.dim]);
        if (is_improved(options.ideal) && !is_left) return;
        problem.target.kind[k] = std::min(problem.target.kind[k], NodeKind::target);
        problem.target.written_kind[k] = problem.target.kind[k];
    });
    problem.node_target = problem.target.node;
    problem.frame.take_to_run(start, problem.base.dim);
    if (problem.start.empty()) problem.start = std::move(start);
}

void hold_off_surface(Problem& problem) {
    if (!problem.sliding || std::none_of(problem.motions.begin(), problem.motions.end(), goes_onto)) return;
    const Mesh& mesh = problem.mesh();
    const auto constraint =
        make_constraint(mesh, problem.ideal(), problem.target, TargetKind::nodal, problem.sliding);
    const std::vector<char> off = constraint->off_target(problem.start);
    std::vector<char> stays(mesh.nodes(), 0);
    for (std::size_t t = 0; t < off.size(); ++t) stays[constraint->nodes()[t]] = off[t];
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (stays[mesh.faces[k]] && goes_onto(problem.motions[mesh.face_boundary[f]]))
            problem.target.kind[k] = std::min(problem.target.kind[k], NodeKind::target);
    });
    if (problem.target.prescribes_all()) problem.sliding = nullptr;
}

std::string distances_text(const ProblemOptions& options, const Problem& problem, const std::vector<double>& x) {
    std::string text;
    for (const SurfacePairing& to : surface_pairings(options, problem, problem.mesh(), Frame()))
        text += to.distances(PatchedFaces(problem.mesh(), x, to.own));
    return text;
}

}  // namespace almesh
