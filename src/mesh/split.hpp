// Dividing edges and faces inside a mesh by a node: the stellar subdivision of the elements around them.
//
// With m the middle of the simplex s, an element s * t becomes the elements (s without v) * m * t, one for each vertex
// v of s: two of an edge, three of a face. In degree p the nodes of the parts are at the points k / (|s| p) of the
// element in barycentric coordinates, k integer and |s| the number of vertices. The nodes of the element are among
// them, its own map places the others: a curved mesh keeps its shape, its nodes, and the faces that do not have s.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

using Simplex = std::vector<int>;  // an edge or a face by its vertices, ascending

// Of each of the elements, the edges between nodes of faces of the mesh that are on no face; in 3D where it has none,
// such sides. A node inside that divides them gives every part of the element a vertex that is on no face. boundaries:
// those whose faces count; empty: all. Cost: O(faces log faces).
std::vector<std::vector<Simplex>> inner_simplices(const Mesh& mesh, const std::vector<int>& elements,
                                                  const std::vector<char>& boundaries = {});

// Divides each of these, which are on no face of the mesh, one after the other. One part of an element takes its place
// and its id, the others are behind all elements, with new ids; all have its tags. Kept cells are divided alike. Data
// by element and corner ($ElementNodeData) are left out. Cost: O(elements), and O(kept cells) for each.
Mesh split(Mesh mesh, const std::vector<Simplex>& at);

}  // namespace almesh
