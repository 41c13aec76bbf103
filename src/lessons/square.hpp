// What lessons 3 and 4 work on: the unit square, vectors of its nodes (x_0, y_0, x_1, y_1, ...) and matrices of them.
#pragma once
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "io/mesh_format.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/vector_ops.hpp"
#include "mesh/build.hpp"

namespace almesh::lessons {

using Vector = std::vector<double>;

// 65 nodes and 104 triangles; every refinement cuts each triangle into four.
inline Mesh unit_square(int refinements) {
    std::vector<std::string> notes;
    return refine(build_mesh(read_mesh("inputs/meshes/square.msh"), notes), refinements);
}

// The nodes of it turned about the centre, each by the angle (in degrees) times a bump that is 0 on the boundary; bent:
// then sheared, more and more upwards, the boundary too.
inline Vector swirled(const Mesh& square, double angle, bool bent) {
    Vector x = square.x;
    for (std::size_t i = 0; i < x.size(); i += 2) {
        const double X = x[i] - 0.5, Y = x[i + 1] - 0.5, bump = (1 - 4 * X * X) * (1 - 4 * Y * Y);
        const double turn = angle * std::numbers::pi / 180 * bump * bump;
        x[i] = 0.5 + std::cos(turn) * X - std::sin(turn) * Y;
        x[i + 1] = 0.5 + std::sin(turn) * X + std::cos(turn) * Y;
        if (bent) x[i] += x[i + 1] * x[i + 1];
    }
    return x;
}

// u + s v.
inline Vector sum(const Vector& u, double s, const Vector& v) {
    Vector w = u;
    axpy(s, v, w);
    return w;
}

// J v: the vector of every node turned by 90 degrees.
inline Vector turned(const Vector& v) {
    Vector w(v.size());
    for (std::size_t i = 0; i < v.size(); i += 2) w[i] = -v[i + 1], w[i + 1] = v[i];
    return w;
}

inline Vector product(const BlockCsr& K, const Vector& v) {
    Vector Kv(v.size());
    multiply(K, v.data(), Kv.data());
    return Kv;
}

}  // namespace almesh::lessons
