// The boundary of a mesh that is improved, and the surfaces between its regions, stay within surface_tolerance, in
// units of the local edge, of where the file has them: measured after the run, both ways (check/boundary_distance.hpp),
// on boundaries that are fixed or only slide.
//
// A node that slides along a round body takes its flat faces off the file's by more, wherever it goes. So the nodes of
// faces that are farther than that from the surface along which they slide stay from the beginning, and named points
// and curves on the boundary do. Where a solution has faces that are off still, their nodes stay too, and it is found
// again; the third time all nodes of these boundaries stay.
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

// Of a problem without functional. Notes how many nodes stay. Those of curved faces of a mesh with inverted elements do
// when it has been untangled, at x.
void hold_surface(const ProblemOptions& options, Problem& problem);
void hold_curved_faces(const ProblemOptions& options, Problem& problem, const std::vector<double>& x);

// The target of boundary nodes that have moved from `from` to x is where they are; and of all of them, which stay there.
void take_along_target(Problem& problem, const std::vector<double>& from, const std::vector<double>& x);
void fix_boundary(Problem& problem, const std::vector<double>& x);

// Whether faces are off the surface at x, the solution of this attempt, from 0, whose nodes stay where they are from
// here on.
bool hold_faces_off_surface(const ProblemOptions& options, Problem& problem, const std::vector<double>& x, int attempt,
                            std::FILE* out);

// The largest distance of the boundaries that stay, both ways, in units of the local edge.
double surface_distance(const Problem& problem, const std::vector<double>& x);

// How far the surface is from that of the file, and by how much the volumes of the regions have changed.
void print_surface(std::FILE* out, const ProblemOptions& options, const Problem& problem, const std::vector<double>& x);

}  // namespace almesh
