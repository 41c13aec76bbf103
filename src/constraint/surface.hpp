// Surfaces (3D) and curves (2D) along which the nodes of a boundary slide: planes, spheres, cylinders, tori and other
// quadrics, lines, circles and other conics, exactly; or the faces of a mesh, flat ones rounded. In 2D the third
// coordinate is 0 everywhere.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/small_matrix.hpp"
#include "geometry/patch.hpp"

namespace almesh {

// The closest-point projection p of x onto a surface, with d the signed distance, x = p + d n. x is on the surface
// where p = x.
struct SurfacePoint {
    Vec<3> position, normal;  // p; the unit normal n there, of either side
    Mat<3> slope{};           // derivative of x - p with respect to x: n n' + d S
    Mat<3> curvature{};       // S, the second derivative of d at x
};

class Surface {
public:
    virtual ~Surface() = default;

    // At the centre of a sphere, on the axis of a cylinder: any closest point.
    virtual SurfacePoint closest(const Vec<3>& x) const = 0;
    virtual std::string name() const = 0;  // "plane", "circle of radius 2"
};

// The first of plane, sphere, cylinder, torus, quadric (2D: line, circle, conic) on which all points lie, to
// `tolerance` times the extent of the points; null where there is none, or where the points are too few to tell.
// normal: of a plane through them if there is one, any length. Cylinder and torus by the Levenberg-Marquardt method.
std::unique_ptr<Surface> fit_surface(int dim, const std::vector<Vec<3>>& points, const Vec<3>& normal,
                                     double tolerance = 1e-8);

// Faces, flat ones as cubics through the same corners, with normals interpolated from means at their nodes. These are
// continuous where faces meet at an angle, and so is the closest-point projection: p in that face at whose p the
// normal points to x. node: numbers of the nodes of each patch, as in the basis' order.
std::unique_ptr<Surface> surface_of_faces(const PatchBasis& basis, const std::vector<Patch>& patches,
                                          const std::vector<std::vector<int>>& node);

}  // namespace almesh
