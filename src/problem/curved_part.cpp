#include "problem/curved_part.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "check/straightened.hpp"
#include "constraint/sliding_boundary.hpp"
#include "constraint/sliding_nodes.hpp"
#include "mesh/part.hpp"
#include "method/levels.hpp"
#include "method/snap.hpp"

namespace almesh {
namespace {

constexpr int most_al_iterations = 6, most_newton_steps = 16;  // what needs more is not to be had
constexpr double first_penalty = 1e3, next_penalty = 1e5;  // in units of |1|^2
// What can be had comes this near to its target, of the way there, within a few steps with the first penalty, and ten
// times as near with the next one.
constexpr double near = 0.25, nearer = 0.1;

std::vector<double> gathered(const std::vector<double>& field, const std::vector<int>& node, int dim) {
    std::vector<double> of_part;
    for (const int i : node) of_part.insert(of_part.end(), point(field, i, dim), point(field, i, dim) + dim);
    return of_part;
}

// All boundaries fixed at these positions, but for nodes that are freed.
BoundaryTarget fixed_at(Mesh mesh, const std::vector<double>& x, const std::vector<char>& freed) {
    mesh.x = x;
    BoundaryTarget target = make_target(mesh, std::vector(mesh.boundaries.size(), motion_of(NodeKind::fixed)));
    if (!freed.empty()) free_nodes(mesh, freed, target);
    return target;
}

// The smooth surfaces at the nodes of the file, wherever they have slid meanwhile.
std::shared_ptr<SlidingSurfaces> surfaces_of_part(const SlidingSurfaces& whole, const CurvedPart& part) {
    auto surfaces = std::make_shared<SlidingSurfaces>(whole, part.face, part.mesh, whole.frame());
    const std::vector<double> in_file = whole.frame().to_file(part.file, part.mesh.dim);
    smooth_freed(part.mesh, fixed_at(part.mesh, in_file, part.freed), *surfaces);
    return surfaces;
}

// From the start in result.x: with penalties that grow while the boundary comes near enough to its target. Whether it
// does.
bool minimise(const Deck& deck, const Level& level, int first_steps, CurvedPartResult& result) {
    Newton newton(level.energy->hessian_pattern(), deck.linear, {.forcing = deck.forcing});
    AlStart start = AlStart::from_near(*level.constraint);
    AlResult& al = result.al;
    const auto distance = [&] { return level.constraint->projected_norm(result.x); };
    const double way = distance();
    const auto minimise_with = [&](double mu, int al_iterations, int newton_steps) {
        start.mu = mu;
        AugmentedLagrangianParams limits = deck.method;
        limits.max_iterations = std::min(limits.max_iterations, al_iterations);
        limits.max_newton_iterations = std::min(limits.max_newton_iterations, newton_steps);
        const int steps = al.newton_iterations;
        al = minimise(*level.energy, *level.constraint, newton, limits, result.x, {}, start);
        al.newton_iterations += steps;
    };
    const auto update_multipliers = [&] {
        level.constraint->update_multipliers(result.x, al.iterations.back().mu, start.lambda);
    };
    minimise_with(first_penalty, 1, first_steps);
    if (al.status == Status::max_newton_iterations && distance() <= near * way)
        minimise_with(first_penalty, 1, most_newton_steps - first_steps);
    const double left = distance();
    if (al.iterations.back().newton_status != Status::converged && left > near * way) return false;
    update_multipliers();
    minimise_with(next_penalty, 1, most_newton_steps / 2);
    if (al.status == Status::max_newton_iterations || distance() > nearer * left) return false;
    update_multipliers();
    minimise_with(next_penalty, most_al_iterations, most_newton_steps);
    return true;
}

// By their vertices: the part has them by type.
std::vector<int> faces_of_whole(const Mesh& mesh, const std::vector<char>& chosen, const CurvedPart& part) {
    const auto sorted = [](std::vector<int> vertices) {
        std::sort(vertices.begin(), vertices.end());
        return vertices;
    };
    std::map<std::vector<int>, int> known;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (const auto of = mesh.face_vertices(f); chosen[mesh.face_element[f]])
            known[sorted({of.begin(), of.end()})] = f;
    std::vector<int> faces;
    for (int f = 0; f < part.mesh.face_count(); ++f) {
        std::vector<int> vertices;
        for (const int i : part.mesh.face_vertices(f)) vertices.push_back(part.node[i]);
        const bool is_cut = part.mesh.face_boundary[f] == part.mesh.cut;
        faces.push_back(is_cut ? -1 : known.at(sorted(std::move(vertices))));
    }
    return faces;
}

}  // namespace

double work_of(const Mesh& mesh, int e) { return std::pow(mesh.element_nodes(e), 2); }

std::vector<std::vector<int>> places_of(const Mesh& mesh, const std::vector<char>& chosen, std::size_t at_once) {
    constexpr double work_of_one = 400;
    std::vector<std::vector<int>> at_vertex(mesh.nodes()), places;
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.cell(e).vertices && chosen[e]; ++k) at_vertex[mesh.element(e)[k]].push_back(e);
    std::vector<char> is_left = chosen;
    for (int first = 0; first < mesh.element_count(); ++first) {
        if (!is_left[first]) continue;
        std::vector<int>& place = places.emplace_back(1, first);
        double work = work_of(mesh, first);
        is_left[first] = 0;
        for (std::size_t next = 0; next < place.size(); ++next) {
            const int* const node = mesh.element(place[next]);
            for (int k = 0; k < mesh.cell(place[next]).vertices; ++k)
                for (const int e : at_vertex[node[k]]) {
                    if (!is_left[e] || place.size() == at_once) continue;
                    if (work + work_of(mesh, e) > work_of_one * static_cast<double>(at_once)) continue;
                    is_left[e] = 0;
                    work += work_of(mesh, e);
                    place.push_back(e);
                }
        }
    }
    return places;
}

