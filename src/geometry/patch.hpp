// One face of a mesh as a polynomial patch in Bezier form: a curve (m = 1 parameter) in the plane, a triangle (m = 2)
// in space. The patch lies in the convex hull of its Bezier points and has its corners among them.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "geometry/bezier.hpp"
#include "geometry/box_tree.hpp"

namespace almesh {

using Point = std::array<double, 3>;  // in 2D the third entry is 0

inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct PatchBasis {
    Bernstein bernstein;
    std::vector<double> to_bezier;  // count x count

    PatchBasis(int m, int degree);
};

struct Patch {
    std::vector<double> c;  // 3 x count: Bezier coefficients of x, then of y, then of z; the corners first

    int count() const { return static_cast<int>(c.size()) / 3; }
    double* component(int a) { return c.data() + a * count(); }
    const double* component(int a) const { return c.data() + a * count(); }
    Point point(int k) const { return {component(0)[k], component(1)[k], component(2)[k]}; }
};

// nodes: count x dim positions in Gmsh's order. Corner Bezier points are the nodes to the bit.
Patch make_patch(const PatchBasis& basis, const double* nodes, int dim);

Box box_of(const Patch& patch);

double size_of(const Patch& patch, int m);  // longest distance between two corners

// Corners a < b that are farthest apart.
std::array<int, 2> longest_side(const Patch& patch, int m);

// Derivative of the patch at corner i along its side towards corner j, divided by the degree.
Point side_tangent(const Bernstein& basis, const Patch& patch, int i, int j);

// The halves beside corner a (midpoint in place of corner b) and beside corner b.
std::pair<Patch, Patch> bisect(const Bernstein& basis, const Patch& patch, int a, int b);

// Largest distance of a Bezier point from its place on the flat patch with the same corners: no point of the patch is
// farther than this from the flat one.
double deviation(const Bernstein& basis, const Patch& patch);

}  // namespace almesh
