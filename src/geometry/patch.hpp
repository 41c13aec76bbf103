// Polynomial patches in Bezier form: curves (m = 1 parameter) in the plane, triangles (m = 2) and tetrahedra (m = 3) in
// space, and products of these; the faces and elements of a mesh. A patch lies in the convex hull of its Bezier points
// and has its corners among them (Farin, Curves and Surfaces for CAGD, 2002, ch. 5 and 17).
#pragma once
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/small_matrix.hpp"
#include "geometry/bezier.hpp"
#include "geometry/box_tree.hpp"

namespace almesh {

struct Mesh;

// Bezier points, those of simplices in Gmsh's order: the corners come first. In 2D the third coordinate is 0.
using Patch = std::vector<Vec<3>>;

struct PatchBasis {
    Bernstein bernstein;
    int nodes;
    double amplification = 0;  // infinity norm of bezier_of_lagrange()

    PatchBasis(int m, int degree) : PatchBasis(simplex(m), degree) {}
    PatchBasis(const CellType& cell, int degree);

    // The node that Bezier point b is, or -1, and the Bezier point that vertex v is, of a pyramid's apex one of them.
    int corner(int v) const {
        int b = 0;
        while (node(b) != v) ++b;
        return b;
    }
    int node(int b) const { return weights_[start_[b]].weight == 1 ? weights_[start_[b]].node : -1; }

    // Bezier point b of nodal values v(i), vectors of type T.
    template <class T, class Value>
    T point(int b, const Value& v) const {
        T sum{};
        for (int k = start_[b]; k < start_[b + 1]; ++k) {
            const T value = v(weights_[k].node);
            for (std::size_t a = 0; a < sum.size(); ++a) sum[a] += weights_[k].weight * value[a];
        }
        return sum;
    }

private:
    struct Weight {
        int node;
        double weight;
    };
    std::vector<int> start_;       // of each row of bezier_of_lagrange()
    std::vector<Weight> weights_;  // its entries that are not 0
};

// Positions of `count` nodes, from x: node_count x dim. In 2D the third coordinate is 0.
std::vector<Vec<3>> positions(const Mesh& mesh, const std::vector<double>& x, const int* nodes, int count);

// nodes: positions in Gmsh's order. Corner Bezier points are the nodes to the bit.
Patch make_patch(const PatchBasis& basis, const std::vector<Vec<3>>& nodes);

inline double length(const Vec<3>& v) { return std::sqrt(dot(v, v)); }
inline Vec<3> unit(const Vec<3>& v) { return length(v) > 0 ? 1 / length(v) * v : v; }

// Solid angle of the cone of three directions, positive where they are right-handed: 2 atan(u . (v x w) / (...)) (Van
// Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 1983).
double solid_angle(const Vec<3>& u, const Vec<3>& v, const Vec<3>& w);

// Normal of the flat patch with these corners, turned as that of PatchNormal: as long as the curve, or twice the area;
// of a face that begins with these corners, `vertices` of them: of a quadrilateral its mean.
inline Vec<3> flat_normal(std::span<const Vec<3>> corner, int m, int vertices = 0) {
    if (vertices == 4) return cross(corner[2] - corner[0], corner[3] - corner[1]);
    const Vec<3> u = corner[1] - corner[0];
    return m == 1 ? Vec<3>{u[1], -u[0], 0} : cross(u, corner[2] - corner[0]);
}

double size_of(const Patch& patch, int m);  // longest distance between two corners

// The Bezier point beside corner i on its edge towards corner j.
int next_to_corner(const Bernstein& basis, int i, int j);

// Derivative of the patch at corner i along its edge towards corner j, divided by the degree.
Vec<3> edge_tangent(const Bernstein& basis, const Patch& patch, int i, int j);

// The halves beside corner a (midpoint in place of corner b) and beside corner b.
std::pair<Patch, Patch> bisect(const Bernstein& basis, const Patch& patch, int a, int b);

// body(piece) of the pieces after so many bisections across the longest edges of a simplex.
template <class Body>
void for_pieces(const Bernstein& basis, const Patch& patch, int bisections, const Body& body) {
    if (bisections == 0) return body(patch);
    const auto [a, b] = longest_edge(patch, {basis.dim, 0, 0});
    const auto [first, second] = bisect(basis, patch, a, b);
    for_pieces(basis, first, bisections - 1, body);
    for_pieces(basis, second, bisections - 1, body);
}

// The edge with the longest control polygon, of a factor at the corners of the others: entries of multi-indices. By
// its chord, an edge that turns back on itself would be a short one: bisections of the others would leave it whole for
// ever.
struct CurvedEdge {
    int a = 0, b = 1;
    double length = 0;
};
CurvedEdge longest_curve(const Bernstein& basis, const Patch& patch);

// Whether the point is in a patch of as many parameters as the space has coordinates, up to rounding; in other ones
// than straight simplices up to 1e-9 of the size, and where 100000 bisections do not tell, yes.
bool holds(const Bernstein& basis, const Patch& patch, const Vec<3>& point);

// Largest distance of a Bezier point from its place on the flat patch with the same corners: no point of the patch is
// farther than this from the flat one.
double deviation(const Bernstein& basis, const Patch& patch);

// The normal of a patch as a polynomial of degree min(m, 2) (p - 1): dx/dxi_0 x dx/dxi_1, and for a curve
// dx/dxi_0 x e_z, which is the tangent turned clockwise by 90 degrees. Outward for the boundary faces of a mesh; its
// length is the measure of the face per measure of the reference face. Bezier coefficients are products of those of the
// derivatives, hence exact up to rounding.
struct PatchNormal {
    Bernstein basis;
    BezierProduct tangent_tangent;

