// The regular cell of a type: a product of regular simplices, or half an octahedron, all of whose edges have length 1.
#pragma once
#include <cmath>
#include <vector>

#include "base/small_matrix.hpp"
#include "mesh/cells.hpp"

namespace almesh {

// Edge vectors of the regular tetrahedron, in columns; the first two are those of the triangle.
inline const Mat<3> regular_edges = {
    {{1, 0.5, 0.5}, {0, std::sqrt(0.75), std::sqrt(1.0 / 12)}, {0, 0, std::sqrt(2.0 / 3)}}};

std::vector<double> regular_cell(const CellType& cell);  // vertices x dim

// Jacobian of the map from the reference cell, which is no pyramid: the edges of the factors, block by block.
template <int n>
Mat<n> regular_jacobian(const CellType& cell) {
    Mat<n> A{};
    for (int k = 0; k < n; ++k) {
        const auto [factor, from, to] = cell.coordinate(k);
        const int place = to - from - 1;
        for (int i = 0; i <= place; ++i) A[k - place + i][k] = regular_edges[i][place];
    }
    return A;
}

template <int n>
double regular_volume(const CellType& cell) {
    return cell.is_collapsed ? std::sqrt(0.5) / 3 : determinant(regular_jacobian<n>(cell)) * cell.volume();
}

// The same to the regular cell of a volume. Of a pyramid, whose Jacobian is not constant, no more than its scale.
template <int n>
Mat<n> regular_jacobian(const CellType& cell, double volume) {
    Mat<n> A{};
    for (int k = 0; k < n; ++k) A[k][k] = 1;
    if (!cell.is_collapsed) A = regular_jacobian<n>(cell);
    const double scale = std::pow(volume / (determinant(A) * cell.volume()), 1.0 / n);
    for (auto& row : A)
        for (double& a : row) a *= scale;
    return A;
}

// Nodes of the regular cell of degree p that has the volume of the reference cell.
std::vector<double> regular_nodes(const CellType& cell, int degree);

}  // namespace almesh
