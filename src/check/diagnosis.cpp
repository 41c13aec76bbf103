// Every kind is a largest value over nodes or elements, the first one of several.
#include "check/diagnosis.hpp"

#include <algorithm>
#include <cmath>

#include "check/injectivity.hpp"
#include "constraint/sliding_nodes.hpp"
#include "constraint/target.hpp"
#include "geometry/patch.hpp"

namespace almesh {
namespace {

// Of the boundary node that is nearest to the position of the diagnosis.
int nearest_boundary(const LastMesh& last, const std::vector<int>& boundary, const std::array<double, 3>& position) {
    double least = std::numeric_limits<double>::infinity();
    int nearest = -1;
    for (const int i : last.mesh.faces) {
        const double d = length(in_space(point(last.x, i, last.mesh.dim), last.mesh.dim) - position);
        if (nearest >= 0 && d >= least) continue;
        least = d;
        nearest = boundary[i];
    }
    return nearest;
}

Diagnosis at_node(const LastMesh& last, DiagnosisKind kind, int node) {
    const std::vector<int> boundary = boundary_of_nodes(last.mesh, last.target);
    Diagnosis diagnosis;
    diagnosis.kind = kind;
    diagnosis.node = node;
    diagnosis.position = in_space(point(last.x, node, last.mesh.dim), last.mesh.dim);
    diagnosis.on_boundary = boundary[node] >= 0;
    diagnosis.boundary = diagnosis.on_boundary ? boundary[node] : nearest_boundary(last, boundary, diagnosis.position);
    for (int e = 0; e < last.mesh.element_count(); ++e) {
        const int* const of_element = last.mesh.element(e);
        const int m = last.mesh.element_nodes(e);
        if (std::find(of_element, of_element + m, node) == of_element + m) continue;
        if (diagnosis.element < 0 || last.distortion[e] > last.distortion[diagnosis.element]) diagnosis.element = e;
    }
    return diagnosis;
}

Diagnosis at_element(const LastMesh& last, DiagnosisKind kind, int element) {
    const std::vector<int> boundary = boundary_of_nodes(last.mesh, last.target);
    const int* const vertex = last.mesh.element(element);
    const auto on_boundary = [&](int i) { return boundary[i] >= 0; };
    Diagnosis diagnosis;
    diagnosis.kind = kind;
    diagnosis.element = element;
    diagnosis.position = element_centre(last.mesh, last.x, element);
    diagnosis.on_boundary = std::any_of(vertex, vertex + last.mesh.cell(element).vertices, on_boundary);
    diagnosis.boundary = nearest_boundary(last, boundary, diagnosis.position);
    return diagnosis;
}

}  // namespace

std::vector<int> boundary_of_nodes(const Mesh& mesh, const BoundaryTarget& target) {
    std::vector<int> boundary(mesh.nodes(), -1);
    std::vector<char> prescribed(mesh.nodes(), 0);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int i = mesh.faces[k];
        const bool prescribes = is_prescribed(target.written_kind[k]);
        if (boundary[i] >= 0 && (prescribed[i] || !prescribes)) return;
        boundary[i] = mesh.face_boundary[f];
        prescribed[i] = prescribes;
    });
    return boundary;
}

Diagnosis farthest_off_target(const LastMesh& last) {
    constexpr double rounding = 1e-6;
    const int dim = last.mesh.dim;
    const std::vector<double> errors = last.constraint.relative_errors(last.x);
    const auto largest = std::max_element(errors.begin(), errors.end());
    if (largest == errors.end() || !(*largest > 0)) return {};
    const int t = static_cast<int>(largest - errors.begin()), node = last.constraint.nodes()[t];
    Diagnosis diagnosis = at_node(last, DiagnosisKind::off_target, node);
    diagnosis.heights = *largest;
    diagnosis.target = in_space(&last.constraint.targets(last.x)[offset(t, dim)], dim);
    diagnosis.distance = length(diagnosis.position - diagnosis.target);
    const double whole = length(in_space(point(last.ideal, node, dim), dim) - diagnosis.target);
    const bool stays = whole <= rounding * diagnosis.distance;
    if (prescribed_nodes(last.mesh, last.target)[node] && !stays) diagnosis.way = 1 - diagnosis.distance / whole;
    return diagnosis;
}

Diagnosis least_balanced(const LastMesh& last, const std::vector<double>& gradient) {
    const int dim = last.mesh.dim;
    double largest = 0, sum = 0;
    int found = -1;
    for (int i = 0; i < static_cast<int>(gradient.size()) / dim; ++i) {
        double squared = 0;
        for (int a = 0; a < dim; ++a) squared += std::pow(point(gradient, i, dim)[a], 2);
        sum += squared;
        if (!(squared > largest)) continue;
        largest = squared;
        found = i;
    }
    if (found < 0) return {};
    Diagnosis diagnosis = at_node(last, DiagnosisKind::unbalanced, found);
    diagnosis.share = std::sqrt(largest / sum);
    return diagnosis;
}

Diagnosis most_distorted(const LastMesh& last) {
    const auto largest = std::max_element(last.distortion.begin(), last.distortion.end());
    return at_element(last, DiagnosisKind::distorted, static_cast<int>(largest - last.distortion.begin()));
}

Diagnosis least_valid(const LastMesh& last, const std::vector<double>& bound) {
    const auto least = std::min_element(bound.begin(), bound.end());
    return at_element(last, DiagnosisKind::invalid, static_cast<int>(least - bound.begin()));
}

Diagnosis overlapping(const LastMesh& last, const Injectivity& found) {
    if (found.node >= 0) return at_node(last, DiagnosisKind::overlap, found.node);
    if (found.face < 0) return {};
    Diagnosis diagnosis = at_element(last, DiagnosisKind::overlap, last.mesh.face_element[found.face]);
    diagnosis.boundary = last.mesh.face_boundary[found.face];
    return diagnosis;
}

Restriction neighbourhood(const Mesh& mesh, const Diagnosis& diagnosis, int rings, int most) {
    std::vector<char> reached(mesh.nodes(), 0);
    if (diagnosis.node >= 0)
        reached[diagnosis.node] = 1;
    else
        for (int i = 0; i < mesh.element_nodes(diagnosis.element); ++i)
            reached[mesh.element(diagnosis.element)[i]] = 1;
    Restriction found;
    for (int ring = 0; ring < rings; ++ring) {
        Restriction next = restriction_to(reached, mesh);
        if (ring > 0 && static_cast<int>(next.element.size()) > most) break;
        for (const int i : next.node) reached[i] = 1;
        found = std::move(next);
    }
    return found;
}

const char* to_string(DiagnosisKind kind) {
    constexpr const char* names[] = {"none", "off_target", "unbalanced", "distorted", "invalid", "overlap"};
    return names[static_cast<int>(kind)];
}

}  // namespace almesh
