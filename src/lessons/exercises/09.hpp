// Exercises of lesson 9. Answers go into 09.cpp and inputs/lessons/09-curving/exercises/; `make check-lesson-09` says
// which hold.
#pragma once
#include <array>

namespace almesh::lessons {

// 9.1 The least number n of equal straight edges, with their ends on a circle of radius R, that stay within
// `tolerance` < R of it: the middle of a chord is the point that is farthest off.
int edges_needed(double R, double tolerance);

// 9.2 Nodal values {a, b} of the linear function u(t) = a (1 - t) + b t on [0, 1] that is closest to a function g in
// the norm of L2, from its moments m_0 = integral of g (1 - t), m_1 = integral of g t. (The mass matrix is
// M_ij = integral of N_i N_j.)
std::array<double, 2> projection(double m_0, double m_1);

using Quadratic = std::array<double, 3>;

// 9.3 Bezier coefficients b of the quadratic q = b_0 (1 - t)^2 + 2 b_1 t (1 - t) + b_2 t^2 from q(0), q(1/2), q(1).
Quadratic bezier_coefficients(double at_start, double at_middle, double at_end);

// 9.4 Whether the quadratic with Bezier coefficients b is positive on all of [0, 1]: a proof, not a sample. true is
// never said where it is not known; a quadratic that touches zero is not positive. Positive coefficients prove it, an
// end that is not positive disproves it, and halves know more than the whole.
bool positive_everywhere(const Quadratic& b);

// 9.5 exercises/fine_wall.deck: degree and refinement for |c_D| <= 2e-6 with at most 4000 nodes.

// 9.6 A triangle of degree 2: its vertices 0, 1, 2, then the nodes of its edges 01, 12 and 20, which are the images of
// their middles. J has the derivatives by l_1 and l_2, with l_0 = 1 - l_1 - l_2. The Bernstein coefficients of det J in
// the same order, and whether det J > 0 everywhere: a proof, not a sample, and not true where det J touches zero.
using CurvedTriangle = std::array<std::array<double, 2>, 6>;
std::array<double, 6> jacobian_coefficients(const CurvedTriangle& x);
bool proved_valid(const CurvedTriangle& x);

}  // namespace almesh::lessons
