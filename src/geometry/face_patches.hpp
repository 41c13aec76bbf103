// The boundary faces of a mesh as Bezier patches: a simplex is one. Where there are quadrilaterals all patches have
// twice the degree of the mesh, and a quadrilateral is two triangles along a diagonal, exactly (sub_simplices.hpp).
// Patches are numbered face by face.
#pragma once
#include <vector>

#include "geometry/patch.hpp"
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

    // Numbers of the nodes of the patches of these faces, in the basis' order: those of the mesh where they are its own;
    // else new ones between the corners, which patches that meet there share.
    std::vector<std::vector<int>> nodes_of(const std::vector<int>& faces) const;
};

}  // namespace almesh
