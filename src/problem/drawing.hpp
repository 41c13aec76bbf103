// Boundaries that are drawn onto surfaces on which they do not lie yet (`onto FILE`).
//
// The energy is minimised with a penalty for the distance of the boundary nodes from goals, which follow the iterate:
// a node is pulled to the closest point of the surface, and the point of the boundary that is closest to a node of the
// surface is pulled there. The second pull brings the mesh into ends and bulges which are closest points of none of its
// nodes. Both look only at places where the normals agree. The penalty grows from next to nothing: first the mesh moves
// and bends as a whole. From a certain penalty on only the pull across the surface grows, and edges and corners are
// pulled to those of the surface. Every iterate is valid; nodes of other boundaries stay. At last each node goes to a
// point of the surface. (P. J. Besl, N. D. McKay, IEEE Trans. PAMI 14, 1992; B. Amberg et al., CVPR 2007.)
#pragma once
#include <string>
#include <vector>

#include "problem/problem.hpp"

namespace almesh {

// Gives the problem, if such boundaries are in it, a start near their surfaces, and a target: points of these. Nodes
// whose elements would be inverted there, or nearly so, stay where they are: off their motions, which a note explains.
// Throws InputError where the mesh is not valid, and where a surface is of another size or far away.
void draw_onto(const ProblemOptions& options, Problem& problem);

// Of a mesh that is improved, nodes that were drawn onto a surface slide along it from there; those that were not
// brought to a point of all surfaces on which they are to be stay.
void hold_off_surface(Problem& problem);

// A line for each surface: how far the boundary at x (nodes of problem.mesh(), in the file's frame) and the surface are
// from each other.
std::string distances_text(const ProblemOptions& options, const Problem& problem, const std::vector<double>& x);

}  // namespace almesh
