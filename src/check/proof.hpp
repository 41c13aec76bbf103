// A proof that the mesh is valid and injective, for a checker that computes exactly (tests/verify.py; the format and
// its argument: outputs/README.md). What the checker sees at once is not in it: elements whose Bezier coefficients of
// det J are all positive, faces of the boundary that a plane separates. Of others it has the bisections after which
// it is so.
#pragma once
#include <string>
#include <vector>

namespace almesh {

struct Mesh;

struct Proof {
    std::string lines;   // of elements, faces and pairs of faces
    std::string missing;  // what could not be proved, the first of all; empty: nothing
};

// x: node_count x dim positions. The degree is 4 at most. Deterministic. Cost: about that of certify(), and of the
// faces that come close to each other, all neighbours.
Proof make_proof(const Mesh& mesh, const std::vector<double>& x);

// Its lines of the boundary (boundary_proof.cpp), appended.
void prove_boundary(const Mesh& mesh, const std::vector<double>& x, Proof& proof);

}  // namespace almesh
