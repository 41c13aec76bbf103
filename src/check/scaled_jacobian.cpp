#include "check/scaled_jacobian.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "geometry/patch.hpp"
#include "mesh/regular_cell.hpp"

namespace almesh {
namespace {

double scaled_determinant(const std::array<int, 4>& corner, int dim, const std::vector<Vec<3>>& vertex) {
    std::array<Vec<3>, 3> edge{{{}, {}, {0, 0, 1}}};
    double lengths = 1;
    for (int k = 0; k < dim; ++k) {
        edge[k] = vertex[corner[k + 1]] - vertex[corner[0]];
        lengths *= length(edge[k]);
    }
    return lengths > 0 ? dot(edge[0], cross(edge[1], edge[2])) / lengths : 0;
}

}  // namespace

std::vector<Corner> corners_of(const CellType& cell) {
    const std::vector<double> x = regular_cell(cell);
    std::vector<Vec<3>> regular(cell.vertices);
    for (int v = 0; v < cell.vertices; ++v) std::copy_n(&x[offset(v, cell.dim)], cell.dim, regular[v].begin());
    std::vector<Corner> corners;
    for (int v = 0; v < cell.vertices; ++v) {
        std::vector<int> ends;
        for (const auto& [i, j] : cell.edges)
            if (i == v || j == v) ends.push_back(i == v ? j : i);
        const auto count = static_cast<int>(ends.size());
        for (int first = 0; first < (count > cell.dim ? count : 1); ++first) {
            std::array<int, 4> vertex{v, v, v, v};
            for (int k = 0; k < cell.dim; ++k) vertex[k + 1] = ends[(first + k) % count];
            corners.push_back({vertex, scaled_determinant(vertex, cell.dim, regular)});
        }
    }
    return corners;
}

std::vector<double> corner_jacobians(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<double> least(mesh.element_count(), 1);
    for (const ElementGroup& group : mesh.element_groups()) {
        const CellType& cell = *group.cell;
        const std::vector<Corner> corners = corners_of(cell);
        parallel_for(group.count, [&](int k) {
            const int e = group.first + k;
            const std::vector<Vec<3>> vertex = positions(mesh, x, mesh.element(e), cell.vertices);
            for (const Corner& corner : corners)
                least[e] = std::min(least[e], scaled_determinant(corner.vertex, cell.dim, vertex) / corner.regular);
        });
    }
    return least;
}

double least_corner_jacobian(const Mesh& mesh, const std::vector<double>& x) {
    const std::vector<double> of = corner_jacobians(mesh, x);
    return of.empty() ? 1 : *std::min_element(of.begin(), of.end());
}

}  // namespace almesh
