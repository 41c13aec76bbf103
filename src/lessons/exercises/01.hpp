// Exercises of lesson 1. Answers go into 01.cpp; `make check-lesson-01` says which hold.
#pragma once
#include <array>

#include "base/small_matrix.hpp"

namespace almesh::lessons {

using Lengths = std::array<double, 3>;  // of the edges of a triangle

// 1.1 eta of the affine map that takes the edges of one triangle to those of another, from their lengths alone: edge i
// becomes edge i, nothing is turned over. Infinite where the lengths of the physical one make no triangle.
double eta_of_lengths(const Lengths& ideal, const Lengths& physical);

// 1.2 The circle on which a vertex x has to be for the triangle (0, 0), (1, 0), x to have a given eta > 1, where the
// ideal triangle has x = apex, apex[1] > 0.
struct Circle {
    Vec<2> centre;
    double radius;
};
Circle level_set(const Vec<2>& apex, double eta);

// 1.3 eta of tetrahedra, Eq. 1 with n = 3: infinite where det F is not positive. All entries of F may be as small as
// 1e-150, or as large as 1e150.
double eta_3d(const Mat<3>& F);

// 1.4 eta_delta, Eqs. 2 and 3, n = 2, finite for every F if delta > 0. It must keep its digits where det F is
// negative and delta small: det = -1, delta = 1e-9 has sigma_delta = 1e-18, not 0. With delta = 0 it is eta of Eq. 1:
// infinite where det F is not positive, F = 0 included.
double eta_regularised(const Mat<2>& F, double delta);

// 1.5 The ratio s of the singular values of a 2 x 2 matrix F (s >= 1) that has a given eta >= 1: how far a triangle of
// that distortion is stretched.
double stretch_of(double eta);

// 1.6 eta of the affine map that takes the edges of one tetrahedron to those of another, from their lengths alone, and
// the largest singular value of its F over the smallest. Both infinite where the lengths of the physical one make no
// tetrahedron with a volume.
using SixLengths = std::array<double, 6>;  // of the edges 01, 02, 03, 12, 13, 23
struct Measured {
    double eta, stretch;
};
Measured measure_tetrahedron(const SixLengths& ideal, const SixLengths& physical);

// 1.6, too: the largest `stretch` that a tetrahedron of a given eta >= 1 can have.
double largest_stretch(double eta);

}  // namespace almesh::lessons
