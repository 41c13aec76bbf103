#include "check/never_valid.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "check/determined_elements.hpp"
#include "check/target_check.hpp"

namespace almesh {
namespace {

constexpr double rounding = 1e-12;  // a scaled Jacobian that may be zero

// Per node: whether the constraint leaves it no direction in which to go.
std::vector<char> fixed_nodes(const Mesh& mesh, const std::vector<double>& x, const Constraint& constraint) {
    std::vector<char> fixed(mesh.nodes(), 0);
    const std::vector<int>& nodes = constraint.nodes();
    for (std::size_t t = 0; t < nodes.size(); ++t) {
        Vec<3> at{};
        std::copy_n(point(x, nodes[t], mesh.dim), mesh.dim, at.begin());
        const Mat<3> D = constraint.distance(static_cast<int>(t), at).slope;
        fixed[nodes[t]] = D[0][0] + D[1][1] + D[2][2] > mesh.dim - 0.5;
    }
    return fixed;
}

std::optional<NeverValid> first_of(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& nodes,
                                   const std::string& why) {
    if (std::count(nodes.begin(), nodes.end(), 1) == 0) return std::nullopt;
    const std::vector<DeterminedElement> found = determined_elements(mesh, x, nodes, rounding);
    if (found.empty()) return std::nullopt;
    const int e = found[0].element;
    return NeverValid{concat("element ", mesh.file.element_id[e]), why, element_centre(mesh, x, e)};
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

std::optional<NeverValid> find_never_valid(const Mesh& mesh, const std::vector<double>& x, Constraint& constraint,
                                           const BoundaryTarget& target, const SlidingSurfaces* sliding) {
    constexpr double off_surface = 1e-10;
    if (!(constraint.max_error(x) <= off_surface)) return std::nullopt;
    const std::vector<char> fixed = fixed_nodes(mesh, x, constraint);
    if (const auto found = first_of(mesh, x, fixed,
                                    "is inverted or flat where it lies between nodes that are fixed: let them slide, "
                                    "or take it out of the mesh"))
        return found;
    if (sliding)
        for (const auto& [part, nodes] : flat_parts(mesh, target, *sliding))
            if (const auto found = first_of(
                    mesh, x, nodes,
                    concat("has edges that meet in one ", mesh.dim == 2 ? "line" : "plane", " of the boundary ",
                           mesh.boundaries[sliding->boundary(part)],
                           ", where it is flat wherever its nodes slide: take it out of the mesh, or divide it")))
                return found;
    if (!target.prescribes_all()) return std::nullopt;
    const int f = check_target(mesh, x).crossed_before[0];
    if (f < 0) return std::nullopt;
    return NeverValid{concat("face ", mesh.file.face_id[f], " of boundary ", mesh.boundaries[mesh.face_boundary[f]]),
                      "crosses another one, and all of the boundary is fixed: let it slide, or mend the surface first",
                      centroid(mesh, x, mesh.face(f), mesh.face_cell(f).vertices)};
}

}  // namespace almesh
