// Whether elements lie over each other beside the boundary, where the number of elements over a point changes.
//
// Let all elements be valid and the boundary not cross itself, as check_target() finds. A region that is covered twice
// then ends at boundary faces, and just inside of one of these, all along it but where other boundaries touch it, a
// point is in two elements. So a point of the element behind each boundary face, close to the centre of the face, must
// be in no other element. Parts that touch along faces are in order, and so are zones of a file (FileTags) that lie
// over each other.
//
// In straight simplices by their barycentric coordinates; in other elements by bisection of their Bezier patches.
#pragma once
#include <array>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// The first two elements in whose interior the same point is, the one behind a boundary face first; -1: none.
// x: node_count x dim positions. Cost: O(elements log faces).
std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh
