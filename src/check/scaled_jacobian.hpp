// The scaled Jacobian at the corners of elements: the determinant of the unit vectors along the edges at a vertex, over
// that of the regular cell (Knupp, Int. J. Numer. Meth. Eng. 48, 2000; the Verdict library). 1 for the regular cell,
// not positive where the corner is flat or inverted. Curves between the vertices are seen by the certificate alone.
#pragma once
#include <array>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// A vertex and the ends of dim edges there, at the apex of a pyramid three of its four. regular: of the regular cell, the
// determinant of the unit vectors along them.
struct Corner {
    std::array<int, 4> vertex;
    double regular;
};

std::vector<Corner> corners_of(const CellType& cell);

// Per element: the least of its corners. x: node_count x dim.
std::vector<double> corner_jacobians(const Mesh& mesh, const std::vector<double>& x);

// The least of all elements.
double least_corner_jacobian(const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh
