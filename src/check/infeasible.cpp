#include "check/infeasible.hpp"

#include <algorithm>

#include "base/table.hpp"
#include "check/determined_elements.hpp"

namespace almesh {
namespace {

constexpr double rounding = 1e-12;  // a scaled Jacobian that may be zero

// Per node: whether the constraint leaves it no direction in which to go.
std::vector<char> nodes_that_stay(const Mesh& mesh, const std::vector<double>& x, const Constraint& constraint,
                                  const BoundaryTarget& target) {
    std::vector<char> stays = held_nodes(mesh, target);
    const std::vector<int>& nodes = constraint.nodes();
    for (std::size_t t = 0; t < nodes.size(); ++t) {
        Vec<3> at{};
        std::copy_n(point(x, nodes[t], mesh.dim), mesh.dim, at.begin());
        const Mat<3> D = constraint.distance(static_cast<int>(t), at).slope;
        stays[nodes[t]] = stays[nodes[t]] && D[0][0] + D[1][1] + D[2][2] > mesh.dim - 0.5;
    }
    return stays;
}

// The flat surfaces along which faces slide, and their nodes.
std::vector<std::pair<int, std::vector<char>>> flat_parts(const Mesh& mesh, const BoundaryTarget& target,
                                                          const SlidingSurfaces& sliding) {
    const std::string flat = mesh.dim == 2 ? "straight line" : "plane";
    std::vector<std::pair<int, std::vector<char>>> parts;
    std::vector<int> place(sliding.parts(), -1);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (!target.slides(mesh, f)) return;
        const int part = sliding.part(mesh, f);
        if (sliding.surface(part).name() != flat) return;
        if (place[part] < 0) {
            place[part] = static_cast<int>(parts.size());
            parts.emplace_back(part, std::vector<char>(mesh.nodes(), 0));
        }
        parts[place[part]].second[mesh.faces[k]] = 1;
    });
    return parts;
}

}  // namespace

std::vector<std::string> find_infeasible(const Mesh& mesh, const std::vector<double>& x, Constraint& constraint,
                                         const BoundaryTarget& target, const SlidingSurfaces* sliding) {
    constexpr double off_surface = 1e-10;
    std::vector<std::string> why(mesh.element_count());
    const auto add = [&](const std::vector<double>& at, const std::vector<char>& nodes, const std::string& reason) {
        for (const DeterminedElement& of : determined_elements(mesh, at, nodes, rounding))
            if (why[of.element].empty()) why[of.element] = reason;
    };
    const bool holds = constraint.max_error(x) <= off_surface;
    if (holds) add(x, nodes_that_stay(mesh, x, constraint, target), "flat or inverted by boundary nodes that stay");
    else add(x, held_nodes(mesh, target), "flat or inverted by the boundary of the file");
    if (!holds)
        add(at_target(mesh, target, x), prescribed_nodes(mesh, target), "flat or inverted by the boundary's target");
    else if (sliding)
        for (const auto& [part, nodes] : flat_parts(mesh, target, *sliding))
            add(x, nodes, concat("flat by edges that stay in one ", mesh.dim == 2 ? "line" : "plane", " of boundary ",
                                 mesh.boundaries[sliding->boundary(part)]));
    return why;
}

std::vector<int> invalid_by_boundary(const Mesh& mesh, const std::vector<double>& x, const BoundaryTarget& target) {
    std::vector<int> elements;
    for (const DeterminedElement& of : determined_elements(mesh, x, held_nodes(mesh, target), rounding))
        elements.push_back(of.element);
    return elements;
}

std::vector<char> held_nodes(const Mesh& mesh, const BoundaryTarget& target) {
    std::vector<char> held(mesh.nodes(), 0);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (target.hold_of_node(mesh, f, k) != BoundaryHold::free) held[mesh.faces[k]] = 1;
    });
    return held;
}

InvalidElements list_invalid(const Mesh& mesh, const std::vector<int>& elements, const std::vector<double>& x,
                             const std::vector<double>& scaled_jacobian, const std::vector<std::string>& why) {
    constexpr int shown = 10;
    InvalidElements list{static_cast<int>(elements.size()), "element,x,y,z,scaled_jacobian,reason\n", ""};
    for (std::size_t k = 0; k < elements.size(); ++k) {
        const int e = elements[k];
        const Vec<3> at = element_centre(mesh, x, e);
        const std::string reason = why.empty() ? "" : why[e];
        list.csv += csv_row({mesh.file.element_id[e], at[0], at[1], at[2], scaled_jacobian[e], sentence(reason)});
        if (k < shown)
            list.first += concat("\n  ", mesh.file.element_id[e], "  ", position_text(at.data(), mesh.dim), "  ",
                                 rounded_down(scaled_jacobian[e], 4), reason.empty() ? "" : "  ", reason);
    }
    return list;
}

}  // namespace almesh
