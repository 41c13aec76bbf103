// Along what the boundaries slide whose motion ends in `slide`.
//
// A boundary is cut into smooth parts: first where faces meet at more than 60 degrees, and each part that is a plane,
// sphere, cylinder or torus (2D: a line or circle) stays one; the others are cut again at the feature angle, and what
// is then no such surface slides along its own faces. The surfaces are those of the mesh as read, where the motion
// takes it: a refined mesh slides along the same ones. They may also be those of another mesh, as its file has them:
// each face of the run's boundary then slides along the part nearest to where the motion takes it.
#pragma once
#include <array>
#include <map>
#include <memory>
#include <vector>

#include "base/frame.hpp"
#include "constraint/surface.hpp"
#include "geometry/closest_point.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {

struct Mesh;
struct MeshPart;

// A boundary of another mesh, along which one of the run slides.
struct OtherSurface {
    std::shared_ptr<const Mesh> mesh;  // null: its own
    std::vector<char> boundaries;  // per boundary of it
};

class SlidingSurfaces {
public:
    // node: face x face node x dim, where the motions take the faces of `base`. slides: per boundary, and so is
    // `other`, or empty. feature_angle in degrees. frame: of the positions given to closest() and of the meshes given
    // to part(), by those of `node`.
    SlidingSurfaces(const Mesh& base, const std::vector<double>& node, const std::vector<char>& slides,
                    double feature_angle, const Frame& frame, const std::vector<OtherSurface>& other = {});

    // Those of `whole` for a mesh that was cut out of its own. Faces at the cut slide along nothing. No boundary of the
    // whole slides along another mesh.
    SlidingSurfaces(const SlidingSurfaces& whole, const MeshPart& part, const Frame& frame);

    int parts() const { return static_cast<int>(surface_.size()); }
    int boundary(int part) const { return boundary_[part]; }
    const Surface& surface(int part) const { return *surface_[part]; }

    const Frame& frame() const { return frame_; }
    bool knows(int boundary) const { return !faces_[boundary].part.empty(); }
    bool is_of_other_mesh(int part) const { return faces_[boundary_[part]].other != nullptr; }

    // The part along which face f of the mesh slides: `base`, of any degree and refined any number of times, so that
    // each of its faces is as many of the mesh's, one after the other. In another mesh the part of the face that is
    // nearest to where the motion takes f.
    int part(const Mesh& mesh, int f) const;

    SurfacePoint closest(int part, const Vec<3>& x) const;

    // Where the part is the mesh's own faces: a smooth patch around a node's position after the motion, as the file's
    // numbers, along which it slides instead, as a part of its own.
    void add_patch(int node, int part, const Vec<3>& x);

    // The patch of the node, or the part itself.
    int part_or_patch(int node, int part) const;

private:
    struct Points {
        std::vector<Vec<3>> position, normal;
    };

    // Of a boundary that slides.
    struct Faces {
        std::unique_ptr<ClosestPoint> before;    // their patches before the motion; null where there is no other mesh
        std::vector<int> face;                   // of each patch
        std::vector<std::vector<Vec<3>>> after;  // patch, node: after it
        std::unique_ptr<ClosestPoint> other;     // patches of another mesh; null where there is none
        std::vector<Vec<3>> other_normal;
        std::vector<int> other_face;
        std::vector<int> part;                   // of each face, of the other mesh where there is one
    };

    int dim_;
    std::vector<int> place_;  // per face of the base: which of its boundary's it is
    Frame frame_;
    LagrangeBasis basis_;                   // of the patches
    std::vector<Points> points_;            // per part: of its nodes, where it is the mesh's own faces
    std::map<std::array<int, 2>, int> patch_;  // node, part -> part
    std::vector<std::shared_ptr<const Surface>> surface_;
    std::vector<int> boundary_;  // per part
    std::vector<Faces> faces_;   // per boundary
};

}  // namespace almesh
