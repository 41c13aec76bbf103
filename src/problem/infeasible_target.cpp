#include "problem/infeasible_target.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "base/text.hpp"
#include "mesh/part.hpp"
#include "mesh/split.hpp"

namespace almesh {
namespace {

// "2 faces and 1 element"
std::string counts_of(const Infeasible& infeasible) {
    const std::size_t faces = infeasible.faces.faults.size(), elements = infeasible.elements.size();
    return (faces ? counted(faces, "face") : "") + (faces && elements ? " and " : "") +
           (elements ? counted(elements, "element") : "");
}

// Scaled determinant up to which elements that the target determines are infeasible.
double bound_of(const ProblemOptions& options, const Problem& problem) {
    constexpr double useless = 0.01;  // leaves no element of any use
    if (options.distortion.delta > 0) return -std::numeric_limits<double>::infinity();
    return options.surface == SurfaceKind::keep || problem.is_own_ideal ? 0 : useless;
}

Infeasible find_infeasible(const ProblemOptions& options, const Problem& problem) {
    return find_infeasible(problem.mesh(), problem.ideal(), problem.target, bound_of(options, problem));
}

// Whether what is infeasible may stay so: elements of a mesh that is improved, which lists them (improve.hpp), and
// faces of it that are where the file has them.
bool may_stay_invalid(const ProblemOptions& options, const Problem& problem, const Infeasible& infeasible) {
    const Mesh& mesh = problem.mesh();
    const auto stays = [&](const TargetReport::Fault& fault) {
        const int* const node = mesh.face(fault.face);
        for (int k = 0; k < mesh.face_nodes(fault.face); ++k)
            if (!std::equal(point(mesh.x, node[k], mesh.dim), point(mesh.x, node[k], mesh.dim) + mesh.dim,
                            problem.target.node_of(mesh, fault.face) + k * mesh.dim))
                return false;
        return true;
    };
    return is_improved(options.ideal) &&
           std::all_of(infeasible.faces.faults.begin(), infeasible.faces.faults.end(), stays);
}

std::string note_of(const ProblemOptions& options, const Problem& problem, const Infeasible& infeasible,
                    const Mesh& mesh, const std::string& what_is_done) {
    return concat("the target makes ", counts_of(infeasible), " invalid or nearly invalid (scaled determinant at most ",
                  bound_of(options, problem), "); ", what_is_done, ":", describe(mesh, infeasible));
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

InfeasibleTarget::InfeasibleTarget(const ProblemOptions& options, const Problem& problem, const Infeasible& infeasible)
    : InputError(infeasible.faces.faults.empty() ? "no valid mesh reaches the target: it inverts "
                                                 : "the target makes the boundary itself invalid at ",
                 counts_of(infeasible), ":", describe(problem.mesh(), infeasible)),
      sliding_may_help(infeasible.sliding_may_help()), division_helps(infeasible.division_helps()),
      is_of_elements(infeasible.faces.faults.empty()), is_simplicial(problem.mesh().is_simplicial()),
      refining_helps(is_of_elements && problem.base.degree == 1 && options.refine < most_refinements) {
    const Mesh& mesh = problem.mesh();
    std::vector<double> value(mesh.element_count());
    for (const InfeasibleElement& of : infeasible.elements) value[of.element] = of.scaled_determinant;
    list = list_elements(mesh, elements_of(mesh, {{}, infeasible.elements}), mesh.x, value, {}, "scaled determinant");
    if (!refining_helps) return;
    PlacedNodes placed = problem.placed;
    BoundaryTarget target;
    const auto level = discretise(problem, options.refine + 1, mesh.degree, placed, target);
    refining_helps = find_infeasible(level->mesh, level->ideal, target).none();
}

int split_infeasible(const ProblemOptions& options, Problem& problem) {
    if (options.split == Split::never) return 0;
    Mesh& base = problem.base;
    const Infeasible infeasible = find_infeasible(options, problem);
    if (!infeasible.faces_by_curvature()) return 0;  // what no element can mend
    Infeasible in_file;
    for (InfeasibleElement of : infeasible.elements) {
        of.element >>= base.dim * options.refine;  // of the file, which has it or has it as a part
        if (in_file.elements.empty() || in_file.elements.back().element != of.element) in_file.elements.push_back(of);
    }
    std::vector<int> elements = elements_of(base, in_file);
    if (options.split == Split::around) add_around(base, elements);
    std::set<Simplex> at;
    for (const std::vector<Simplex>& inner : inner_simplices(base, elements)) at.insert(inner.begin(), inner.end());
    if (at.empty()) return 0;
    Mesh divided = split(base, {at.begin(), at.end()});
    problem.notes.push_back(note_of(options, problem, in_file, base,
                            concat("divided by ", counted(at.size(), "node"), " inside, the mesh has ",
                                   divided.element_count() - base.element_count(), " elements more")));
    base = std::move(divided);
    return static_cast<int>(in_file.elements.size());
}

void free_infeasible(const ProblemOptions& options, Problem& problem) {
    const Mesh& mesh = problem.mesh();
    const Infeasible infeasible = find_infeasible(options, problem);
    if (infeasible.none()) return;
    const bool stays = !infeasible.sliding_may_help() || options.surface == SurfaceKind::keep;
    if (stays && may_stay_invalid(options, problem, infeasible)) return;
    if (stays) throw InfeasibleTarget(options, problem, infeasible);
    std::vector<char> freed = nodes_to_free(mesh, problem.target, infeasible);
    problem.pairs.keep(freed);
    free_nodes(mesh, freed, problem.target);
    const Infeasible left = find_infeasible(options, problem);
    if (!left.none() && !may_stay_invalid(options, problem, left))
        throw InfeasibleTarget(options, problem, left);
    const auto count = std::count(freed.begin(), freed.end(), 1);
    problem.notes.push_back(note_of(options, problem, infeasible, mesh,
                                    counted(static_cast<std::size_t>(count), "node") +
                                        " around them slide along the surface"));
}

}  // namespace almesh
