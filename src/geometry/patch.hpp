// One face of a mesh as a polynomial patch in Bezier form: a curve (m = 1 parameter) in the plane, a triangle (m = 2)
// in space. The patch lies in the convex hull of its Bezier points and has its corners among them (Farin, Curves and
// Surfaces for CAGD, 2002, ch. 5 and 17).
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "base/small_matrix.hpp"
#include "geometry/bezier.hpp"
#include "geometry/box_tree.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Bezier points in Gmsh's order: the corners come first. In 2D the third coordinate is 0.
using Patch = std::vector<Vec<3>>;

struct PatchBasis {
    Bernstein bernstein;
    std::vector<double> to_bezier;  // count x count

    PatchBasis(int m, int degree);
};

// face_nodes x dim positions of the nodes of face f, from x: node_count x dim.
std::vector<double> face_positions(const Mesh& mesh, const std::vector<double>& x, int f);

// nodes: count x dim positions in Gmsh's order. Corner Bezier points are the nodes to the bit.
Patch make_patch(const PatchBasis& basis, const double* nodes, int dim);

inline Box box_of(const Patch& patch) { return box_of_points(patch[0].data(), static_cast<int>(patch.size()), 3); }

std::array<int, 2> longest_side(const Patch& patch, int m);  // corners a < b that are farthest apart

double size_of(const Patch& patch, int m);  // longest distance between two corners

// Derivative of the patch at corner i along its side towards corner j, divided by the degree.
Vec<3> side_tangent(const Bernstein& basis, const Patch& patch, int i, int j);

// The halves beside corner a (midpoint in place of corner b) and beside corner b.
std::pair<Patch, Patch> bisect(const Bernstein& basis, const Patch& patch, int a, int b);

// Largest distance of a Bezier point from its place on the flat patch with the same corners: no point of the patch is
// farther than this from the flat one.
double deviation(const Bernstein& basis, const Patch& patch);

// The normal of a patch as a polynomial: dx/dxi turned clockwise by 90 degrees (2D), or dx/dxi_0 x dx/dxi_1 (3D).
// Outward for the boundary faces of a mesh; its length is the measure of the face per measure of the reference face.
// Bezier coefficients are products of those of the derivatives, hence exact up to rounding.
class PatchNormal {
public:
    PatchNormal(int dim, int degree);

    const Bernstein& basis() const { return normal_; }  // degree (dim - 1)(degree - 1)

    std::vector<Vec<3>> coefficients(const Patch& patch) const;  // basis().count Bezier coefficients

    // Signed area (2D) or volume of the cone from the apex to the patch, positive where the normal points away from it:
    // 1 / dim times the integral of (x - apex) . n. Over a closed surface the cones add up to what it encloses.
    double cone(const Patch& patch, const Vec<3>& apex) const;

private:
    int dim_;
    Bernstein position_, gradient_, normal_, integrand_;
    BezierProduct tangent_tangent_, position_normal_;
    std::vector<int> raised_;  // gradient_.count x dim
};

}  // namespace almesh
