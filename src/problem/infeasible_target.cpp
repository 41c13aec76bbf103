#include "problem/infeasible_target.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "mesh/part.hpp"
#include "report/results.hpp"
#include "deck/deck_checks.hpp"
#include "problem/problem.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "check/infeasible.hpp"
#include "mesh/split.hpp"

namespace almesh {
namespace {

// "2 faces and 1 element"
std::string counts_of(const Infeasible& infeasible) {
    const std::size_t faces = infeasible.faces.faults.size(), elements = infeasible.elements.size();
    return (faces ? counted(faces, "face") : "") + (faces && elements ? " and " : "") +
           (elements ? counted(elements, "element") : "");
}

// Scaled Jacobian up to which elements that the target determines are infeasible.
double bound_of(const Deck& deck, const Problem& problem) {
    constexpr double useless = 0.01;  // leaves no element of any use
    if (deck.distortion.delta > 0) return -std::numeric_limits<double>::infinity();
    return deck.surface == SurfaceKind::keep || problem.is_own_ideal ? 0 : useless;
}

Infeasible find_infeasible(const Deck& deck, const Problem& problem) {
    return find_infeasible(problem.mesh(), problem.ideal(), problem.target, bound_of(deck, problem));
}

// "\ntry A, B or C": what helps, or may.
std::string advice(const Deck& deck, const Problem& problem, const Infeasible& infeasible) {
    const auto feasible_when_refined = [&] {
        PlacedNodes placed = problem.placed;
        BoundaryTarget target;
        const auto level = discretise(problem, deck.refine + 1, problem.mesh().degree, placed, target);
        return find_infeasible(level->mesh, level->ideal, target).none();
    };
    std::vector<std::string> to_try;
    if (deck.surface == SurfaceKind::keep && infeasible.sliding_may_help() &&
        accepts(deck, problem.mesh(), "surface", "auto"))
        to_try.push_back("surface = auto (nodes slide along the surface there)");
    if (infeasible.faces.faults.empty()) {
        if (deck.split == Split::never && infeasible.division_helps() && accepts(deck, problem.mesh(), "split", "auto"))
            to_try.push_back("split = auto (just these are divided, with the elements at the same edges)");
        if (problem.base.degree == 1 && deck.refine < most_refinements && feasible_when_refined())
            to_try.push_back(concat("refine = ", deck.refine + 1, " (all elements are divided)"));
        if (!problem.mesh().is_simplicial()) to_try.push_back("a mesh with more elements there");
        else if (!infeasible.division_helps())
            to_try.push_back("a mesh in which each of these has an edge that is on no boundary");
        to_try.push_back("targets that do not invert them");
    }
    std::string text;
    for (std::size_t k = 0; k < to_try.size(); ++k)
        text += (k == 0 ? "\ntry " : k + 1 < to_try.size() ? ", " : " or ") + to_try[k];
    return text;
}

void refuse(const Deck& deck, const Problem& problem, const Infeasible& infeasible) {
    const std::string message = infeasible.faces.faults.empty() ? "no valid mesh reaches the target: it inverts "
                                                                : "the target makes the boundary itself invalid at ";
    std::vector<double> scaled_jacobian(problem.mesh().element_count());
    for (const InfeasibleElement& of : infeasible.elements) scaled_jacobian[of.element] = of.scaled_jacobian;
    const InvalidElements all = list_invalid(problem.mesh(), elements_of(problem.mesh(), {{}, infeasible.elements}),
                                             problem.mesh().x, scaled_jacobian);
    throw InputError(message, counts_of(infeasible), ":", describe(problem.mesh(), infeasible),
                     write_invalid(all, deck.output), advice(deck, problem, infeasible));
}

// Whether what is infeasible may stay so: elements of a mesh that is improved, which lists them (improve.hpp), and
// faces of it that are where the file has them.
bool may_stay_invalid(const Deck& deck, const Problem& problem, const Infeasible& infeasible) {
    const Mesh& mesh = problem.mesh();
    const auto stays = [&](const TargetReport::Fault& fault) {
        const int* const node = mesh.face(fault.face);
        for (int k = 0; k < mesh.face_nodes(fault.face); ++k)
            if (!std::equal(point(mesh.x, node[k], mesh.dim), point(mesh.x, node[k], mesh.dim) + mesh.dim,
                            problem.target.node_of(mesh, fault.face) + k * mesh.dim))
                return false;
        return true;
    };
    return is_improved(deck.ideal) &&
           std::all_of(infeasible.faces.faults.begin(), infeasible.faces.faults.end(), stays);
}

std::string note_of(const Deck& deck, const Problem& problem, const Infeasible& infeasible, const Mesh& mesh,
                    const std::string& what_is_done) {
    return concat("the target makes ", counts_of(infeasible), " invalid or nearly invalid (scaled Jacobian at most ",
                  bound_of(deck, problem), "); ", what_is_done, ":", describe(mesh, infeasible));
}

// Elements with two vertices of those that are chosen; of a mesh of simplices.
void add_around(const Mesh& mesh, std::vector<int>& elements) {
    std::vector<char> is_vertex(mesh.nodes(), 0);
    for (const int e : elements)
        for (int k = 0; k <= mesh.dim; ++k) is_vertex[mesh.element(e)[k]] = 1;
    elements.clear();
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int* const node = mesh.element(e);
        const auto is_chosen = [&](int i) { return is_vertex[i]; };
        if (std::count_if(node, node + mesh.dim + 1, is_chosen) > 1) elements.push_back(e);
    }
}

}  // namespace

