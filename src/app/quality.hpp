// What is said on the terminal about the validity and the shape of the elements, at the end of a run and by
// `almesh quality FILE`.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "check/certificate.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// The command: prints certificate and statistics of a mesh file to `out`. success: every element is certified valid,
// else not_certified. Throws InputError for a file that is no mesh.
ExitCode quality(const std::string& mesh_path, std::FILE* out);

// How many elements the certificate could not prove valid, and the worst ten: id, centre (in units of the mesh file:
// that of x times length), lower bound of the scaled Jacobian. Prints nothing where all are certified.
void print_uncertified(std::FILE* out, const Mesh& mesh, const std::vector<double>& x, double length,
                       const Certificate& certificate);

}  // namespace almesh
