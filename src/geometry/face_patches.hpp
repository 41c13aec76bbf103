// The boundary faces of a mesh as Bezier patches: a simplex is one. Where there are quadrilaterals all patches have
// twice the degree of the mesh, and a quadrilateral is two triangles along a diagonal, exactly (sub_simplices.hpp).
// Patches are numbered face by face.
#pragma once
#include <vector>

#include "geometry/patch.hpp"
#include "mesh/mesh.hpp"
#include "mesh/sub_simplices.hpp"

namespace almesh {

struct FacePatches {
    const Mesh& mesh;
    PatchBasis basis;
    std::vector<SubSimplices> cuts;  // by group of faces
    std::vector<int> first;          // patch of each face, and the number of patches
    std::vector<int> face;           // of each patch

    explicit FacePatches(const Mesh& of) : FacePatches(of, of.groups_of_faces.empty() ? of.degree : 2 * of.degree) {}
    FacePatches(const Mesh& of, int degree);  // of a lower degree they interpolate the faces

    int count() const { return first.back(); }
    int part(int patch) const { return patch - first[face[patch]]; }  // which of its face's it is
    const SubSimplices& cut(int f) const { return cuts[mesh.face_group_number(f)]; }
    int corner(int patch, int v) const {  // node of the mesh
        return mesh.face(face[patch])[cut(face[patch]).vertices[part(patch)][v]];
    }

    // Those of a face, by the positions of its nodes; all, x: node_count x dim positions.
    std::vector<Patch> of(int f, const std::vector<Vec<3>>& nodes) const;
    std::vector<Patch> of(int f, const std::vector<double>& x) const;

    // Numbers of the nodes of the patches of these faces, in the basis' order: those of the mesh where they are its
    // own; else new ones between the corners, which patches that meet there share.
    std::vector<std::vector<int>> nodes_of(const std::vector<int>& faces) const;
};

constexpr double flat_fold = 1e-6;  // radians

// The least angle, in radians, between the directions in which two patches, which are of neighbouring faces, leave what
// they share, and whether g leaves it on the side to which the normal of f points.
struct Fold {
    double angle = 4;
    bool is_in_front = false;

    bool is_flat() const { return angle < flat_fold; }  // they lie on each other
};

// place: of each node; those with the same one are shared as if they were one node. Empty: each has its own.
Fold fold_of(const FacePatches& faces, const std::vector<Patch>& patches, int f, int g, const std::vector<int>& place);

// How often the patches of a closed surface go around each point: 0 for points outside their box.
std::vector<double> windings(const Bernstein& basis, const std::vector<Patch>& patches,
                             const std::vector<Vec<3>>& points);

// Outward unit normal of the flat face with the same vertices.
Vec<3> unit_normal(const Mesh& mesh, const std::vector<double>& x, int f);
inline Vec<3> unit_normal(const Mesh& mesh, int f) { return unit_normal(mesh, mesh.x, f); }

// The boundary in smooth parts, for meshes whose file names none. Per face: the number of its part, from 1, in the
// order of their first faces. Neighbouring outer faces are in one part where their normals are at most feature_angle
// degrees apart. Inner faces: 0. Cost: O(faces log faces).
std::vector<int> smooth_parts(const Mesh& mesh, double feature_angle);

}  // namespace almesh
