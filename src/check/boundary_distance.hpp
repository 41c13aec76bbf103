// How far the curved faces of a mesh are from where they came: what a valid mesh costs of the shape that was given.
//
// d(y): from a point y of a face as it is to the closest point of the faces of the same boundary as they came, all of
// them: a node that slid along that surface is on it. h: the longest edge of y's face as it came, from corner to corner.
// d is taken at a grid of barycentric coordinates in the face, its corners, edges and middle included, and is linear
// between them; then
//
//     largest = max d,   rms^2 = integral of d^2 / area,   the same of d / h,
//
// over all faces of the boundary. Faces whose nodes have the bits with which they came take no time.
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct BoundaryDistance {
    int boundary = 0;
    int faces = 0, moved = 0;  // moved: more than rounding away somewhere
    double moved_area = 0;     // share of the area
    double largest = 0, rms = 0;
    double relative_largest = 0, relative_rms = 0;  // of d / h
};

// Of the boundaries that have moved faces. came, x: node_count x dim positions, finite. measured: per boundary, empty
// for all.
std::vector<BoundaryDistance> boundary_distances(const Mesh& mesh, const std::vector<double>& came,
                                                 const std::vector<double>& x, const std::vector<char>& measured = {});

// A table with a row for each, below a line that says from what; empty where there are none.
std::string table_of(const Mesh& mesh, const std::vector<BoundaryDistance>& distances, const std::string& from);

}  // namespace almesh
