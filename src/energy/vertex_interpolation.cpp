// Node a of a simplex has the barycentric coordinates a / p, in a quadrilateral a / p are those of both directions:
// N_v of degree 1 is the product of the ones that are 1 at vertex v.
#include "energy/vertex_interpolation.hpp"

#include <vector>

namespace almesh {
namespace {

// Per node of the cell and vertex: N_v at the node.
std::vector<double> vertex_weights(const CellType& cell, int degree) {
    const std::vector<MultiIndex> vertices = gmsh_node_order(cell, 1);
    std::vector<double> weights;
    for (const MultiIndex& a : gmsh_node_order(cell, degree))
        for (const MultiIndex& vertex : vertices) {
            double weight = 1;
            for (int k = 0; k < 4; ++k)
                if (vertex[k] == 1) weight *= static_cast<double>(a[k]) / degree;
            weights.push_back(weight);
        }
    return weights;
}

}  // namespace

Interpolation vertex_interpolation(const Mesh& mesh) {
    Interpolation P;
    if (mesh.degree == 1) return P;
    struct Row {
        const int* vertex;
        const double* weight;
        int count;
    };
    const std::vector<ElementGroup> groups = mesh.element_groups();
    std::vector<std::vector<double>> weights;
    std::vector<Row> rows(mesh.nodes());
    std::vector<int> column(mesh.nodes(), -1);
    for (const ElementGroup& group : groups) {
        weights.push_back(vertex_weights(*group.cell, mesh.degree));
        const int vertices = group.cell->vertices, m = group.cell->node_count(mesh.degree);
        for (int e = group.first; e < group.first + group.count; ++e) {
            const int* const node = mesh.element(e);
            for (int a = 0; a < m; ++a) rows[node[a]] = {node, &weights.back()[offset(a, vertices)], vertices};
            for (int v = 0; v < vertices; ++v) column[node[v]] = 0;
        }
    }
    for (int& c : column)
        if (c == 0) c = P.columns++;
    for (const Row& row : rows) {
        for (int v = 0; v < row.count; ++v) {
            if (row.weight[v] == 0) continue;
            P.col.push_back(column[row.vertex[v]]);
            P.weight.push_back(row.weight[v]);
        }
        P.row.push_back(static_cast<int>(P.col.size()));
    }
    return P;
}

}  // namespace almesh
