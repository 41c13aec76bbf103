// Exercises of lesson 5. Answers go into 05.cpp; `make check-lesson-05` says which hold.
#pragma once
#include <array>
#include <vector>

#include "base/small_matrix.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh::lessons {

// 5.1 The stiffness matrix of the Laplacian on one triangle, K_ij = |e| grad N_i . grad N_j, N_i the hat functions; the
// vertices are counter-clockwise.
Mat<3> laplacian_of_triangle(const std::array<Vec<2>, 3>& vertex);

// 5.2 How far the circle of radius r in the middle of one of radius R can be translated before the harmonic extension
// inverts something.
double reach_of_translation(double r, double R);

// 5.3 det F at the distance r from the middle, 1 <= r <= R, after the inner circle, of radius 1, has been turned by the
// angle theta (in radians), the outer one, of radius R, has been held, and the displacement extended harmonically.
double determinant_of_turn(double theta, double R, double r);

// 5.4 The extension u = (Q - I) x s(|x|) of a rotation Q with any profile s, s(1) = 1, given its slope s'(1): the
// smallest angle of Q, above 0, in radians, at which det F = 0 at the inner circle; infinity where there is none.
double turn_of_profile(double slope);

// 5.6 How far the circle of radius 1 in the middle of one of radius R can be translated if the displacement u solves
// div(r^-p grad u) = 0 in place of Laplace's equation: any p, 0 and numbers near it among them.
double reach_with_stiffness(double p, double R);

// 5.6, too: the same on a mesh, from one solve. Nodes with moved[i] go by d in the direction of x, those with held[i]
// stay, the others solve sum over triangles of stiffness[e] |e| grad N_i . grad u = 0. Returns the smallest d > 0 at
// which a triangle has no area, infinity if there is none. For the linear system take solve_dense.
struct Extension {
    std::vector<Vec<2>> x;                      // of each node
    std::vector<std::array<int, 3>> triangles;  // counter-clockwise
    std::vector<double> stiffness;              // of each triangle
    std::vector<char> moved, held;              // of each node
};
double reach_of_mesh(const Extension& mesh);

}  // namespace almesh::lessons
