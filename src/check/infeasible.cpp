#include "check/infeasible.hpp"

#include <algorithm>
#include <map>

#include "base/table.hpp"
#include "base/files.hpp"
#include "constraint/sliding.hpp"
#include "constraint/sliding_nodes.hpp"
#include "constraint/target.hpp"
#include "geometry/face_patches.hpp"
#include "mesh/split.hpp"

namespace almesh {
namespace {

constexpr std::size_t shown = 10;  // of a list

template <class Faults>
bool all_by_curvature(const Faults& faults) {
    return std::all_of(faults.begin(), faults.end(), [](const auto& fault) { return fault.by_curvature; });
}

// What may help against infeasible elements of a mesh of simplices.
void find_help(const Mesh& mesh, const BoundaryTarget& target, std::vector<InfeasibleElement>& elements) {
    if (!mesh.is_simplicial()) return;
    std::vector<int> element;
    for (const InfeasibleElement& of : elements) element.push_back(of.element);
    std::vector<char> prescribed;
    for (const NodeKind kind : kinds_of_boundaries(mesh, target.written_kind))
        prescribed.push_back(is_prescribed(kind));
    const auto inner = inner_simplices(mesh, element), off_prescribed = inner_simplices(mesh, element, prescribed);
    for (std::size_t k = 0; k < elements.size(); ++k) {
        const bool has_edges = off_prescribed[k].size() > 1 && off_prescribed[k][0].size() == 2;
        elements[k].sliding_may_help = elements[k].by_curvature || has_edges;
        elements[k].division_helps = !inner[k].empty();
    }
}

// The flat surfaces along which faces slide, and their nodes.
std::map<int, std::vector<char>> flat_parts(const Mesh& mesh, const BoundaryTarget& target,
                                            const SlidingSurfaces& sliding) {
    std::map<int, std::vector<char>> parts;
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (!target.slides(mesh, f)) return;
        const int part = sliding.part(mesh, f);
        if (!sliding.surface(part).is_flat()) return;
        parts.try_emplace(part, mesh.nodes(), 0).first->second[mesh.faces[k]] = 1;
    });
    return parts;
}

// Adds to the chosen faces those of the same boundary that lie in one plane with them.
void add_coplanar(const Mesh& mesh, const std::vector<double>& x, std::vector<char>& chosen) {
    constexpr double same_plane = 1e-7;  // sine of the angle between normals
    std::vector<std::vector<int>> at_node(mesh.nodes());
    std::vector<int> front;
    for (int f = 0; f < mesh.face_count(); ++f) {
        for (const int i : mesh.face_vertices(f)) at_node[i].push_back(f);
        if (chosen[f]) front.push_back(f);
    }
    while (!front.empty()) {
        const int f = front.back();
        front.pop_back();
        const Vec<3> n = unit_normal(mesh, x, f);
        for (const int i : mesh.face_vertices(f))
            for (const int g : at_node[i]) {
                if (chosen[g] || mesh.face_boundary[g] != mesh.face_boundary[f]) continue;
                const Vec<3> other = unit_normal(mesh, x, g);
                if (!(dot(n, other) > 0) || length(cross(n, other)) > same_plane) continue;
                chosen[g] = 1;
                front.push_back(g);
            }
    }
}

}  // namespace

bool Infeasible::faces_by_curvature() const { return all_by_curvature(faces.faults); }

bool Infeasible::sliding_may_help() const {
    const auto may_help = [](const InfeasibleElement& of) { return of.sliding_may_help; };
    return !none() && faces_by_curvature() && std::all_of(elements.begin(), elements.end(), may_help);
}

bool Infeasible::division_helps() const {
    return std::all_of(elements.begin(), elements.end(), [](const auto& of) { return of.division_helps; });
}

Infeasible find_infeasible(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                           double bound) {
    constexpr double surely = -0.01;  // of boundaries that end only as near to their targets as elements resolve them
    const std::vector<double> placed = at_target(mesh, target, ideal);
    const std::vector<char> prescribed = prescribed_nodes(mesh, target);
    std::vector<char> open(mesh.face_count());
    for (int f = 0; f < mesh.face_count(); ++f) open[f] = !target.prescribes(mesh, f);
    const bool bends_as_ideal = ideal == mesh.x;  // the faces of a mesh that is its own ideal, if they are curved
    Infeasible found = {check_target(mesh, placed, open, bends_as_ideal ? FaceBend::any : FaceBend::usual), {}};
    if (mesh.degree > 1 && !target.in_trace_space) bound = std::min(bound, surely);
    found.elements = infeasible_elements(mesh, placed, prescribed, bound);
    if (!mesh.is_simplicial()) {
        std::vector<double> before(mesh.element_count(), bound);  // where a corner is nearly flat
        for (const InfeasibleElement& of : infeasible_elements(mesh, ideal, prescribed, bound))
            before[of.element] = of.scaled_determinant;
        std::erase_if(found.elements, [&](const InfeasibleElement& of) {
            const double value = of.scaled_determinant, of_ideal = before[of.element];
            return value > 0 && of_ideal < bound && value >= 0.5 * of_ideal;
        });
    }
    find_help(mesh, target, found.elements);
    return found;
}

