// The volume, and the shape, that each element of a mesh would have if it were like those around it: for ideal elements
// of elements that are bad, or inverted, themselves.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// x: node_count x dim. valid: per element, whether its volume counts; where none does, all are of the same volume.
// The volumes are positive; the sum of a mesh in one piece is that of the mesh where this is positive.
std::vector<double> local_volumes(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& valid);

// Per element the matrix (dim x dim) of the map from its regular cell, as DistortionParams::regular has it. Those that
// count, which must be valid, have their own; the others are like those in the same layer, and regular outside layers.
// Empty where none of the others is in a layer.
std::vector<double> local_shapes(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& counts);

}  // namespace almesh
