#include "problem/curved_part.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "check/straightened.hpp"
#include "constraint/sliding_boundary.hpp"
#include "constraint/sliding_nodes.hpp"
#include "method/levels.hpp"
#include "method/polish.hpp"

namespace almesh {
namespace {

constexpr int most_al_iterations = 6, most_newton_steps = 16;  // a part that needs more fails
constexpr double first_penalty = 1e3, next_penalty = 1e5;  // in units of |1|^2
// A feasible part comes this near to its target, relative to its initial distance, within a few steps with the first
// penalty, and ten times nearer with the next one.
constexpr double near = 0.25, nearer = 0.1;

// Minimises from result.x with growing penalties while the boundary comes near enough to its target; returns whether it
// does.
bool minimise(const ProblemOptions& options, const Level& level, int first_steps, CurvedPartResult& result) {
    Newton newton(level.energy->hessian_pattern(), options.linear, {.forcing = options.forcing});
    AlStart start = AlStart::from_near(*level.constraint);
    AlResult& al = result.al;
    const auto distance = [&] { return level.constraint->projected_norm(result.x); };
    const double way = distance();
    const auto minimise_with = [&](double mu, int al_iterations, int newton_steps) {
        start.mu = mu;
        AugmentedLagrangianParams limits = options.method;
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

CurvedPart::CurvedPart(const Problem& whole, const std::vector<char>& chosen, const std::vector<double>& at,
                       const std::vector<double>& to)
    : MeshPart(part_of(whole.mesh(), chosen, "the rest of the mesh")) {
    in_file = x;
    x = restricted(whole.ideal());
    start = restricted(at);
    curved = restricted(to);
    for (std::size_t k = 0; k < curved.size(); ++k)
        if (on_cut[k / dim]) curved[k] = start[k];
}

Infeasible CurvedPart::find_infeasible(double bound) const {
    return almesh::find_infeasible(*this, x, fixed_at(curved), bound);
}

BoundaryTarget CurvedPart::fixed_at(const std::vector<double>& positions) const {
    BoundaryTarget target = make_target(*this, positions, std::vector(boundaries.size(), motion_of(NodeKind::fixed)));
    if (!freed.empty()) almesh::free_nodes(*this, freed, target);
    return target;
}

std::vector<char> CurvedPart::nodes_to_free(const Infeasible& infeasible, bool around) const {
    if (around) return almesh::nodes_to_free(*this, fixed_at(curved), infeasible);
    std::vector<char> is_chosen(element_count(), 0);
    for (const int e : elements_of(*this, infeasible)) is_chosen[e] = 1;
    return nodes_with(*this, [&](int f, std::size_t) { return is_chosen[face_element[f]]; });
}

void CurvedPart::free_nodes(std::vector<char> chosen) {
    for (int i = 0; i < nodes(); ++i) chosen[i] = chosen[i] && !on_cut[i];
    if (std::count(chosen.begin(), chosen.end(), 1) == 0) return;
    freed = std::move(chosen);
    for (std::size_t k = 0; k < curved.size(); ++k)
        if (freed[k / dim]) curved[k] = in_file[k];
}

void CurvedPart::free_nodes_in(const std::vector<char>& of_whole, bool vertices_too) {
    std::vector<char> chosen(nodes(), 0);
    for (const int i : faces) chosen[i] = of_whole[node_of[i]];
    for (int f = 0; f < face_count() && !vertices_too; ++f)
        for (const int i : face_vertices(f)) chosen[i] = 0;
    free_nodes(std::move(chosen));
}

void CurvedPart::flatten(double bound) {
    constexpr double useful = 0.05;  // scaled determinant of elements at fault, when they no longer are
    std::vector<char> at_fault(element_count(), 0);
    for (const int e : elements_of(*this, find_infeasible(bound))) at_fault[e] = 1;
    curved = straightened(*this, x, curved, [&](const std::vector<double>& at) {
        curved = at;
        Infeasible infeasible = find_infeasible(std::max(bound, useful));
        std::erase_if(infeasible.elements, [&](const InfeasibleElement& of) {
            return of.scaled_determinant > bound && !at_fault[of.element];
        });
        return elements_of(*this, infeasible);
    }).x;
}

CurvedPartResult curve(const ProblemOptions& options, const CurvedPart& part, const SlidingSurfaces* surfaces,
                       int first_steps) {
    Problem problem;
    problem.motions.assign(part.boundaries.size(), motion_of(NodeKind::fixed));
    problem.level = std::make_unique<Level>();
    problem.level->mesh = part;
    problem.level->mesh.x = part.curved;
    problem.level->ideal = part.x;
    problem.target = part.fixed_at(part.curved);
    if (!part.freed.empty())
        problem.sliding = std::make_shared<SlidingSurfaces>(*surfaces, part, surfaces->frame());
    set_functional(options, problem);
    const Level& level = *problem.level;
    CurvedPartResult result{part.start, {}, {}};
    if (!minimise(options, level, first_steps, result)) return result;
    if (snap_to_targets(*level.energy, *level.constraint, result.x) > 0) return result;
    result.certificate = certify(part, result.x);
    result.certificate.valid = certify_curved(part, part.x, part.start, result.x, result.certificate).certified;
    return result;
}

}  // namespace almesh
