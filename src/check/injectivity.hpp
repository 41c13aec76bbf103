// Whether the mesh covers every point once: no two elements overlap, not only none inverted.
//
// Let every element be valid (certificate.hpp). The number of points that the map phi takes to y is then the degree of
// phi at y, which depends on the boundary alone, and changes only across the image of the boundary (Lipman, ACM Trans.
// Graph. 33(4), 2014, for straight meshes): by one for each face there, up to the side where its element is. Two faces
// with the same points and opposite normals, the lips of a crack, change nothing: phi is that of a mesh that is glued
// together there. Its boundary is that of the mesh without such pairs, its nodes are the places of the mesh's nodes.
//
// Let R be where phi covers points twice, and let there be such. R ends at faces, with their elements inside: along
// part of a face F, points just behind it are in its element and in another one. Either this holds all along F, and
// the centre of F is in such an element. Or it begins at a point inside F where another face G is, which ends R as
// well, so that elements at G overlap the one behind F. G goes through F there, or it touches F. So phi covers no point
// twice where
//   - no two faces cross (check_target(); of neighbours in 3D their common side alone is looked at),
//   - the element behind each face overlaps no other one that the centre of the face is in,
//   - where F and G touch, the element behind F overlaps none at the vertices of G, and the other way round,
// the last two by separating axes of the elements, after bisections where they are curved. What touches does not
// overlap, in whatever way it touches. All this is up to a distance of 1e-9 of an edge, and what positions are rounded
// by. As a check of its own, the angles at every place must add up to 2 pi in 2D, the solid angles to 4 pi in 3D, at
// the boundary to no more.
//
// Where boundaries are declared to be in contact (Mesh::contact), elements at one may overlap those at the other. What
// is certified then is that nothing else overlaps, and how far faces of one reach into elements at the other is
// measured, at points of theirs; by more than a quarter of an edge, it is not certified.
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

// Whether elements lie over each other: the second and third of the conditions above. report: that of the same
// positions. In curved elements the answer is yes too where they are too close to tell. The first two elements, the
// one behind a boundary face first; -1: none. x: node_count x dim positions. Cost: O(elements log faces), and of
// touching faces that of separating the elements at them.
std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x, const TargetReport& report);

}  // namespace almesh
