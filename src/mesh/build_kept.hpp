// The third part of build_mesh(): the cells of the file that are neither elements nor boundary faces.
#pragma once
#include "mesh/build_boundary.hpp"

namespace almesh {

// Nodes without an element. Call with MeshBuild::node filled; gives them -2 - k there, k their number among the loose
// ones.
void fill_loose_nodes(MeshBuild& build);

// Fills Mesh::kept from MeshBuild::kept, once elements and nodes are there. Curves and faces that are not in the mesh
// are dropped with a note. Cost: O(elements + kept cells * elements around a vertex).
void fill_kept(MeshBuild& build);

}  // namespace almesh
