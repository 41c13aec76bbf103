#include "problem/folded_target.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <set>

#include "report/results.hpp"
#include "deck/deck_checks.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "check/infeasible.hpp"
#include "mesh/split.hpp"

namespace almesh {
namespace {

// "2 faces and 1 element"
std::string counts_of(const TargetFaults& faults) {
    const std::size_t faces = faults.faces.faults.size(), elements = faults.elements.size();
    return (faces ? counted(faces, "face") : "") + (faces && elements ? " and " : "") +
           (elements ? counted(elements, "element") : "");
}

void refuse(const CheckedTarget& checked, const TargetFaults& faults, const std::string& advice) {
    const std::string message = faults.faces.faults.empty() ? "no valid mesh reaches the target: it inverts "
                                                            : "the target makes the boundary itself invalid at ";
    std::vector<int> elements;
    std::vector<double> scaled_jacobian(checked.mesh.element_count());
    for (const ElementFault& fault : faults.elements) {
        elements.push_back(fault.element);
        scaled_jacobian[fault.element] = fault.scaled_jacobian;
    }
    const InvalidElements all = list_invalid(checked.mesh, elements, checked.mesh.x, scaled_jacobian);
    throw InputError(message, counts_of(faults), ":", describe(checked.mesh, faults),
                     write_invalid(all, checked.deck.output), advice);
}

// Whether what is at fault may stay invalid: elements of a mesh that is improved, which lists them (improve.hpp), and
// faces of it that are where the file has them.
bool may_stay_invalid(const CheckedTarget& checked, const TargetFaults& faults) {
    const Mesh& mesh = checked.mesh;
    const auto stays = [&](const TargetReport::Fault& fault) {
        const int* const node = mesh.face(fault.face);
        for (int k = 0; k < mesh.face_nodes(fault.face); ++k)
            if (!std::equal(point(mesh.x, node[k], mesh.dim), point(mesh.x, node[k], mesh.dim) + mesh.dim,
                            checked.target.node_of(mesh, fault.face) + k * mesh.dim))
                return false;
        return true;
    };
    return is_improved(checked.deck.ideal) &&
           std::all_of(faults.faces.faults.begin(), faults.faces.faults.end(), stays);
}

// "\ntry A, B or C": what helps, or may.
std::string advice(const TargetFaults& faults, const CheckedTarget& checked) {
    const Deck& deck = checked.deck;
    const bool can_divide = std::all_of(faults.elements.begin(), faults.elements.end(),
                                        [](const ElementFault& fault) { return fault.can_be_divided; });
    std::vector<std::string> to_try;
    const auto accepted = [&](const char* key, const char* value) { return accepts(deck, checked.mesh, key, value); };
    if (deck.surface == SurfaceKind::keep && faults.sliding_may_help())
        to_try.push_back("surface = auto (nodes slide along the surface there)");
    if (faults.faces.faults.empty()) {
        if (deck.split == Split::never && can_divide && accepted("split", "auto"))
            to_try.push_back("split = auto (just these are divided, with the elements at the same edges)");
        if (checked.file_degree == 1 && deck.refine < most_refinements && !checked.folds_when_refined())
            to_try.push_back(concat("refine = ", deck.refine + 1, " (all elements are divided)"));
        if (!checked.mesh.is_simplicial()) to_try.push_back("a mesh with more elements there");
        else if (!can_divide)
            to_try.push_back("a mesh in which each of these has an edge that is on no boundary");
        to_try.push_back("targets that do not invert them");
    }
    std::string text;
    for (std::size_t k = 0; k < to_try.size(); ++k)
        text += (k == 0 ? "\ntry " : k + 1 < to_try.size() ? ", " : " or ") + to_try[k];
    return text;
}

// Scaled Jacobian of elements that the target alone determines up to which they are faults.
double bound_of_faults(const CheckedTarget& checked) {
    constexpr double useless = 0.01;  // leaves no element of any use
    if (checked.deck.distortion.delta > 0) return -std::numeric_limits<double>::infinity();
    return checked.deck.surface == SurfaceKind::keep || checked.is_own_ideal ? 0 : useless;
}

TargetFaults faults_of(const CheckedTarget& checked) {
    return find_faults(checked.mesh, checked.ideal, checked.target, bound_of_faults(checked));
}

std::string note_of(const CheckedTarget& checked, const TargetFaults& faults, const Mesh& mesh,
                    const std::string& what_is_done) {
    return concat("the target makes ", counts_of(faults), " invalid or nearly invalid (scaled Jacobian at most ",
                  bound_of_faults(checked), "); ", what_is_done, ":", describe(mesh, faults));
}

int count(const std::vector<char>& chosen) { return static_cast<int>(std::count(chosen.begin(), chosen.end(), 1)); }

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

int split_folded(const CheckedTarget& checked, Mesh& base, std::vector<std::string>& notes) {
    const Deck& deck = checked.deck;
    if (deck.split == Split::never) return 0;
    TargetFaults faults = faults_of(checked), faults_in_file;
    if (!all_by_curvature(faults.faces.faults)) return 0;  // what no element can mend
    std::vector<int> elements;
    for (ElementFault& fault : faults.elements) {
        fault.element >>= base.dim * deck.refine;  // of the file, which has it or has it as a part
        if (!elements.empty() && elements.back() == fault.element) continue;
        elements.push_back(fault.element);
        faults_in_file.elements.push_back(fault);
    }
    if (deck.split == Split::around) add_around(base, elements);
    std::set<Simplex> at;
    for (const std::vector<Simplex>& inner : inner_simplices(base, elements)) at.insert(inner.begin(), inner.end());
    if (at.empty()) return 0;
    Mesh divided = split(base, {at.begin(), at.end()});
    notes.push_back(note_of(checked, faults_in_file, base,
                            concat("divided by ", counted(at.size(), "node"), " inside, the mesh has ",
                                   divided.element_count() - base.element_count(), " elements more")));
    if (divided.file.sections.size() < base.file.sections.size())
        notes.push_back("not in the final mesh, as its elements are not those of the file: $ElementNodeData");
    base = std::move(divided);
    return static_cast<int>(faults_in_file.elements.size());
}

std::string free_folded(const CheckedTarget& checked) {
    const Mesh& mesh = checked.mesh;
    BoundaryTarget& target = checked.target;
    const TargetFaults faults = faults_of(checked);
    if (faults.none()) return "";
    const bool stays = !faults.sliding_may_help() || checked.deck.surface == SurfaceKind::keep;
    if (stays && may_stay_invalid(checked, faults)) return "";
    if (stays) refuse(checked, faults, advice(faults, checked));
    target.freed = freed_nodes(mesh, target, faults);
    const TargetFaults left = faults_of(checked);
    if (!left.none() && !may_stay_invalid(checked, left)) refuse(checked, left, advice(left, checked));
    return note_of(checked, faults, mesh,
                   counted(count(target.freed), "node") + " around them slide along the surface");
}

}  // namespace almesh