int split_infeasible(const Deck& deck, Problem& problem, std::vector<std::string>& notes) {
    if (deck.split == Split::never) return 0;
    Mesh& base = problem.base;
    const Infeasible infeasible = find_infeasible(deck, problem);
    if (!infeasible.faces_by_curvature()) return 0;  // what no element can mend
    Infeasible in_file;
    for (InfeasibleElement of : infeasible.elements) {
        of.element >>= base.dim * deck.refine;  // of the file, which has it or has it as a part
        if (in_file.elements.empty() || in_file.elements.back().element != of.element) in_file.elements.push_back(of);
    }
    std::vector<int> elements = elements_of(base, in_file);
    if (deck.split == Split::around) add_around(base, elements);
    std::set<Simplex> at;
    for (const std::vector<Simplex>& inner : inner_simplices(base, elements)) at.insert(inner.begin(), inner.end());
    if (at.empty()) return 0;
    Mesh divided = split(base, {at.begin(), at.end()});
    notes.push_back(note_of(deck, problem, in_file, base,
                            concat("divided by ", counted(at.size(), "node"), " inside, the mesh has ",
                                   divided.element_count() - base.element_count(), " elements more")));
    if (divided.file.sections.size() < base.file.sections.size())
        notes.push_back("not in the final mesh, as its elements are not those of the file: $ElementNodeData");
    base = std::move(divided);
    return static_cast<int>(in_file.elements.size());
}

void free_infeasible(const Deck& deck, Problem& problem) {
    const Mesh& mesh = problem.mesh();
    const Infeasible infeasible = find_infeasible(deck, problem);
    if (infeasible.none()) return;
    const bool stays = !infeasible.sliding_may_help() || deck.surface == SurfaceKind::keep;
    if (stays && may_stay_invalid(deck, problem, infeasible)) return;
    if (stays) refuse(deck, problem, infeasible);
    const std::vector<char> freed = nodes_to_free(mesh, problem.target, infeasible);
    free_nodes(mesh, freed, problem.target);
    const Infeasible left = find_infeasible(deck, problem);
    if (!left.none() && !may_stay_invalid(deck, problem, left)) refuse(deck, problem, left);
    const auto count = std::count(freed.begin(), freed.end(), 1);
    problem.notes.push_back(note_of(deck, problem, infeasible, mesh,
                                    counted(static_cast<std::size_t>(count), "node") +
                                        " around them slide along the surface"));
}

}  // namespace almesh
