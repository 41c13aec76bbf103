#include "check/freed_nodes.hpp"

#include "base/files.hpp"
#include "base/text.hpp"
#include "geometry/patch.hpp"
#include "mesh/split.hpp"

namespace almesh {
bool TargetFaults::sliding_may_help() const {
    const auto may_help = [](const ElementFault& fault) { return fault.sliding_may_help; };
    return !none() && all_by_curvature(faces.faults) && std::all_of(elements.begin(), elements.end(), may_help);
}

TargetFaults find_faults(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                         double bound) {
    constexpr double surely = -0.01;  // of boundaries that end only as near to their targets as elements resolve them
    const std::vector<double> placed = at_target(mesh, target, ideal);
    TargetFaults faults;
    std::vector<char> open(mesh.face_count());
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (target.hold_of_node(mesh, f, k) != BoundaryHold::prescribed) open[f] = 1;
    });
    const bool bends_as_ideal = ideal == mesh.x;  // the faces of a mesh that is its own ideal, if they are curved
    faults.faces = check_target(mesh, placed, open, bends_as_ideal ? FaceBend::any : FaceBend::usual);
    if (mesh.degree > 1 && !target.in_trace_space) bound = std::min(bound, surely);
    std::vector<int> element;
    const std::vector<char> prescribed = prescribed_nodes(mesh, target);
    std::vector<double> before(mesh.element_count(), bound);  // of other cells than simplices with a nearly flat corner
    if (!mesh.is_simplicial())
        for (const DeterminedElement& of : determined_elements(mesh, ideal, prescribed, bound))
            before[of.element] = of.scaled_jacobian;
    for (const DeterminedElement& fault : determined_elements(mesh, placed, prescribed, bound)) {
        const double value = fault.scaled_jacobian, of_ideal = before[fault.element];
        if (value > 0 && of_ideal < bound && value >= 0.5 * of_ideal) continue;
        faults.elements.push_back({fault});
        if (mesh.is_simplicial()) element.push_back(fault.element);
    }
    std::vector<char> is_prescribed;
    for (const BoundaryHold hold : target.hold) is_prescribed.push_back(hold == BoundaryHold::prescribed);
    const auto inner = inner_simplices(mesh, element), off_prescribed = inner_simplices(mesh, element, is_prescribed);
    for (std::size_t k = 0; k < element.size(); ++k) {
        const bool has_edges = off_prescribed[k].size() > 1 && off_prescribed[k][0].size() == 2;
        faults.elements[k].sliding_may_help = faults.elements[k].by_curvature || has_edges;
        faults.elements[k].can_be_divided = !inner[k].empty();
    }
    return faults;
}

std::string describe(const Mesh& mesh, const TargetFaults& faults) {
    constexpr std::size_t shown = 10;
    std::string text;
    std::size_t lines = 0;
    const auto add = [&](const std::string& line) {
        if (++lines <= shown) text += "\n  " + line;
    };
    for (const TargetReport::Fault& fault : faults.faces.faults) add(fault.why);
    for (const ElementFault& fault : faults.elements) {
        const Vec<3> c = element_centre(mesh, mesh.x, fault.element);
        std::string line = concat(mesh.cell(fault.element).name, " ", mesh.file.element_id[fault.element], " at ",
                                  position_text(c.data(), mesh.dim), ": its boundary nodes make its scaled Jacobian ");
        append(line, fault.scaled_jacobian, 4);
        add(line + ", wherever the nodes inside are");
    }
    if (lines > shown) text += "\n  ...";
    return text;
}

namespace {

// The unit normal of the flat face with the same vertices; 0 where these lie on a line.
Vec<3> flat_unit_normal(const Mesh& mesh, const BoundaryTarget& target, int f) {
    std::array<Vec<3>, 4> corner{};
    const int vertices = mesh.face_cell(f).vertices;
    for (int i = 0; i < vertices; ++i)
        std::copy_n(target.node_of(mesh, f) + i * mesh.dim, mesh.dim, corner[i].begin());
    return unit(flat_normal(corner, mesh.dim - 1, vertices));
}

// Adds to the chosen faces those of the same boundary that lie in one plane with them.
void add_coplanar(const Mesh& mesh, const BoundaryTarget& target, std::vector<char>& chosen) {
    constexpr double same_plane = 1e-7;  // sine of the angle between normals
    std::vector<std::vector<int>> at_node(mesh.nodes());
    for (int f = 0; f < mesh.face_count(); ++f)
        for (const int i : mesh.face_vertices(f)) at_node[i].push_back(f);
    std::vector<int> front;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (chosen[f]) front.push_back(f);
    while (!front.empty()) {
        const int f = front.back();
        front.pop_back();
        const Vec<3> n = flat_unit_normal(mesh, target, f);
        for (const int i : mesh.face_vertices(f))
            for (const int g : at_node[i]) {
                if (chosen[g] || mesh.face_boundary[g] != mesh.face_boundary[f]) continue;
                const Vec<3> other = flat_unit_normal(mesh, target, g);
                if (!(dot(n, other) > 0) || length(cross(n, other)) > same_plane) continue;
                chosen[g] = 1;
                front.push_back(g);
            }
    }
}

}  // namespace

std::vector<char> freed_nodes(const Mesh& mesh, const BoundaryTarget& target, const TargetFaults& faults) {
    std::vector<char> vertex(mesh.nodes(), 0), chosen(mesh.face_count(), 0), freed(mesh.nodes(), 0);
    for (const TargetReport::Fault& fault : faults.faces.faults)
        for (const int i : mesh.face_vertices(fault.face)) vertex[i] = 1;
    for (const ElementFault& fault : faults.elements)
        for (int i = 0; i < mesh.cell(fault.element).vertices; ++i) vertex[mesh.element(fault.element)[i]] = 1;
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::span<const int> vertices = mesh.face_vertices(f);
        chosen[f] = std::any_of(vertices.begin(), vertices.end(), [&](int i) { return vertex[i]; });
    }
    if (all_by_curvature(faults.elements)) add_coplanar(mesh, target, chosen);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int i = mesh.faces[k];
        if (chosen[f])
            freed[i] = target.hold_of_node(mesh, f, k) == BoundaryHold::prescribed && (mesh.degree > 1 || vertex[i]);
    });
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (mesh.face_boundary[f] == mesh.cut) freed[mesh.faces[k]] = 0;
    });
    return freed;
}

}  // namespace almesh