CurvedPart curved_part(const Problem& whole, const std::vector<char>& chosen, const std::vector<double>& x,
                       const std::vector<double>& curved) {
    const Mesh& mesh = whole.mesh();
    CurvedPart part;
    part.mesh = part_of(mesh, chosen, "the rest of the mesh");
    part.node.resize(part.mesh.nodes());
    for (int e = 0; e < mesh.element_count(); ++e) {
        if (!chosen[e]) continue;
        const int* const node = part.mesh.element(static_cast<int>(part.element.size()));
        for (int k = 0; k < mesh.element_nodes(e); ++k) part.node[node[k]] = mesh.element(e)[k];
        part.element.push_back(e);
    }
    part.face = faces_of_whole(mesh, chosen, part);
    part.on_cut.resize(part.mesh.nodes(), 0);
    for_face_nodes(part.mesh, [&](int f, std::size_t k) {
        if (part.mesh.face_boundary[f] == part.mesh.cut) part.on_cut[part.mesh.faces[k]] = 1;
    });
    part.mesh.x = gathered(whole.ideal(), part.node, mesh.dim);
    part.file = gathered(mesh.x, part.node, mesh.dim);
    part.start = gathered(x, part.node, mesh.dim);
    part.curved = gathered(curved, part.node, mesh.dim);
    for (int i = 0; i < part.mesh.nodes(); ++i)
        if (part.on_cut[i]) std::copy_n(point(part.start, i, mesh.dim), mesh.dim, point(part.curved, i, mesh.dim));
    return part;
}

Infeasible find_infeasible(const CurvedPart& part, double bound) {
    return find_infeasible(part.mesh, part.mesh.x, fixed_at(part.mesh, part.curved, part.freed), bound);
}

std::vector<char> nodes_to_free(const CurvedPart& part, const Infeasible& infeasible, bool around) {
    const Mesh& mesh = part.mesh;
    if (around) return nodes_to_free(mesh, fixed_at(mesh, part.curved, {}), infeasible);
    std::vector<char> chosen(mesh.element_count(), 0), freed(mesh.nodes(), 0);
    for (const int e : elements_of(mesh, infeasible)) chosen[e] = 1;
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int i = mesh.faces[k];
        if (mesh.face_boundary[f] != mesh.cut && chosen[mesh.face_element[f]] && !part.on_cut[i]) freed[i] = 1;
    });
    return freed;
}

void free_nodes(const std::vector<char>& chosen, CurvedPart& part) {
    if (std::count(chosen.begin(), chosen.end(), 1) == 0) return;
    part.freed = chosen;
    for (std::size_t k = 0; k < part.curved.size(); ++k)
        if (chosen[k / part.mesh.dim]) part.curved[k] = part.file[k];
}

void free_nodes_in(const std::vector<char>& of_whole, bool vertices_too, CurvedPart& part) {
    std::vector<char> chosen(part.mesh.nodes(), 0);
    for (const int i : part.mesh.faces) chosen[i] = of_whole[part.node[i]] && !part.on_cut[i];
    for (int f = 0; f < part.mesh.face_count() && !vertices_too; ++f)
        for (const int i : part.mesh.face_vertices(f)) chosen[i] = 0;
    free_nodes(chosen, part);
}

void flatten(CurvedPart& part, double bound) {
    constexpr double useful = 0.05;  // scaled Jacobian of elements at fault, when they no longer are
    std::vector<char> at_fault(part.mesh.element_count(), 0);
    for (const int e : elements_of(part.mesh, find_infeasible(part, bound))) at_fault[e] = 1;
    const Straightened flatter = straightened(part.mesh, part.mesh.x, part.curved, [&](const std::vector<double>& x) {
        part.curved = x;
        Infeasible infeasible = find_infeasible(part, std::max(bound, useful));
        std::erase_if(infeasible.elements, [&](const InfeasibleElement& of) {
            return of.scaled_jacobian > bound && !at_fault[of.element];
        });
        return elements_of(part.mesh, infeasible);
    });
    part.curved = flatter.x;
}

CurvedPartResult curve(const Deck& deck, const CurvedPart& part, const SlidingSurfaces* surfaces, int first_steps) {
    Problem problem;
    problem.base = part.mesh;
    problem.base.x = part.curved;
    problem.motions.assign(part.mesh.boundaries.size(), motion_of(NodeKind::fixed));
    problem.level = std::make_unique<Level>();
    problem.level->mesh = problem.base;
    problem.level->ideal = part.mesh.x;
    problem.target = fixed_at(part.mesh, part.curved, part.freed);
    if (!part.freed.empty()) problem.sliding = surfaces_of_part(*surfaces, part);
    set_functional(deck, problem);
    const Level& level = *problem.level;
    CurvedPartResult result{part.start, {}, {}};
    if (!minimise(deck, level, first_steps, result)) return result;
    if (snap_to_targets(*level.energy, *level.constraint, result.x) > 0) return result;
    result.certificate = certify(part.mesh, result.x);
    Mesh mesh = part.mesh;
    result.certificate.valid =
        certify_curved(mesh, part.mesh.x, part.start, result.x, result.certificate).certified;
    return result;
}

}  // namespace almesh
