// Meshes built in code for the tests.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh::test {

// Names the boundary that a face belongs to from the face's centre.
using BoundaryName = std::function<std::string(const double* centre)>;

// A linear mesh with its boundary faces found and named; ids count from 1.
Mesh linear_mesh(int dim, std::vector<double> x, std::vector<int> elements, const BoundaryName& name,
                 std::vector<ElementGroup> groups = {});

// Unit square, k x k cells of two triangles; boundaries left, right, bottom, top.
Mesh square_mesh(int k);

// Unit square, k x k squares; boundaries left, right, bottom, top. Inner vertices are moved by `amplitude` / k or less,
// so that the cells are no parallelograms. mixed_mesh: those in the right half are two triangles, the first elements.
Mesh quad_mesh(int k, double amplitude = 0);
Mesh mixed_mesh(int k, double amplitude = 0);

// Unit cube, or as many in a row along x, of k x k x k cells of six tetrahedra; boundaries bottom, top, sides.
Mesh cube_mesh(int k, int cubes = 1);

// Ring 1 <= r <= outer with `around` cells around and `layers` layers of geometric growth; boundaries inner, outer.
Mesh ring_mesh(int around, int layers, double outer);

// The linear mesh, and once more, scaled and moved, as a part of its own; one boundary, "rim".
Mesh two_parts(const Mesh& mesh, double scale, const std::array<double, 3>& shift);

// The face of the boundary whose centre is nearest to x.
int face_near(const Mesh& mesh, int boundary, const std::array<double, 3>& x);

// Positions moved by a smooth map that keeps the elements valid: x + amplitude sin(...) in each component.
std::vector<double> wavy(const std::vector<double>& x, int dim, double amplitude);

}  // namespace almesh::test
