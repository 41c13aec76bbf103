// Boundaries that are drawn onto surfaces on which they do not lie yet (`onto FILE`).
//
// The energy is minimised with a penalty for the distance of the boundary nodes from goals, which follow the iterate:
// a node is pulled to the closest point of the surface, and the point of the boundary that is closest to a node of the
// surface is pulled there. The second pull brings the mesh into ends and bulges which are closest points of none of its
// nodes. Both look only at places where the normals agree. The penalty grows from next to nothing: first the mesh moves
// and bends as a whole. Every iterate is valid. What is reached is near the surface; the augmented Lagrangian goes on
// from there with nodes that slide along it. (Closest points: P. J. Besl, N. D. McKay, IEEE Trans. PAMI 14, 1992; with
// a stiffness that falls: B. Amberg, S. Romdhani, T. Vetter, CVPR 2007.)
#pragma once
#include <string>
#include <vector>

#include "problem/problem.hpp"

namespace almesh {

// x with such boundaries near their surfaces. mesh: of the problem, ideal and target: of it, x: its nodes, a valid mesh,
// all in the file's frame. is_near: x has been drawn there, on another mesh. Throws InputError where x is not valid, and
// where a surface is of another size or far away.
std::vector<double> drawn(const ProblemOptions& options, const Problem& problem, Mesh mesh, std::vector<double> ideal,
                          BoundaryTarget target, std::vector<double> x, bool is_near);

// x (nodes of problem.mesh(), in the file's frame) with the nodes of such boundaries at the closest points of their
// surfaces, but for those whose elements would lose half their certified bound. left: on return how far off these are.
std::vector<double> at_closest_points(const ProblemOptions& options, const Problem& problem,
                                      const std::vector<double>& x, std::vector<double>& left);

// A line for each surface: how far the boundary at x (nodes of problem.mesh(), in the file's frame) and the surface are
// from each other.
std::string distances_text(const ProblemOptions& options, const Problem& problem, const std::vector<double>& x);

}  // namespace almesh
