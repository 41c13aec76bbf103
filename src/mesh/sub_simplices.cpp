// In units of 1 / degree of the cell, node b of a simplex is at the mean of its vertices' multi-indices with weights b.
// Where that is a multi-index it is a node of the cell, and its row a unit vector: vertices are copies to the last bit.
#include "mesh/sub_simplices.hpp"

#include "base/index.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {

SubSimplices::SubSimplices(const CellType& cell, int cell_degree, int degree_, std::vector<CellChild> of)
    : degree(degree_),
      nodes(simplex_node_count(cell.dim, degree)),
      cell_nodes(cell.node_count(cell_degree)),
      corners(cell.dim + 1),
      vertices(std::move(of)) {
    if (vertices.empty() && cell.is_simplex()) vertices = {{0, 1, 2, 3}};
    else if (vertices.empty()) vertices = {{0, 1, 2, -1}, {0, 2, 3, -1}};
    const LagrangeBasis basis(cell, cell_degree);
    for (int v = 0; v < cell.vertices; ++v) corner_.push_back(basis.point(v));
    for (int k = 0; k < count(); ++k) {
        std::vector<double>& S = map.emplace_back(offset(nodes, cell_nodes));
        int row = 0;
        for (const MultiIndex& b : gmsh_node_order(cell.dim, degree)) {
            std::array<double, 4> barycentric{};
            MultiIndex sum{};
            for (int v = 0; v <= cell.dim; ++v) {
                barycentric[v] = static_cast<double>(b[v]) / degree;
                for (int e = 0; e < 4; ++e) sum[e] += b[v] * basis.nodes[vertices[k][v]][e];
            }
            bool is_node = true;
            for (int& entry : sum) {
                is_node = is_node && entry % degree == 0;
                entry /= degree;
            }
            double* const to = &S[offset(row++, cell_nodes)];
            if (is_node) to[basis.find(sum)] = 1;
            else basis.values(point(k, barycentric).data(), to);
        }
    }
}

std::vector<Vec<3>> SubSimplices::nodes_of(int k, const std::vector<Vec<3>>& position) const {
    if (is_cell()) return position;
    std::vector<Vec<3>> x(nodes, position[0]);
    for (int i = 0; i < nodes; ++i) {
        Vec<3> from_first{};
        for (int j = 1; j < cell_nodes; ++j)
            from_first = from_first + map[k][offset(i, cell_nodes, j)] * (position[j] - position[0]);
        x[i] = i < corners ? position[vertices[k][i]] : position[0] + from_first;
    }
    return x;
}

std::array<double, 3> SubSimplices::point(int k, const std::array<double, 4>& barycentric) const {
    std::array<double, 3> xi{};
    for (int v = 0; v < 4 && vertices[k][v] >= 0 && v < static_cast<int>(corner_.size()); ++v)
        for (int a = 0; a < 3; ++a) xi[a] += barycentric[v] * corner_[vertices[k][v]][a];
    return xi;
}

}  // namespace almesh
