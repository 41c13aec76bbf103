// The boundary of a mesh that is improved, and the surfaces between its regions, stay within surface_tolerance, in
// units of the local edge, of where the file has them: measured after the run, both ways (check/boundary_distance.hpp),
// on boundaries that are fixed or only slide.
//
// A node that slides along a round body takes its flat faces farther than that off those of the file. So nodes of faces
// that are beyond the tolerance from the surface along which they slide are fixed from the beginning, and so are named
// points and curves on the boundary. If faces of a mesh that is made better are still off, their nodes go back
// (improvement_guard.hpp).
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

// Fix these nodes of a problem without functional, and note how many. In a mesh with inverted elements the nodes of
// curved faces are fixed after it has been untangled, at x.
void hold_surface(const ProblemOptions& options, Problem& problem);
void hold_curved_faces(const ProblemOptions& options, Problem& problem, const std::vector<double>& x);

// Makes x the target of boundary nodes that have moved since `from`; fix_boundary() fixes all boundary nodes at x.
void take_along_target(Problem& problem, const std::vector<double>& from, const std::vector<double>& x);
void fix_boundary(Problem& problem, const std::vector<double>& x);

// Distances of the boundaries that stay, both ways, in units of the local edge: per face, or none; and the largest.
std::vector<double> distances_from_surface(const Problem& problem, const std::vector<double>& x);
double surface_distance(const Problem& problem, const std::vector<double>& x);

// How far the surface is from that of the file, by how much the volumes of the regions have changed, and more.
void print_surface(std::FILE* out, const ProblemOptions& options, const Problem& problem, const std::vector<double>& x,
                   double distance, const std::string& more);

}  // namespace almesh
