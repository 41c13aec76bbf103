// The boundary of a mesh being built: the faces of one element only, with the tags of the file's face elements.
//
// Faces are matched by their vertices: at each vertex, those around it that have no smaller one are sorted. Cost:
// O(elements log(elements around a vertex)) time, 16 bytes per tetrahedron (12 per triangle).
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh {

// What of raw.elements makes the mesh, in file order (indices into raw.elements).
struct Selection {
    int dim = 0, degree = 0;
    std::vector<int> elements;  // of dimension dim
    std::vector<int> faces;     // of dimension dim - 1 with a physical tag
};

// Pairs of elements on the same side of the face they share: none in a valid mesh.
struct FoldedPairs {
    int count = 0, first = -1, second = -1;  // elements of the first pair found
};

// Fills all that Mesh says of faces; the nodes and elements are there already. index: node of the mesh by raw node, -1:
// none. Adds to `notes`; throws InputError where faces, elements and tags do not go together (see build_mesh()).
FoldedPairs fill_boundary(const RawMesh& raw, const Selection& chosen, const std::vector<int>& index, Mesh& mesh,
                          std::vector<std::string>& notes);

}  // namespace almesh