    PatchNormal(int m, int degree);

    // Bezier coefficients of dx/dxi_k, or the constant e_z for k = m; and of the normal.
    std::vector<Vec<3>> tangent(const Patch& patch, int k) const;
    std::vector<Vec<3>> coefficients(const Patch& patch) const;

    // Signed area (m = 1) or volume (m = 2) of the cone from the apex to the patch, positive where the normal points
    // away from it: 1 / (m + 1) times the integral of (x - apex) . n. Over a closed surface the cones add up to what it
    // encloses.
    double cone(const Patch& patch, const Vec<3>& apex) const;

private:
    int m_, degree_;
    BezierProduct position_normal_;
    std::vector<int> raised_;  // raised_places(m, p - 1)
};

// What two faces, or two elements, have in common, up to a tolerance: faces cross where none of the directions of
// patch_contact.cpp has them on two sides, so that they touch at a shared corner or anywhere else, and where they
// overlap in a common plane. Undecided: so nearly touching along a curve that a few thousand bisections do not tell.
enum class Contact { apart, touching, crossing, undecided };

constexpr double touching_distance = 1e-9;  // in units of the edges of the smaller one, beside rounding

// What positions of the patch's size are rounded by, and those of the mesh by more than that, and the distance above.
double contact_tolerance(const Patch& a, const Patch& b, double rounding);

// corners_meet: they share some, and then it is only told whether they cross: touching counts as apart.
Contact patch_contact(const Bernstein& basis, const Patch& a, const Patch& b, double tolerance,
                      bool corners_meet = false);

// The widest gap between two patches along one of those directions, and that, of length 1; negative: an overlap.
std::pair<double, Vec<3>> widest_gap(const Patch& a, const Patch& b, int m);

// An element as a patch.
struct Solid {
    const CellType& cell;
    const PatchBasis& basis;
    Patch patch;
};

// Whether no point is inside both by more than the tolerance: touching counts as apart. That they cross is found of
// simplices alone; others that overlap are undecided. first: a direction that may have them on two sides.
Contact solid_contact(const Solid& a, const Solid& b, const Vec<3>& first, double tolerance);

}  // namespace almesh
