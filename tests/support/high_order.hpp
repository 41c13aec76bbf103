// High-order meshes for the tests of this folder: a linear mesh with the nodes of degree p put in.
#pragma once
#include <functional>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh::test {

// The linear mesh with straight-sided elements of degree p; vertices keep their numbers.
Mesh with_degree(const Mesh& linear, int degree);

// Positions of all nodes after `map` has changed each (dim coordinates, in place).
std::vector<double> mapped(const Mesh& mesh, const std::function<void(double*)>& map);

// Positions of the boundary nodes per face (face x face node x dim), as the target check takes them.
std::vector<double> on_faces(const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh::test
