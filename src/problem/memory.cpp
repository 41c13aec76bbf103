// Two nodes are coupled where they share an element. Of the pairs of nodes, those whose smallest common entity is a
// vertex, an edge, a face or a cell: P_0 = 1, and with N nodes on an entity N^2 less those of the entities of its
// boundary, on a triangle N^2 - 3 P_1 - 3 P_0;
// blocks of the Hessian = sum over the types of entities of P times their number. Pairs of a node and a vertex: with
// N times the number of vertices in place of N^2. Refinement multiplies all numbers by 2^dim, or nearly so.
#include "problem/memory.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/error.hpp"
#include "base/lanes.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"
#include "mesh/cells.hpp"
#include "mesh/node_key.hpp"

namespace almesh {
namespace {

double vertex_count(const Mesh& mesh) {
    std::vector<char> is_vertex(mesh.nodes(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int i = 0; i < mesh.cell(e).vertices; ++i) is_vertex[mesh.element(e)[i]] = 1;
    return static_cast<double>(std::count(is_vertex.begin(), is_vertex.end(), 1));
}

// Of a node of the entity with one that it would have with the other degree, and no part of its boundary has both. With
// degree 0, one node for each entity: the nodes of the entity that are on no part of its boundary.
double pairs_inside(const CellType& cell, int degree, int other) {
    double pairs = static_cast<double>(cell.node_count(degree)) * cell.node_count(other);
    if (cell.dim > 0) pairs -= cell.vertices;
    if (cell.dim > 1) pairs -= static_cast<double>(cell.edges.size()) * pairs_inside(simplex(1), degree, other);
    for (int k = 0; k < static_cast<int>(cell.faces.size()) && cell.dim == 3; ++k)
        pairs -= pairs_inside(cell.face_type(k), degree, other);
    return pairs;
}

// How many there are of each type, by Euler's formula for a domain without holes: edges in 3D.
std::map<const CellType*, double> entities_of(const Mesh& mesh) {
    std::map<const CellType*, double> count;
    for (const ElementGroup& group : mesh.element_groups()) {
        count[group.cell] += group.count;
        for (int k = 0; k < static_cast<int>(group.cell->faces.size()); ++k)
            count[&group.cell->face_type(k)] += 0.5 * group.count;
    }
    for (int f = 0; f < mesh.face_count(); ++f) count[&mesh.face_cell(f)] += mesh.is_inner(f) ? 0 : 0.5;
    count[&simplex(0)] = vertex_count(mesh);
    double alternating = 0;
    for (const auto& [cell, of_cell] : count) alternating += (cell->dim % 2 == 0 ? 1 : -1) * of_cell;
    if (mesh.dim == 3) count[&simplex(1)] = alternating - 1;
    return count;
}

// What a run's arrays are made of.
struct Counts {
    int dim, degree;
    double elements = 0, nodes = 0, places = 0, entries = 0;  // places and entries: nodes and blocks of elements
    // Pairs of nodes that share an element, of a node and a vertex, of two vertices; most pairs of an element.
    double blocks = 0, blocks_with_vertices = 0, blocks_of_vertices = 0, vertices = 0, batch = 0;
    double samples;  // points at which the target is known

    Counts(const Mesh& mesh, int of_degree, double growth) : dim(mesh.dim), degree(of_degree) {
        samples = std::pow(growth, (dim - 1.0) / dim) * mesh.face_count() * std::pow(degree + 3, dim - 1);
        for (const auto& [cell, number] : entities_of(mesh)) {
            const double count = growth * number, m = cell->node_count(degree);
            nodes += count * pairs_inside(*cell, degree, 0);
            blocks += count * pairs_inside(*cell, degree, degree);
            blocks_with_vertices += count * pairs_inside(*cell, degree, 1);
            blocks_of_vertices += count * pairs_inside(*cell, 1, 1);
            vertices += count * pairs_inside(*cell, 1, 0);
            if (cell->dim < dim) continue;
            elements += count;
            places += count * m;
            entries += count * m * m;
            batch = std::max(batch, m * m);
        }
    }
};

constexpr double number = sizeof(double), single = sizeof(float), index = sizeof(int);

// What SSOR or ILU(0) takes on the blocks of these rows.
double bytes_of_sweeps(double d, double rows, double blocks, bool is_linear) {
    const double products = takes_ilu0(rows, blocks, is_linear) ? 12 * blocks : 0;
    return (blocks - rows) / 2 * (d * d * single + index) + rows * (d * d + d + 8) * number + products;
}

// And deflation: the places of the blocks in A Z, which has in each row those of some three groups.
double bytes_of_deflation(double d, double rows, double blocks, bool is_linear) {
    const double value = takes_ilu0(rows, blocks, is_linear) ? number : single;
    return blocks * index + 3 * rows * (3 * index + d * d * value);
}

double bytes_of(const Counts& of, const LinearSolverParams& linear) {
    constexpr double program = 1.5e7;
    const double d = of.dim, unknowns = d * of.nodes, block = d * d * number;
    const double of_mesh = 2 * of.places * index + of.nodes * (3 * d * number + 24) + 40 * of.elements +
                           3 * of.samples * d * number;
    const bool half = stores_half(of.nodes, of.blocks, of.dim, linear);
    const double below = (of.blocks - of.nodes) / 2, stored = half ? below : of.blocks;
    const double of_energy = (of.places + (half ? 0.5 : 1) * of.entries + stored) * index +
                             of.elements * (block + 4 * number) + max_threads() * most_lanes * of.batch * block;
    const double hessian = stored * (half ? d * d * single + index : block + index) + (half ? of.nodes * block : 0);
    const double vectors = 18 * unknowns * number;
    const double factor = of.dim == 2 ? 80 * unknowns * std::log2(unknowns + 2) : 450 * std::pow(unknowns, 4.0 / 3);
    const bool is_linear = of.degree == 1;
    double solver = bytes_of_sweeps(d, of.nodes, of.blocks, is_linear) - (half ? below * (d * d * single + index) : 0);
    if (!iterates(unknowns, of.dim, linear)) solver = factor;
    else if (is_linear) solver += bytes_of_deflation(d, of.nodes, of.blocks, true);
    else  // V, E and its parts, which overlap, and what E is preconditioned by
        solver += of.blocks_with_vertices * (d * d * single + index) + 60 * of.nodes + 100 * of.vertices +
                  of.blocks_of_vertices * (2 + 28 * std::pow(of.vertices, -1 / d)) * block +
                  bytes_of_sweeps(d, of.vertices, of.blocks_of_vertices, false) +
                  bytes_of_deflation(d, of.vertices, of.blocks_of_vertices, false);
    constexpr double besides = 1.08;  // what was not counted, and what is freed and stays with the program
    return program + besides * (of_mesh + of_energy + hessian + vectors + solver);
}

std::string rounded(double bytes) { return to_text(bytes / 1e9, 2); }

}  // namespace

double hessian_blocks(const Mesh& mesh) { return Counts(mesh, mesh.degree, 1).blocks; }

double predicted_bytes(const Mesh& mesh, const LinearSolverParams& linear) {
    return bytes_of(Counts(mesh, mesh.degree, 1), linear);
}

void check_memory(const Mesh& base, int degree, int refinements, const LinearSolverParams& linear, double available) {
    check_size(base, degree, std::pow(1 << base.dim, refinements), refinements > 0 ? "refine" : "degree");
    const auto bytes = [&](int of_degree, int times) {
        return bytes_of(Counts(base, of_degree, std::pow(1 << base.dim, times)), linear);
    };
    const double needed = bytes(degree, refinements);
    if (needed <= available) return;
    std::string fits = "a coarser mesh takes less";
    const auto take_less = [&](const char* key, int most, int least, const auto& bytes_with) {
        while (most >= least && bytes_with(most) > available) --most;
        if (most >= least) fits = concat(key, " = ", most, " takes about ", rounded(bytes_with(most)), " GB");
    };
    take_less("refine", refinements - 1, 0, [&](int times) { return bytes(degree, times); });
    take_less("degree", degree - 1, 1, [&](int lower) { return bytes(lower, refinements); });
    throw InputError("the run needs about ", rounded(needed), " GB of memory, and ", rounded(available),
                     " GB are free here: ", fits);
}

}  // namespace almesh
