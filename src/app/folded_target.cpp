#include "app/folded_target.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "check/freed_nodes.hpp"

namespace almesh {
namespace {

// "2 faces and 1 element"
std::string counts_of(const TargetFaults& faults) {
    const std::size_t faces = faults.faces.faults.size(), elements = faults.elements.size();
    return (faces ? counted(faces, "face") : "") + (faces && elements ? " and " : "") +
           (elements ? counted(elements, "element") : "");
}

void refuse(const Mesh& mesh, const TargetFaults& faults, const std::string& advice) {
    const std::string message = faults.faces.faults.empty() ? "no valid mesh reaches the target: it inverts "
                                                            : "the target makes the boundary itself invalid at ";
    throw InputError(message, counts_of(faults), ":", describe(mesh, faults), advice);
}

// What helps against elements all of whose vertices are on the boundary. Where two of its faces are, an element is in a
// corner or along an edge, and so is one of those that it is split into; whether that one is folded too is tried.
std::string against(const TargetFaults& faults, const CheckedTarget& checked) {
    const Mesh& mesh = checked.mesh;
    if (faults.elements.empty() || !faults.faces.faults.empty()) return "";
    const bool may_refine = checked.file_degree == 1 && checked.deck.refine < most_refinements;
    if (may_refine && !checked.folds_when_refined())
        return concat("\ntry refine = ", checked.deck.refine + 1,
                      ", so that they are divided, or targets that do not invert them");
    const bool stays = std::any_of(faults.elements.begin(), faults.elements.end(), [&](const DeterminedElement& fault) {
        return std::count(mesh.face_element.begin(), mesh.face_element.end(), fault.element) > 1;
    });
    if (stays)
        return "\ntry targets that do not invert them, or a mesh in which they are divided by a node inside (refine "
               "leaves such an element there)";
    return "\ntry a finer mesh, so that they are divided, or targets that do not invert them";
}

// Scaled Jacobian of elements that the target alone determines up to which they are faults.
double bound_of_faults(const Deck& deck) {
    constexpr double useless = 0.01;  // leaves no element of any use
    if (deck.distortion.delta > 0) return -std::numeric_limits<double>::infinity();
    return deck.surface == SurfaceKind::keep ? 0 : useless;
}

TargetFaults faults_of(const CheckedTarget& checked) {
    return find_faults(checked.mesh, checked.ideal, checked.target, bound_of_faults(checked.deck));
}

std::string note_of(const TargetFaults& faults, const Mesh& mesh, const std::string& what_is_done) {
    return concat("the target inverts ", counts_of(faults), ", or nearly so; ", what_is_done, ":",
                  describe(mesh, faults));
}

int count(const std::vector<char>& chosen) { return static_cast<int>(std::count(chosen.begin(), chosen.end(), 1)); }

// Faces to be made flat against the faults, but for those that are: those at fault and those of elements at fault;
// where all of these are, those beside them.
std::vector<char> faces_at_fault(const Mesh& mesh, const TargetFaults& faults, const std::vector<char>& straight) {
    std::vector<char> chosen(mesh.face_count(), 0), vertex(mesh.nodes(), 0), at_fault(mesh.element_count(), 0);
    for (const TargetReport::Fault& fault : faults.faces.faults) chosen[fault.face] = 1;
    for (const auto& [f, g] : faults.faces.crossing) chosen[f] = chosen[g] = 1;
    for (const DeterminedElement& fault : faults.elements) {
        at_fault[fault.element] = 1;
        for (int i = 0; i <= mesh.dim; ++i) vertex[mesh.element(fault.element)[i]] = 1;
    }
    for (int f = 0; f < mesh.face_count(); ++f) chosen[f] = chosen[f] || at_fault[mesh.face_element[f]];
    const auto leave_out_straight = [&] {
        for (std::size_t f = 0; f < straight.size(); ++f) chosen[f] = chosen[f] && !straight[f];
        return count(chosen) > 0;
    };
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int i = 0; i < mesh.dim && chosen[f]; ++i) vertex[mesh.face(f)[i]] = 1;
    if (leave_out_straight()) return chosen;
    for (int f = 0; f < mesh.face_count(); ++f)
        chosen[f] = std::any_of(mesh.face(f), mesh.face(f) + mesh.dim, [&](int i) { return vertex[i]; });
    leave_out_straight();
    return chosen;
}

}  // namespace

void straighten_target(const CheckedTarget& checked, std::vector<char> chosen) {
    const Mesh& mesh = checked.mesh;
    BoundaryTarget& target = checked.target;
    for (;;) {
        if (count(chosen) > 0) {
            BoundaryTarget of_file = target;
            of_file.node.swap(checked.node_target);
            make_straight(mesh, chosen, of_file);
            of_file.node.swap(checked.node_target);
            make_straight(mesh, chosen, target);
        }
        const TargetFaults faults = faults_of(checked);
        if (faults.none()) return;
        chosen = faces_at_fault(mesh, faults, target.straight);
        if (count(chosen) == 0)
            refuse(mesh, faults,
                   target.straight.empty() ? against(faults, checked)
                                           : "\ntry a finer mesh there: its faces cannot be flat");
    }
}

std::string straighten_folded(const CheckedTarget& checked) {
    const TargetFaults faults = faults_of(checked);
    if (faults.none()) return "";
    straighten_target(checked, faces_at_fault(checked.mesh, faults, {}));
    const int flat = count(checked.target.straight);
    return note_of(faults, checked.mesh,
                   counted(flat, "face") + (flat == 1 ? " there is" : " there are") + " made flat");
}

std::string free_folded(const CheckedTarget& checked) {
    const Mesh& mesh = checked.mesh;
    BoundaryTarget& target = checked.target;
    const TargetFaults faults = faults_of(checked);
    if (faults.none()) return "";
    if (!faults.sliding_may_help()) refuse(mesh, faults, against(faults, checked));
    if (checked.deck.surface == SurfaceKind::keep)
        refuse(mesh, faults,
               "\ntry surface = auto (nodes slide along the surface there) or surface = straighten (faces become flat "
               "there)");
    target.freed = freed_nodes(mesh, target, faults);
    const TargetFaults left = faults_of(checked);
    if (!left.none()) refuse(mesh, left, against(left, checked));
    return note_of(faults, mesh, counted(count(target.freed), "node") + " around them slide along the surface");
}

}  // namespace almesh
