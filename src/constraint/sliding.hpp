// Along what the boundaries slide whose motion ends in `slide`.
//
// A boundary is cut into smooth parts: first where faces meet at more than 60 degrees, and each part that is a plane,
// sphere, cylinder or torus (2D: a line or circle) stays one; the others are cut again at the feature angle, and what
// is then no such surface slides along its own faces. The surfaces are those of the mesh as read, where the motion
// takes it: a refined mesh slides along the same ones.
#pragma once
#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "constraint/surface.hpp"
#include "geometry/closest_point.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

class SlidingSurfaces {
public:
    // node: face x face node x dim, where the motions take the faces of `base`. slides: per boundary. feature_angle in
    // degrees. unit: of the positions given to foot() and part(), in units of `node`.
    SlidingSurfaces(const Mesh& base, const std::vector<double>& node, const std::vector<char>& slides,
                    double feature_angle, double unit);

    int parts() const { return static_cast<int>(surface_.size()); }
    int boundary(int part) const { return boundary_[part]; }
    const Surface& surface(int part) const { return *surface_[part]; }

    double unit() const { return unit_; }
    bool knows(int boundary) const { return of_boundary_[boundary] != nullptr; }

    // The part of the boundary whose faces are nearest to x, both before the motion.
    int part(int boundary, const Vec<3>& x) const;

    SurfacePoint foot(int part, const Vec<3>& x) const;

    // Where the part is the mesh's own faces: a smooth patch around a node's place after the motion, along which it
    // slides instead, as a part of its own.
    void add_patch(int node, int part, const Vec<3>& place);

    // The patch of the node, or the part itself.
    int part_or_patch(int node, int part) const;

private:
    struct Points {
        std::vector<Vec<3>> position, normal;
    };

    int dim_;
    double unit_;
    std::vector<Points> points_;            // per part: of its nodes, where it is the mesh's own faces
    std::map<std::array<int, 2>, int> patch_;  // node, part -> part
    std::vector<std::unique_ptr<Surface>> surface_;
    std::vector<int> boundary_;                               // per part
    std::vector<std::unique_ptr<ClosestPoint>> of_boundary_;  // per boundary; none where it does not slide
    std::vector<std::vector<int>> part_of_;                   // boundary, its face -> part
};

}  // namespace almesh
