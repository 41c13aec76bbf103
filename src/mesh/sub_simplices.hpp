// Simplices that a simplex or a quadrilateral is cut into along its vertices, as curved simplices of a higher degree.
//
// The map of a quadrilateral of degree p has degree p in each coordinate. On each of the two triangles of the reference
// square it is a polynomial of total degree 2 p: the triangle is a curved triangle of that degree, exactly, with nodes
//
//     x'_i = sum_j S_ij x_j,   S_ij = N_j(xi_i),   xi_i: its nodes in the reference square.
//
// So what is known of curved triangles in space holds for quadrilateral faces. A simplex is the one that it is cut into.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "base/small_matrix.hpp"
#include "mesh/cells.hpp"

namespace almesh {

struct SubSimplices {
    int degree;                            // of the simplices: p of a simplex, 2 p of a quadrilateral
    int nodes, cell_nodes, corners;        // of one simplex, of the cell; corners of a simplex
    std::vector<CellChild> vertices;       // of each simplex: vertices of the cell, dim + 1 entries, same orientation
    std::vector<std::vector<double>> map;  // of each simplex: S, nodes x cell_nodes, in Gmsh's order of both

    // of: as `vertices`; empty: all, along the first diagonal. Those of a lower degree interpolate the cell.
    SubSimplices(const CellType& cell, int cell_degree, int degree, std::vector<CellChild> of = {});

    int count() const { return static_cast<int>(vertices.size()); }
    bool is_cell() const {  // the cell itself, node by node
        return count() == 1 && nodes == cell_nodes && std::is_sorted(vertices[0].data(), vertices[0].data() + corners);
    }
    // The reference coordinates in the cell of a point of simplex k, with these barycentric coordinates.
    std::array<double, 3> point(int k, const std::array<double, 4>& barycentric) const;

    // x'_i of simplex k, vertices to the last bit. position: of the nodes of the cell.
    std::vector<Vec<3>> nodes_of(int k, const std::vector<Vec<3>>& position) const;

private:
    std::vector<std::array<double, 3>> corner_;  // reference coordinates of the cell's vertices
};

}  // namespace almesh
