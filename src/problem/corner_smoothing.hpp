// The least scaled Jacobian of a mesh (check/scaled_jacobian.hpp) made as large as the nodes that move can make it.
//
// With s at the corners of all elements with such a node, and s_0 the least of them where a stage begins,
//
//     E_k(x) = sum 1/k exp(-k (s - s_0)) + w/2 ((1 - s)^2 + a (eta - 1)^2),   k = 10, 20, ..., 1280,
//
// is governed by many corners for small k and by the worst ones for large k; the squares, with a small w, keep the
// others good, and edges of similar lengths: eta is the distortion (paper, Eq. 1) of the map from the regular corner. (Freitag and Ollivier-Gooch, Int. J. Numer. Meth. Eng. 40, 1997, raise the worst corner around one node
// at a time.) Each stage goes on from the one before, by L-BFGS (method/lbfgs.hpp) in units of the edges at each node.
// Nodes that slide move along the tangents of their surfaces and are put back onto them.
//
// Where sizes are meant, as in layers at a wall, that of each element (the mean determinant at its corners) is to stay
// within a factor 1 + size_change: from four fifths of its logarithm on, it adds to E_k.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "constraint/constraint.hpp"
#include "mesh/mesh.hpp"
#include "mesh/periodic.hpp"
#include "method/lbfgs.hpp"

namespace almesh {

struct MovingNodes {
    const Mesh& mesh;               // of degree 1
    const std::vector<char>& moves;  // per node
    Constraint& surfaces;            // of nodes that move, those that it holds slide
    const PeriodicPairs& pairs;
    double size_change = 0;          // 0: sizes are free
    std::function<void(int step, int most)> observe;  // after each step
};

// Per element: the mean determinant at its corners, that of the regular cell's with the same edges 1. x: node_count x
// dim.
std::vector<double> element_sizes(const Mesh& mesh, const std::vector<double>& x);

// E_k near x, as a function of the displacements from there in units of the edges at each node.
std::unique_ptr<SmoothFunction> corner_function(const MovingNodes& moving, const std::vector<double>& x, double k);

// x: node_count x dim, a valid mesh that satisfies the constraint. After each stage that has a larger least s at corners
// with a node that moves, it becomes that mesh, as `taken` leaves it, if that returns true. Returns the number of steps.
int smooth_corners(const MovingNodes& moving,
                   const std::function<bool(const std::vector<double>& from, std::vector<double>& to)>& taken,
                   std::vector<double>& x);

}  // namespace almesh
