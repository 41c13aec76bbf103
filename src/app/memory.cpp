// Two nodes are coupled where they share an element. Of the pairs of nodes, those whose smallest common entity is a
// vertex, an edge, a face or a cell: P_0 = 1, and with N nodes on an entity N^2 less those of the entities of its
// boundary, on a triangle N^2 - 3 P_1 - 3 P_0;
// blocks of the Hessian = sum over the types of entities of P times their number. Pairs of a node and a vertex: with
// N times the number of vertices in place of N^2.
#include "app/memory.hpp"

#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "base/error.hpp"
#include "base/text.hpp"
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

// Of a node of the entity with one that it would have with the other degree, and no part of its boundary has both.
double pairs_inside(const CellType& cell, int degree, int other) {
    double pairs = static_cast<double>(cell.node_count(degree)) * cell.node_count(other);
    if (cell.dim > 0) pairs -= cell.vertices;
    if (cell.dim > 1) pairs -= static_cast<double>(cell.edges.size()) * pairs_inside(simplex(1), degree, other);
    for (int k = 0; k < static_cast<int>(cell.faces.size()) && cell.dim == 3; ++k)
        pairs -= pairs_inside(cell.face_type(k), degree, other);
    return pairs;
}

// Numbers of edges and faces by Euler's formula, for a domain without holes.
double coupled_pairs(const Mesh& mesh, int degree) {
    const double vertices = vertex_count(mesh);
    std::map<const CellType*, double> sides;  // of elements or, once more, of the boundary: two for each one
    double sum = vertices, cells = 0, all_sides = 0;
    for (const ElementGroup& group : mesh.element_groups()) {
        cells += group.count;
        sum += group.count * pairs_inside(*group.cell, mesh.degree, degree);
        for (int k = 0; k < static_cast<int>(group.cell->faces.size()); ++k)
            sides[&group.cell->face_type(k)] += group.count;
    }
    for (int f = 0; f < mesh.face_count(); ++f) sides[&mesh.face_cell(f)] += mesh.is_inner(f) ? 0 : 1;
    for (const auto& [type, count] : sides) {
        sum += count / 2 * pairs_inside(*type, mesh.degree, degree);
        all_sides += count;
    }
    const double edges = vertices + all_sides / 2 - cells - 1;
    return mesh.dim == 2 ? sum : sum + edges * pairs_inside(simplex(1), mesh.degree, degree);
}

std::string rounded(double bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", bytes / 1e9);
    return text;
}

}  // namespace

double hessian_blocks(const Mesh& mesh) { return coupled_pairs(mesh, mesh.degree); }

double predicted_bytes(const Mesh& mesh, const LinearSolverParams& linear) {
    constexpr double number = sizeof(double), single = sizeof(float), index = sizeof(int), program = 8e6;
    const double d = mesh.dim, elements = mesh.element_count(), nodes = mesh.nodes(), blocks = hessian_blocks(mesh),
                 unknowns = d * nodes;
    double places = 0, entries = 0;  // nodes and blocks of elements
    for (const ElementGroup& group : mesh.element_groups()) {
        const double m = group.cell->node_count(mesh.degree);
        places += group.count * m;
        entries += group.count * m * m;
    }
    const double of_mesh = places * index + nodes * (d * number + 16), vectors = 14 * unknowns * number;
    const double of_energy = (places + entries + blocks) * index + elements * (d * d + 3) * number;
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

double check_memory(const Mesh& mesh, const LinearSolverParams& linear, double available) {
    const double bytes = predicted_bytes(mesh, linear);
    if (bytes <= available) return bytes;
    std::string fits = "a coarser mesh takes less";
    for (int degree = mesh.degree - 1; degree > 0; --degree) {
        const double lower = predicted_bytes(interpolated(mesh, degree), linear);
        if (lower > available) continue;
        fits = concat("degree = ", degree, " takes about ", rounded(lower), " GB");
        break;
    }
    throw InputError("the run needs about ", rounded(bytes), " GB of memory, and ", rounded(available),
                     " GB are free here: ", fits);
}

}  // namespace almesh
