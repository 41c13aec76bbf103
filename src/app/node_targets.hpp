// Places of single nodes from files: the steps `file` and `mesh` of a motion.
#pragma once
#include <string>
#include <vector>

#include "constraint/motion.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// The positions of the mesh (nodes x dim), with those of the boundary's nodes from the step's file. Throws InputError,
// with the line where there is one, for ids that are no nodes of the boundary (`file` only), doubled or missing ones,
// and numbers that are none.
std::vector<double> with_places_of_file(const Mesh& mesh, int boundary, const MotionStep& step,
                                        std::vector<double> positions);

}  // namespace almesh
