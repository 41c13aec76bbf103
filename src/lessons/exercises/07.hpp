// Exercises of lesson 7. Answers go into 07.cpp; `make check-lesson-07` says which hold.
#pragma once
#include <array>
#include <vector>

#include "base/small_matrix.hpp"

namespace almesh::lessons {

using Vector = std::vector<double>;

// 7.1 The exact multiplier of a single mode, to which all updates together would lead. c_1: the constraint at the
// minimum for lambda, not 0; c_2: at the minimum for lambda - mu c_1, that is after one update; mu: the penalty.
double exact_multiplier(double lambda, double mu, double c_1, double c_2);

// 7.2 The forces f = M lambda / |1| of a polygonal wall. edges: pairs of nodes; lambda: two numbers for each node. In
// the scalar product with the weight 1/h an edge of any length adds (2 1; 1 2)/6 to M and 1 to |1|^2.
Vector wall_forces(const std::vector<std::array<int, 2>>& edges, const Vector& lambda);

// 7.3 The smallest penalty mu > 0 with which an update divides the error of a mode of stiffness kappa by q > 1.
// kappa < 0 is a mode along which the energy falls; kappa is not 0.
double penalty_for(double kappa, double q);

// 7.4 minimise 1/2 x' K x - b' x subject to a' x = g, by the method of multipliers: lambda = 0 at first; each turn
// minimises 1/2 x' K x - b' x - lambda c + mu/2 c^2, c = a' x - g, over x, and updates lambda with the c of this
// minimum. The turn that finds |c| <= 1e-10 is the last, and updates, too. Returns the number of updates, and lambda.
struct Multiplier {
    int updates = 0;
    double lambda = 0;
};
Multiplier method_of_multipliers(const Mat<2>& K, const Vec<2>& b, const Vec<2>& a, double g, double mu);

// 7.5 exercises/three.deck: the smallest power of ten for mu0 that needs three iterations at most.

// 7.6 The stiffest mode of a quadratic E = 1/2 x' K x - b' x: the largest kappa with S v = kappa M v / |1|^2, S the
// stiffness of the boundary when the other unknowns follow it. K: symmetric, positive definite, its rows; M: of its
// last unknowns, those of the boundary.
double stiffest_mode(std::vector<Vector> K, const std::vector<Vector>& M, double one_squared);

}  // namespace almesh::lessons
