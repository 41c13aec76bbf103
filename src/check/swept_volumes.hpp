// What the faces of all elements sweep while every node goes straight from where it was, X, to where it is, x:
//
//     V_f = int_0^1 int_f w . n(s) dA ds,   w = sum_i N_i (x_i - X_i),   n dA of the face at X + s (x - X).
//
// With all faces of an element, outward, this is what its volume gains: div w integrated along the way (geometric
// conservation law; Thomas, Lombard, AIAA J. 17, 1979). The integrand is a polynomial in s and, on the reference face,
// in xi: the quadrature has no error, on curved faces either.
#pragma once
#include <vector>

#include "mesh/sides.hpp"

namespace almesh {

struct MeshFace {
    int element, side;   // as it is oriented: out of this element,
    int neighbour = -1;  // into this one; -1: it is on the boundary
};

// Each face once, from the first element that has it; in the order of the elements and their sides.
std::vector<MeshFace> mesh_faces(const Mesh& mesh);

// The nodes of a face in Gmsh's order, around it as seen from outside of its element. local: of the mesh's degree.
std::vector<int> nodes_of(const Mesh& mesh, const SideNodes& local, const MeshFace& face);

// Per face, > 0 if it moves out of its element. before, now: nodes x dim.
std::vector<double> swept_volumes(const Mesh& mesh, const std::vector<MeshFace>& faces,
                                  const std::vector<double>& before, const std::vector<double>& now);

}  // namespace almesh
