// The elements that a certificate could not prove valid, for the terminal.
#pragma once
#include <cstdio>
#include <vector>

#include "check/certificate.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// How many, and the worst ten: id, centre (in units of the mesh file: x times length), lower bound of the scaled
// Jacobian. Prints nothing where all are certified.
void print_uncertified(std::FILE* out, const Mesh& mesh, const std::vector<double>& x, double length,
                       const Certificate& certificate);

}  // namespace almesh
