// Whether the mesh is injective: it covers every point once, so that no two elements overlap.
//
// Let every element be valid (certificate.hpp). The number of points that the map phi takes to y is then the degree of
// phi at y, which depends on the boundary alone, and changes only across the image of the boundary (for straight meshes
// Y. Lipman, SIAM J. Imaging Sci. 7(2), 2014): it rises by one towards the element of each face there. Two faces with
// the same points and opposite normals, the lips of a closed crack, change nothing: the mesh counts as glued together
// there. Such pairs do not belong to its boundary, and nodes at the same place are one node.
//
// Let the set R of points that phi covers twice be not empty. R ends at faces whose elements are inside R: along part
// of a face F, points just behind it are in its element and in another one. Either this holds all along F, and
// the centre of F is in such an element. Or it begins at a point inside F where another face G is, which ends R as
// well, so that elements at G overlap the one behind F. G goes through F there, or it touches F. So phi covers no point
// twice where
//   - no two faces cross (check_target(); of neighbours in 3D their common side alone is looked at),
//   - the element behind each face overlaps no other one that the centre of the face is in,
//   - where F and G touch, the element behind F overlaps none at the vertices of G, and the other way round,
// the last two by separating axes of the elements, after bisection if they are curved. Elements that merely touch do
// not overlap. All tests have a tolerance of 1e-9 of an edge plus the rounding of the positions. As an independent
// check, the angles of the elements at a point may add up to 2 pi at most, in 3D their solid angles to 4 pi.
//
// If boundaries are declared to be in contact (Mesh::contact), elements at one may overlap those at the other. Then it
// is certified that nothing else overlaps, and the depth to which faces of one reach into elements at the other is
// measured at sample points; if it exceeds a quarter of an edge, the mesh is not certified.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/frame.hpp"

namespace almesh {

struct Certificate;
struct Mesh;
struct TargetReport;

struct Injectivity {
    bool certified = false;
    std::string reason;  // what stands in the way; empty where certified
    int node = -1;         // where: the node that elements overlap around,
    int face = -1;         // or a face at which the boundary overlaps itself,
    int other_face = -1;   // and the one that it crosses in the initial mesh already
    double overlap = 0, relative_overlap = 0;  // of boundaries in contact (Mesh::contact); in units of an edge
    std::array<double, 3> position{};  // of the node or the face's centre, at x; in 2D the third coordinate is 0
};

// The reason with its position in the file: "the elements around node 3 overlap at (0.5, 1)".
std::string overlap_text(const Mesh& mesh, const Injectivity& found, const Frame& frame = {});

// x: node_count x dim positions; certificate: of these. Cost: O(elements), and that of check_target().
Injectivity certify_injective(const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate);

// The first two elements that overlap by the second or third condition above, the one behind a boundary face first; -1:
// none. report: that of the same positions. Curved elements that are too close to decide count as overlapping.
// x: node_count x dim positions. Cost: O(elements log faces), and for touching faces that of separating
// their elements.
std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x, const TargetReport& report);

}  // namespace almesh
