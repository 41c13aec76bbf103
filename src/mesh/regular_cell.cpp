#include "mesh/regular_cell.hpp"

#include <numeric>

#include "mesh/mesh.hpp"

namespace almesh {

std::vector<double> regular_cell(const CellType& cell) {
    if (cell.is_collapsed) return {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, std::sqrt(0.5)};
    std::vector<double> x;
    for (const MultiIndex& corner : cell.corners)
        for (int a = 0; a < cell.dim; ++a) {
            const auto [factor, from, to] = cell.coordinate(a);
            x.push_back(0);
            for (int k = 0; k < cell.factors[factor]; ++k)
                x.back() += regular_edges[to - from - 1][k] * corner[from + 1 + k];
        }
    return x;
}

std::vector<double> regular_nodes(const CellType& cell, int degree) {
    Mesh mesh;
    mesh.dim = cell.dim;
    mesh.degree = degree;
    mesh.groups = groups_of({&cell}, degree);
    mesh.elements.resize(cell.node_count(degree));
    std::iota(mesh.elements.begin(), mesh.elements.end(), 0);
    mesh.x = regular_cell(cell);
    mesh.x.resize(offset(cell.node_count(degree), cell.dim));
    std::vector<double> x = straight_sided(mesh);
    const double scale = std::pow(cell.volume() / volume(mesh, x, 0), 1.0 / cell.dim);
    for (double& v : x) v *= scale;
    return x;
}

}  // namespace almesh
