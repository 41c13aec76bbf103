// The nodes that slide, and how far they are from their surfaces (sliding_boundary.hpp).
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "constraint/constraint.hpp"

namespace almesh {

struct BoundaryTarget;
struct Mesh;
class SlidingSurfaces;

inline Vec<3> in_space(const double* x, int dim) {  // dim coordinates, in 2D with a third of 0
    Vec<3> result{};
    std::copy_n(x, dim, result.begin());
    return result;
}

// Of a field v, nodes x dim.
inline Vec<3> at_node(const std::vector<double>& v, int node, int dim) { return in_space(point(v, node, dim), dim); }
inline void set_node(std::vector<double>& v, int node, int dim, const Vec<3>& value) {
    std::copy_n(value.begin(), dim, point(v, node, dim));
}

// Per node of the mesh: the number of directions in which the constraint fixes it, from 0 (free) to dim (fixed). Empty
// if x does not satisfy the constraint.
std::vector<int> held_directions(Constraint& constraint, const std::vector<double>& x, int dim);

// The common point of the surfaces of the parts, by iteration from x.
Vec<3> on_surfaces(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x);

// The point at these signed distances from the surfaces, by Newton's method from x with their tangent planes.
Vec<3> at_distances(const SlidingSurfaces& sliding, const std::vector<int>& parts, Vec<3> x,
                    const std::array<double, 3>& distances);

// Signed distances of x + d, to first order in d.
std::array<double, 3> distances(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x,
                                const Vec<3>& d);

// The sum r of the vectors from the projections onto the surfaces of the parts to x: zero where x is on
// all of them, since their normals are linearly independent.
SurfaceDistance distance_to(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x);

// Sum over k of force_k times the second derivative of r_k: that of r = d n, n n' + d S, without the terms that vanish
// on the surface: (n . force) S + n (S force)' + (S force) n'.
Mat<3> second_derivative(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x,
                         const Vec<3>& force);

// Per entry of `nodes` (numbers in the mesh), the parts along which the node slides: none if it is prescribed, free or
// a corner. Nodes that the target frees slide. faces: face x face node, indices in `nodes`. g: positions of the nodes,
// n x dim; on return nodes that slide along another mesh are on its surface. fixed: on return per node, whether its
// position is prescribed. Throws InputError if a prescribed position is off the surface.
std::vector<std::vector<int>> sliding_parts(const Mesh& mesh, const BoundaryTarget& target,
                                            const SlidingSurfaces* sliding, const std::vector<int>& nodes,
                                            const std::vector<int>& faces, std::vector<double>& g,
                                            std::vector<char>& fixed);

}  // namespace almesh
