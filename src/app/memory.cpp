// Two nodes are coupled where they share an element. Of the pairs of nodes, those whose smallest common entity is a
// vertex, an edge, a face or a cell: with N_k nodes on a k-dimensional entity
//     P_0 = 1,  P_1 = N_1^2 - 2 P_0,  P_2 = N_2^2 - 3 P_1 - 3 P_0,  P_3 = N_3^2 - 4 P_2 - 6 P_1 - 4 P_0;
// blocks of the Hessian = sum over k of P_k times the number of these entities. Pairs of a node and a vertex: with
// N_k (k + 1) in place of N_k^2.
#include "app/memory.hpp"

#include <cmath>

#include "mesh/cells.hpp"

namespace almesh {
namespace {

// Vertices, edges, triangles, tetrahedra, quadrilaterals, by Euler's formula for a domain without holes.
struct Entities {
    double vertices, edges, triangles, tetrahedra, quadrilaterals = 0;
};

double vertex_count(const Mesh& mesh) {
    std::vector<char> is_vertex(mesh.nodes(), 0);
    double count = 0;
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int i = 0; i < mesh.cell(e).vertices; ++i) {
            char& known = is_vertex[mesh.element(e)[i]];
            count += !known;
            known = 1;
        }
    return count;
}

Entities entities_of(const Mesh& mesh) {
    const double V = vertex_count(mesh), C = mesh.element_count(), boundary = mesh.face_count();
    double quadrilaterals = 0;
    for (const ElementGroup& group : mesh.groups) quadrilaterals += group.cell->is_simplex() ? 0 : group.count;
    if (mesh.dim == 2) return {V, (3 * C + quadrilaterals + boundary) / 2, C - quadrilaterals, 0, quadrilaterals};
    const double F = (4 * C + boundary) / 2;
    return {V, V + F - C - 1, F, C};
}

// Of a node of the mesh with one that it would have with this degree.
double coupled_pairs(const Mesh& mesh, int degree) {
    const auto pairs = [&](int dim) -> double {
        return simplex_node_count(dim, mesh.degree) * simplex_node_count(dim, degree);
    };
    const double P0 = 1, P1 = pairs(1) - 2 * P0, P2 = pairs(2) - 3 * P1 - 3 * P0,
                 P3 = pairs(3) - 4 * P2 - 6 * P1 - 4 * P0;
    const double in_quadrilateral = quadrilateral().node_count(mesh.degree) * quadrilateral().node_count(degree),
                 PQ = in_quadrilateral - 4 * P1 - 4 * P0;
    const Entities of = entities_of(mesh);
    return PQ * of.quadrilaterals + P0 * of.vertices + P1 * of.edges + P2 * of.triangles + P3 * of.tetrahedra;
}

}  // namespace

double hessian_blocks(const Mesh& mesh) { return coupled_pairs(mesh, mesh.degree); }

double predicted_bytes(const Mesh& mesh, const LinearSolverParams& linear) {
    constexpr double number = sizeof(double), single = sizeof(float), index = sizeof(int), program = 8e6;
    const double d = mesh.dim, elements = mesh.element_count(), nodes = mesh.nodes(), blocks = hessian_blocks(mesh),
                 unknowns = d * nodes, m = mesh.element_nodes(mesh.element_count() - 1);  // of the largest type
    const double of_mesh = elements * m * index + nodes * (d * number + 16), vectors = 14 * unknowns * number;
    const double of_energy = elements * (m * index + d * d * number + 3 * number + m * m * index) + blocks * index;
    const double hessian = blocks * (d * d * number + index);
    const bool iterative = iterates(mesh.dim * mesh.nodes(), mesh.dim, linear);
    const double products = blocks < long_rows * nodes ? 12 * blocks : 0;  // of ILU(0)
    const double sweeps = 0.5 * blocks * (d * d * single + 3 * index) + products;
    const double coarse = mesh.degree == 1 ? hessian / 6  // A Z of deflation, or V of the correction of degree 1
                                           : coupled_pairs(mesh, 1) * (d * d * single + index) + 32 * nodes;
    const double factor = mesh.dim == 2 ? 80 * unknowns * std::log2(unknowns + 2) : 80 * std::pow(unknowns, 4.0 / 3);
    constexpr double besides = 1.05;  // what was not counted
    return program + besides * (of_mesh + vectors + of_energy + hessian + (iterative ? sweeps + coarse : factor));
}

}  // namespace almesh
