// Patches built in code for the tests of this folder.
#pragma once
#include <cmath>
#include <vector>

#include "geometry/patch.hpp"

namespace almesh::test {

// Patch of degree p through the points map(l), l the nodes of the reference face.
template <class Map>
Patch interpolated(const PatchBasis& basis, const Map& map) {
    std::vector<Vec<3>> nodes;
    for (const MultiIndex& a : basis.bernstein.index)
        nodes.push_back(map(1.0 * a[1] / basis.bernstein.degree, 1.0 * a[2] / basis.bernstein.degree));
    return make_patch(basis, nodes);
}

inline Patch segment(const PatchBasis& basis, Vec<3> a, Vec<3> b) {
    return interpolated(basis, [&](double t, double) {
        return Vec<3>{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0};
    });
}

inline Patch triangle(const PatchBasis& basis, Vec<3> a, Vec<3> b, Vec<3> c) {
    return interpolated(basis, [&](double s, double t) {
        Vec<3> x = a;
        for (int k = 0; k < 3; ++k) x[k] += s * (b[k] - a[k]) + t * (c[k] - a[k]);
        return x;
    });
}

// An arc of a circle of radius r from angle a to angle b.
inline Patch arc(const PatchBasis& basis, double r, double a, double b) {
    return interpolated(basis, [&](double t, double) {
        return Vec<3>{r * std::cos(a + t * (b - a)), r * std::sin(a + t * (b - a)), 0};
    });
}

}  // namespace almesh::test
