// Whether the mesh covers every point once: no two elements overlap, not only none inverted.
//
// Let every element be valid (certificate.hpp). The number of points that the map phi takes to y is then the degree of
// phi at y, which depends on the boundary alone, and changes only across the image of the boundary, by one (Lipman,
// ACM Trans. Graph. 33(4), 2014, for straight meshes). Where the boundary does not cross itself, each of its closed
// parts keeps its orientation, and none has moved through another (target_check.hpp), the degree is that of the
// initial mesh: one inside, zero outside. So phi is injective, whatever lies between. Where the boundary is not in its
// place yet it can overlap itself while all elements are valid, and nodes inside can then have elements around them
// that fill their surroundings twice; as a check of its own, the angles at every node must add up to 2 pi in 2D, the
// solid angles to 4 pi in 3D, at nodes of the boundary to no more.
//
// An initial mesh that covers points twice already tells nothing of that: parts of it that lie over each other, a strip
// that goes around twice, whose boundaries lie on each other and do not cross. overlapping_elements()
// finds those.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/frame.hpp"
#include "check/certificate.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct Injectivity {
    bool certified = false;
    std::string reason;  // what stands in the way; empty where certified
    int node = -1;         // where: the node that elements overlap around,
    int face = -1;         // or a face at which the boundary overlaps itself
    std::array<double, 3> position{};  // of the node or the face's centre, at x; in 2D the third coordinate is 0
};

// The reason with its position in the file: "the elements around node 3 overlap at (0.5, 1)".
std::string overlap_text(const Mesh& mesh, const Injectivity& found, const Frame& frame = {});

// x: node_count x dim positions; certificate: of these. An initial mesh that overlaps itself is not certified.
// Cost: O(elements), and that of check_target().
Injectivity certify_injective(const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate);

// Whether elements lie over each other beside the boundary, where the number of elements over a point changes.
//
// Let all elements be valid and the boundary not cross itself, as check_target() finds. A region that is covered twice
// then ends at boundary faces, and just inside of one of these, all along it but where other boundaries touch it, a
// point is in two elements. So a point of the element behind each boundary face, close to the centre of the face, must
// be in no other element. Parts that touch along faces are in order, and so are zones of a file (FileTags) that lie
// over each other.
//
// In straight simplices by their barycentric coordinates; in other elements by bisection of their Bezier patches. The
// first two elements in whose interior the same point is, the one behind a boundary face first; -1: none. x: node_count
// x dim positions. Cost: O(elements log faces).
std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh
