// Exercises of lesson 3. Answers go into 03.cpp; `make check-lesson-03` says which hold.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "base/small_matrix.hpp"
#include "linalg/block_csr.hpp"

namespace almesh::lessons {

using Triangles = std::vector<std::array<int, 3>>;  // node numbers, from 0

// 3.1 The gradients of the three hat functions on the triangle with the vertices y: N_i is 1 at y_i, 0 at the others.
std::array<Vec<2>, 3> hat_gradients(const std::array<Vec<2>, 3>& y);

// 3.1, too: the cotangents of the angles at its vertices, from these gradients alone.
std::array<double, 3> cotangents(const std::array<Vec<2>, 3>& gradient);

// 3.2 The first array of the CSR pattern, `row`: row[i] blocks come before row i, row[nodes] are all. Row i has a block
// for node i itself and one for every node that is in a triangle with it. Twice the triangles may take twice the time.
std::vector<int> row_offsets(int nodes, const Triangles& triangles);

// 3.3 The gradient of the mesh from those of its triangles: local[e][i] is dE_e/dx of vertex i of triangle e. Result:
// (x_0, y_0, x_1, y_1, ...).
std::vector<double> assemble(int nodes, const Triangles& triangles, const std::vector<std::array<Vec<2>, 3>>& local);

// 3.3, too: the same where some nodes are tied to others, as those of a crack that is to stay closed. Node i moves with
// node leader[i], which may be tied to another one itself; leader[i] = i where it moves by itself. The gradient with
// respect to the nodes that do; the entries of all others are 0. There are leader.size() nodes.
std::vector<double> assemble_tied(const std::vector<int>& leader, const Triangles& triangles,
                                  const std::vector<std::array<Vec<2>, 3>>& local);

// 3.4 Adds the Hessian of one triangle to that of the mesh: local[2 i + a][2 j + b] is the derivative of entry a of the
// gradient at its vertex i with respect to coordinate b of its vertex j. H has all blocks that are needed:
// H.block(H.find(row, column)) is a block of 2 x 2 numbers, row by row.
void add_to(BlockCsr& H, const std::array<int, 3>& triangle, const std::array<std::array<double, 6>, 6>& local);

// 3.5 Four vectors that span the kernel of the Hessian of an ideal mesh with the node positions x (x_0, y_0, x_1, ...).
std::array<std::vector<double>, 4> kernel(const std::vector<double>& x);

// 3.6 Colours 0, 1, ... of the nodes, greedily in their order: the first colour in which no earlier node has a block in
// one of the rows in which this one has a block. H has the pattern of a mesh: row i the blocks of i and its neighbours.
std::vector<int> colours(const BlockCsr& H);

// 3.6, too: the Hessian by central differences with the step h of the gradient, which is called four times for each
// colour. H has all blocks that are needed, with any numbers in them; H.row and H.col are the arrays of 3.2.
using Gradient = std::function<std::vector<double>(const std::vector<double>& x)>;  // (x_0, y_0, x_1, y_1, ...)
void difference_hessian(const Gradient& gradient, const std::vector<double>& x, double h, BlockCsr& H);

}  // namespace almesh::lessons
