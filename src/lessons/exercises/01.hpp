// Exercises of lesson 1. Answers go into 01.cpp; `make check-lesson-01` says which hold.
#pragma once
#include <array>

#include "base/small_matrix.hpp"

namespace almesh::lessons {

using Triangle = std::array<Vec<2>, 3>;  // vertices, counter-clockwise

// 1.1 The Jacobian F of the affine map that takes the vertices of `ideal` to those of `physical`, one by one.
Mat<2> jacobian_of_map(const Triangle& ideal, const Triangle& physical);

// 1.2 eta of the map, Eq. 1 with n = 2: infinite where det F is not positive.
double eta_2d(const Mat<2>& F);

// 1.3 The same for tetrahedra, n = 3.
double eta_3d(const Mat<3>& F);

// 1.4 eta_delta, Eqs. 2 and 3, n = 2, finite for every F but 0. It must keep its digits where det F is negative and
// delta small: det = -1, delta = 1e-9 has sigma_delta = 1e-18, not 0.
double eta_regularised(const Mat<2>& F, double delta);

// 1.5 The ratio s of the singular values of a 2 x 2 matrix F (s >= 1) that has a given eta >= 1: how far a triangle of
// that distortion is stretched.
double stretch_of(double eta);

}  // namespace almesh::lessons
