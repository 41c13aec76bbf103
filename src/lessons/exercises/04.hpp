// Exercises of lesson 4. Answers go into 04.cpp; `make check-lesson-04` says which hold.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "base/small_matrix.hpp"
#include "linalg/block_csr.hpp"

namespace almesh::lessons {

// 4.1 The order p at which sizes of the gradient in successive steps fall, size[k+1] = constant size[k]^p, from the
// last three of them.
double order_of_convergence(const std::vector<double>& size);

// 4.2 The smallest t > 0 at which the triangle with vertices x_i + t d_i has no area; infinite where there is none. The
// triangle x is counter-clockwise. All digits are wanted, also where the area is almost a linear function of t.
double first_inversion(const std::array<Vec<2>, 3>& x, const std::array<Vec<2>, 3>& d);

// 4.3 The positive semidefinite part of a symmetric 2 x 2 matrix: the same eigenvectors, negative eigenvalues set to 0.
Mat<2> positive_part(const Mat<2>& A);

// 4.4 Fixes nodes: changes the system H d = -g so that d is 0 at each node i with fixed[i] and solves the system of the
// other nodes for these, and so that H stays symmetric and does not become singular. g: (x_0, y_0, x_1, ...). H: row i
// has the blocks k = H.row[i] .. H.row[i+1] - 1, in columns H.col[k]; block k is H.block(k)[0 .. 3], row by row.
void fix_nodes(BlockCsr& H, std::vector<double>& g, const std::vector<char>& fixed);

// 4.5 Newton's method in one variable with all that is needed: from x, where f is finite, to |f'| <= 1e-7. Where
// f'' <= 0 take |f''| in its place (if that is 0: 1). Of the steps 1, 1/2, 1/4, ... times Newton's take the first that
// satisfies Armijo's condition with c1 = 1e-4; f may be infinite or nan. f1 and f2, the derivatives of f, must not be
// called where it is.
double minimise(const std::function<double(double)>& f, const std::function<double(double)>& f1,
                const std::function<double(double)>& f2, double x);

// 4.6 The eigenvalues of W_FF, W = f(eta), in 2D, det F > 0, from the singular values of F; f1 >= 0 and f2 >= 0 are f'
// and f'' at eta(F). Order: that of the twist, of the flip, the smaller and the larger one of the two stretches.
std::array<double, 4> curvatures(const Mat<2>& F, double f1, double f2);

// 4.6, too: W_FF without its negative eigenvalues. Rows and columns in the order F_11, F_12, F_21, F_22.
std::array<std::array<double, 4>, 4> projected_second(const Mat<2>& F, double f1, double f2);

}  // namespace almesh::lessons
