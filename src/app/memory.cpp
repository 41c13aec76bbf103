// Two nodes are coupled where they share an element. Of the pairs of nodes, those whose smallest common entity, a vertex,
// an edge, a face or a cell, is a given one: with N nodes on it N^2 less those of the entities on its boundary,
//     P_vertex = 1,  P_edge = N^2 - 2,  P_triangle = N^2 - 3 P_edge - 3,  P_tetrahedron = N^2 - 4 P_triangle - ..., ...;
// blocks of the Hessian = sum of these over all entities. Edges in 3D are counted by Euler's formula for a domain
// without holes. Pairs of a node and one of another degree: with N N' in place of N^2.
#include "app/memory.hpp"

#include <cmath>

#include "mesh/cells.hpp"

namespace almesh {
namespace {

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

// Of a node of degree p and one of degree q.
double pairs_inside(const CellType& cell, int p, int q) {
    double pairs = 1.0 * cell.node_count(p) * cell.node_count(q) - cell.vertices;
    if (cell.dim >= 2) pairs -= static_cast<double>(cell.edges.size()) * pairs_inside(simplex(1), p, q);
    for (int k = 0; k < static_cast<int>(cell.faces.size()) && cell.dim == 3; ++k)
        pairs -= pairs_inside(cell.face_type(k), p, q);
    return pairs;
}

// Of a node of the mesh with one that it would have with this degree.
double coupled_pairs(const Mesh& mesh, int degree) {
    const double vertices = vertex_count(mesh);
    double pairs = vertices, sides = 0;
    const auto add_sides = [&](const CellType& side, double count) {  // each of which is seen from both of its sides
        sides += 0.5 * count;
        pairs += 0.5 * count * pairs_inside(side, mesh.degree, degree);
    };
    for (const ElementGroup& group : mesh.face_groups()) add_sides(*group.cell, group.count);
    for (const ElementGroup& group : mesh.element_groups()) {
        pairs += group.count * pairs_inside(*group.cell, mesh.degree, degree);
        for (int k = 0; k < static_cast<int>(group.cell->faces.size()); ++k)
            add_sides(group.cell->face_type(k), group.count);
    }
    const double edges = vertices + sides - mesh.element_count() - 1;
    return mesh.dim == 2 ? pairs : pairs + edges * pairs_inside(simplex(1), mesh.degree, degree);
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
