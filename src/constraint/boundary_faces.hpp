// The moved faces of some boundaries: how they are cut into smooth parts, and which surface each part is (sliding.hpp).
//
// Faces that share a side are joined unless their normals there differ by more than an angle. Faces of a tangled mesh
// may be turned over, or have no extent: then parts that are on one surface are joined whatever the angles are, but not
// the two sides of a slit away from them.
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "constraint/surface.hpp"
#include "geometry/face_patches.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

inline constexpr double surely_sharp = 60;  // degrees: no fair mesh resolves a round surface with faces at such angles

double angle(const Vec<3>& u, const Vec<3>& v);  // degrees

struct BoundaryFaces {
    const Mesh& mesh;
    FacePatches patches;
    FacePatches of_surface;                     // bilinear faces are rounded like flat ones: as two triangles
    std::vector<int> face;                      // numbers in the mesh
    std::vector<std::vector<Vec<3>>> position;  // of their nodes
    std::vector<std::vector<Vec<3>>> corner_normal;
    std::vector<char> tangled;  // per face: it is turned towards its own element, or has no extent
    std::vector<std::pair<int, int>> side;  // of faces, as places in `face`
    std::vector<double> side_angle;

    // node: face x face node x dim. chosen: per boundary.
    BoundaryFaces(const Mesh& mesh, const std::vector<double>& node, const std::vector<char>& chosen);

    // The patches of all faces, and of which each is one, as places in `face`.
    std::vector<Patch> all_patches(std::vector<int>& of_face) const;

    std::vector<Vec<3>> points(const std::vector<int>& faces) const;

    // `faces` joined across sides at angles up to `limit`, those that are tangled up to another one.
    std::vector<std::vector<int>> cut(const std::vector<int>& faces, double limit, double of_tangled = 0) const;

    // By the elementary entity of the file: the faces of a CAD model.
    std::vector<std::vector<int>> cut_by_entity(const std::vector<int>& faces) const;

    // The surface of fit_surface() on which the faces lie; null: there is none.
    std::unique_ptr<Surface> fitted(const std::vector<int>& faces) const;

    // The quadric's normals must not be across those of the faces, as for a cylinder through the ends of a prism.
    bool on_one_quadric(const std::vector<int>& faces) const;

    std::unique_ptr<Surface> own(const std::vector<int>& faces) const;  // the faces themselves

    bool is_tangled(const std::pair<int, int>& faces) const { return tangled[faces.first] || tangled[faces.second]; }
    bool has_edge(const std::vector<int>& faces, double limit) const;  // between two that are not tangled
    bool any_tangled(const std::vector<int>& faces) const;

private:
    Vec<3> flat_of(int k) const;  // the normal of the flat face with the same corners
    bool is_flat(const Vec<3>& normal, double size) const;
    bool is_tangled(int f) const;
    double angle_when_tangled(int f, int g, double angle) const;
    void find_sides();
    Vec<3> normal_at(int k, int node) const;
};

struct SurfaceOfFaces {
    std::unique_ptr<Surface> surface;
    std::vector<int> faces;
    bool of_mesh;  // the mesh's own faces
};

// feature_angle: in degrees.
std::vector<SurfaceOfFaces> surfaces_of(const BoundaryFaces& faces, double feature_angle);

}  // namespace almesh
