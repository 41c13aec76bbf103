// Builds a Mesh from the contents of a mesh file: repairs what can mean only one thing, refuses what is wrong.
//
// The elements are those of the highest dimension in the file. A face of only one element is a boundary face and needs
// a face element with a physical tag in the file (mesh/build_boundary.hpp).
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh {

// What to do with a mesh that folds over itself: elements that lie on the same side of the face they share, because
// one of them is inverted.
enum class Folds {
    refuse,
    keep  // oriented as their neighbours, what hangs together with positive volume, so that the others count as inverted
};

// Points, curves of 3D meshes and faces inside the mesh are kept (Mesh::kept). Repaired, each with a line in `notes`:
// elements of negative orientation (turned over), elements that are given again, curves and faces that are not in the
// mesh (dropped).
// Throws InputError: no elements of dimension 2 or 3, mixed degrees, a surface in space, elements of zero volume, faces
// of three elements, neighbours that do not share the nodes of their face, and folds unless they are kept.
// Cost: O(nodes + elements log(elements around a vertex)).
Mesh build_mesh(const RawMesh& raw, std::vector<std::string>& notes, Folds folds = Folds::refuse);

}  // namespace almesh