std::vector<std::string> why_infeasible(const Mesh& mesh, const std::vector<double>& x, Constraint& constraint,
                                        const BoundaryTarget& target, const SlidingSurfaces* sliding) {
    std::vector<std::string> why(mesh.element_count());
    const auto add = [&](const std::vector<double>& at, const std::vector<char>& held, const std::string& reason) {
        for (const InfeasibleElement& of : infeasible_elements(mesh, at, held, flat_jacobian))
            if (why[of.element].empty()) why[of.element] = reason;
    };
    const std::vector<int> directions = held_directions(constraint, x, mesh.dim);
    if (directions.empty()) {
        add(x, held_nodes(mesh, target), "flat or inverted by the boundary of the file");
        add(at_target(mesh, target, x), prescribed_nodes(mesh, target), "flat or inverted by the boundary's target");
        return why;
    }
    std::vector<char> stays;
    for (const int held : directions) stays.push_back(held == mesh.dim);
    add(x, stays, "flat or inverted by boundary nodes that stay");
    if (sliding)
        for (const auto& [part, nodes] : flat_parts(mesh, target, *sliding))
            add(x, nodes, concat("flat by edges that stay in one ", mesh.dim == 2 ? "line" : "plane", " of boundary ",
                                 mesh.boundaries[sliding->boundary(part)]));
    return why;
}

std::string describe(const Mesh& mesh, const Infeasible& infeasible) {
    std::string text;
    std::size_t lines = 0;
    const auto add = [&](const std::string& line) {
        if (++lines <= shown) text += "\n  " + line;
    };
    for (const TargetReport::Fault& fault : infeasible.faces.faults) add(fault.why);
    for (const InfeasibleElement& of : infeasible.elements) {
        const Vec<3> c = element_centre(mesh, mesh.x, of.element);
        add(concat(mesh.cell(of.element).name, " ", mesh.file.element_id[of.element], " at ",
                   position_text(c.data(), mesh.dim), ": its boundary nodes make its scaled determinant ",
                   to_text(of.scaled_determinant, 4), ", wherever the nodes inside are"));
    }
    return lines > shown ? text + "\n  ..." : text;
}

std::vector<int> elements_of(const Mesh& mesh, const Infeasible& infeasible) {
    std::vector<int> elements;
    for (const TargetReport::Fault& fault : infeasible.faces.faults)
        elements.push_back(mesh.face_element[fault.face]);
    for (const auto& pair : infeasible.faces.crossing)
        for (const int f : pair) elements.push_back(mesh.face_element[f]);
    for (const InfeasibleElement& of : infeasible.elements) elements.push_back(of.element);
    return elements;
}

std::vector<char> nodes_to_free(const Mesh& mesh, const BoundaryTarget& target, const Infeasible& infeasible) {
    std::vector<char> vertex(mesh.nodes(), 0), chosen(mesh.face_count(), 0), freed(mesh.nodes(), 0);
    for (const TargetReport::Fault& fault : infeasible.faces.faults)
        for (const int i : mesh.face_vertices(fault.face)) vertex[i] = 1;
    for (const InfeasibleElement& of : infeasible.elements)
        for (int i = 0; i < mesh.cell(of.element).vertices; ++i) vertex[mesh.element(of.element)[i]] = 1;
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::span<const int> vertices = mesh.face_vertices(f);
        chosen[f] = std::any_of(vertices.begin(), vertices.end(), [&](int i) { return vertex[i]; });
    }
    if (all_by_curvature(infeasible.elements)) add_coplanar(mesh, at_target(mesh, target, mesh.x), chosen);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int i = mesh.faces[k];
        if (chosen[f]) freed[i] = is_prescribed(target.kind[k]) && (mesh.degree > 1 || vertex[i]);
    });
    return freed;
}

ElementList list_elements(const Mesh& mesh, const std::vector<int>& elements, const std::vector<double>& x,
                          const std::vector<double>& value, const std::vector<std::string>& more, std::string name) {
    ElementList list{static_cast<int>(elements.size()), "", concat(" (id, centre, ", name, "):")};
    std::replace(name.begin(), name.end(), ' ', '_');
    list.csv = concat("element,x,y,z,", name, ",reason\n");
    for (std::size_t k = 0; k < elements.size(); ++k) {
        const int e = elements[k];
        const Vec<3> at = element_centre(mesh, x, e);
        const std::string reason = more.empty() ? "" : more[e];
        list.csv += csv_row({mesh.file.element_id[e], at[0], at[1], at[2], value[e], sentence(reason)});
        if (k < shown)
            list.first += concat("\n  ", mesh.file.element_id[e], "  ", position_text(at.data(), mesh.dim), "  ",
                                 rounded_down(value[e], 4), reason.empty() ? "" : "  ", reason);
    }
    return list;
}

}  // namespace almesh
