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

inline Vec<3> times(const Mat<3>& A, const Vec<3>& v) { return {dot(A[0], v), dot(A[1], v), dot(A[2], v)}; }

double extent(const std::vector<Vec<3>>& points);  // the largest distance from the first of them

// The closest-point projection p of x onto a surface, with d the signed distance, x = p + d n. x is on the surface
// where p = x.
struct SurfacePoint {
    Vec<3> position, normal;  // p; the unit normal n there, to either side
    Mat<3> slope{};           // derivative of x - p with respect to x: n n' + d S
    Mat<3> curvature{};       // S, the second derivative of d at x
};

class Surface {
public:
    virtual ~Surface() = default;

    // At the centre of a sphere, on the axis of a cylinder: any closest point.
    virtual SurfacePoint closest(const Vec<3>& x) const = 0;
    virtual std::string name() const = 0;  // "plane", "circle of radius 2"
    virtual bool is_flat() const { return false; }  // a plane (2D: a line)
};

// The first of plane, sphere, cylinder, torus, quadric (2D: line, circle, conic) on which all points lie, to
// `tolerance` times the extent of the points; null where there is none, or where the points are too few to tell.
// normal: of a plane through them if there is one, any length. Cylinder and torus by the Levenberg-Marquardt method.
std::unique_ptr<Surface> fit_surface(int dim, const std::vector<Vec<3>>& points, const Vec<3>& normal,
                                     double tolerance = 1e-8);

// The quadric (2D: conic) through all points, an ellipsoid, cone, elliptic cylinder, paraboloid or hyperboloid, to
// `tolerance` times their extent; null where there is none, more than one, too few points to tell, or where the points
// come near a point at which it has no normal (an apex, a line where two planes meet). Its projections are the closest
// points of it, but for x beyond its centres of curvature.
std::unique_ptr<Surface> fit_quadric(int dim, const std::vector<Vec<3>>& points, double tolerance);

// The faces of a mesh, flat ones, if `rounds`, replaced by cubics through the same corners, with interpolated normals.
// These are continuous where faces meet at an angle, and so is the closest-point projection: p is the point whose
// interpolated normal points to x. node: per patch the numbers of its nodes, in the order of the basis.
std::unique_ptr<Surface> surface_of_faces(const PatchBasis& basis, const std::vector<Patch>& patches,
                                          const std::vector<std::vector<int>>& node, bool rounds = true);

// The projection p of x, with the unit normal n at p and S at x.
SurfacePoint projection_at(const Vec<3>& x, const Vec<3>& p, const Vec<3>& n, const Mat<3>& S);

// The same on a surface q = 0; g and H: gradient and second derivatives of q at p. With n = g / |g| and d the distance
// of x, the curvature is S = P H P / |g| at p, P = I - n n', and S (I + d S)^-1 at x, as long as x is well before the
// nearest centre of curvature.
SurfacePoint implicit_projection(const Vec<3>& x, const Vec<3>& p, const Vec<3>& g, const Mat<3>& H);

}  // namespace almesh
