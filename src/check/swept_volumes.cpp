#include "check/swept_volumes.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {
namespace {

constexpr double sweep_work = 500;  // simple operations of a face

// A type of face: the basis and its derivatives at the points of a rule that is exact.
struct SweepRule : ReferenceElement {
    std::vector<double> values;  // points x nodes

    SweepRule(const CellType& type, int p) : SweepRule(LagrangeBasis(type, p), cell_quadrature(type, 3 * p)) {}
    SweepRule(const LagrangeBasis& basis, const Quadrature& rule)
        : ReferenceElement(reference_element(basis.cell, basis.degree, rule)), values(offset(points, nodes)) {
        for (int q = 0; q < points; ++q) basis.values(&rule.xi[q * rule.dim], &values[offset(q, nodes)]);
    }
};

// w . n dA at point q, s of the way. Tangents are relative to the first node: their derivatives' sum is zero.
double flux(const SweepRule& rule, int q, double s, const std::vector<int>& node, int dim,
            const std::vector<double>& before, const std::vector<double>& now) {
    Vec<3> w{}, first{}, tangent[2] = {};
    for (int i = 0; i < rule.nodes; ++i)
        for (int a = 0; a < dim; ++a) {
            const std::size_t at = offset(node[i], dim, a);
            const double way = now[at] - before[at], x = before[at] + s * way;
            if (i == 0) first[a] = x;
            w[a] += rule.values[offset(q, rule.nodes, i)] * way;
            for (int k = 0; k + 1 < dim; ++k)
                tangent[k][a] += rule.gradients[offset(q, rule.nodes * (dim - 1), i * (dim - 1) + k)] * (x - first[a]);
        }
    return dim == 2 ? w[0] * tangent[0][1] - w[1] * tangent[0][0] : dot(w, cross(tangent[0], tangent[1]));
}

}  // namespace

std::vector<MeshFace> mesh_faces(const Mesh& mesh) {
    const int most = mesh.most_sides();
    std::vector<Side> sides;
    for_sides(mesh, [&](int e, int k, int number) { sides.push_back(side_of_element(mesh, e, k, number)); });
    std::vector<MeshFace> faces;
    for_equal_sides(sides, [&](std::span<const Side> same) {
        for (std::size_t i = 0; i < same.size(); i += 2)
            faces.push_back({same[i].number / most, same[i].number % most,
                             i + 1 < same.size() ? same[i + 1].number / most : -1});
    });
    std::sort(faces.begin(), faces.end(), [](const MeshFace& a, const MeshFace& b) {
        return a.element != b.element ? a.element < b.element : a.side < b.side;
    });
    return faces;
}

std::vector<int> nodes_of(const Mesh& mesh, const SideNodes& local, const MeshFace& face) {
    std::vector<int> nodes;
    for (const int i : local.of(mesh.cell(face.element), face.side)) nodes.push_back(mesh.element(face.element)[i]);
    return nodes;
}

std::vector<double> swept_volumes(const Mesh& mesh, const std::vector<MeshFace>& faces,
                                  const std::vector<double>& before, const std::vector<double>& now) {
    const SideNodes local(mesh.dim, mesh.degree);
    const SweepRule flat(simplex(mesh.dim - 1), mesh.degree), quad(quadrilateral(), mesh.degree);
    const Quadrature steps = simplex_quadrature(1, 2);  // the integrand is of degree dim - 1 in s
    std::vector<double> volume(faces.size(), 0.0);
    parallel_for(static_cast<int>(faces.size()), [&](int f) {
        const std::vector<int> node = nodes_of(mesh, local, faces[f]);
        const bool is_flat = mesh.cell(faces[f].element).face_type(faces[f].side).is_simplex();
        const SweepRule& rule = is_flat ? flat : quad;
        for (int j = 0; j < steps.count; ++j)
            for (int q = 0; q < rule.points; ++q)
                volume[f] += steps.weight[j] * rule.weight[q] *
                             flux(rule, q, steps.xi[j], node, mesh.dim, before, now);
    }, sweep_work);
    return volume;
}

}  // namespace almesh
