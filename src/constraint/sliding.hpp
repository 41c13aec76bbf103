// The surfaces along which boundaries slide: those whose motion ends in `slide`.
//
// A boundary is cut into smooth parts: at angles above 60 degrees, then at the feature angle, then by the entities of
// the CAD model, until each part is a plane, sphere, cylinder, torus or other quadric (2D: a line or conic). A part
// that is none of these slides along its own faces. The surfaces are those of the mesh as read, moved by the motion, so
// that a refined mesh slides along the same ones. They may also be those of another mesh file: each face of the run's
// boundary then slides along the part nearest to the moved face.
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
    bool operator==(const OtherSurface&) const = default;
};

class SlidingSurfaces {
public:
    // node: face x face node x dim, the moved faces of `base`. slides and other: per boundary; other may be empty.
    // feature_angle in degrees. frame: takes the positions given to closest(), and the meshes given to part(), to the
    // frame of `node`.
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

    // The part along which face f of `mesh` slides. The mesh is `base`, of any degree and refined any number of times:
    // each face of the base is an equal number of consecutive faces of the mesh. With another mesh: the part of its
    // face that is nearest to the moved face f.
    int part(const Mesh& mesh, int f) const;

    SurfacePoint closest(int part, const Vec<3>& x) const;

private:
    // Of a boundary that slides.
    struct Faces {
        std::shared_ptr<ClosestPoint> before;    // their patches before the motion; null where there is no other mesh
        std::vector<int> face;                   // of each patch
        std::vector<std::vector<Vec<3>>> after;  // patch, node: after it
        std::shared_ptr<ClosestPoint> other;     // patches of another mesh; null where there is none
        std::vector<Vec<3>> other_normal;
        std::vector<int> other_face;
        std::vector<int> part;                   // of each face, of the other mesh where there is one
    };

    int dim_;
    std::vector<int> place_;  // per face of the base: its number within its boundary
    Frame frame_;
    LagrangeBasis basis_;                   // of the patches
    std::vector<std::shared_ptr<const Surface>> surface_;
    std::vector<int> boundary_;  // per part
    std::vector<Faces> faces_;   // per boundary
};

}  // namespace almesh
