// What holds a node that slides: the tangent planes of the surfaces of its parts (dirichlet.hpp).
#pragma once
#include <vector>

#include "constraint/sliding.hpp"
#include "constraint/target.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

Vec<3> in_space(const double* x, int dim);  // dim coordinates, in 2D with a third of 0

// The point at which the surfaces of the parts meet, from x: by Newton's method, one plane per surface.
Vec<3> on_surfaces(const SlidingSurfaces& sliding, const std::vector<int>& parts, Vec<3> x);

struct TangentPlanes {
    Vec<3> place;       // on all surfaces
    Mat<3> P{}, B{};    // projection onto the normals there; second-order term of the force
};

// At the point on the surfaces closest to x. force: on the node, (M lambda)_i / |1|.
TangentPlanes tangent_planes(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x,
                             const Vec<3>& force);

// The parts along which each of the nodes (numbers in the mesh) slides; none where its place is prescribed, where it is
// a corner, and where it is free. faces: face x face node, places in `nodes`. places: of the nodes, n x dim. P: n x dim
// x dim, the identity for nodes held to their places, else zero. Throws InputError where a prescribed place is off the
// surface.
std::vector<std::vector<int>> sliding_parts(const Mesh& mesh, const BoundaryTarget& target,
                                            const SlidingSurfaces* sliding, const std::vector<int>& nodes,
                                            const std::vector<int>& faces, const std::vector<double>& places,
                                            std::vector<double>& P);

}  // namespace almesh
