// Exercises of lesson 2. Answers go into 02.cpp; `make check-lesson-02` says which hold.
#pragma once
#include <functional>

#include "base/small_matrix.hpp"

namespace almesh::lessons {

// 2.1 The order at which the error of a first-order Taylor polynomial falls, from its errors at h and at h / 2:
//
//     error(h) = |f(h) - f(0) - h slope|
//
// It is 2 where slope = f'(0), and 1 where it is not.
double observed_order(const std::function<double(double)>& f, double slope, double h);

// 2.2 eta_F in 2D, for det F > 0.
Mat<2> eta_gradient_2d(const Mat<2>& F);

// 2.2, too: the gradient of eta(B A^-1) by the entries of A: the physical triangle, with the edges B, stays, and the
// ideal one changes. det A > 0, det B > 0.
Mat<2> gradient_by_ideal(const Mat<2>& A, const Mat<2>& B);

// 2.3 eta_F in 3D. `cofactor` of base/small_matrix.hpp is dD/dF there too.
Mat<3> eta_gradient_3d(const Mat<3>& F);

// 2.3, too: the gradient of eta (D + 1/D) / 2, which is not blind to size: it is least, 1, for rotations alone.
Mat<3> sized_gradient_3d(const Mat<3>& F);

// 2.4 eta_FF H in 2D: the derivative of eta_F along H.
Mat<2> eta_second_2d(const Mat<2>& F, const Mat<2>& H);

// 2.4, too: a direction H, not zero, with H : eta_FF H < 0, for any F with eta > 1.
Mat<2> falling_curvature(const Mat<2>& F);

// 2.5 The derivative of W_F along H for W = (eta - 1)^2, Eq. 5, from eta, eta_F and eta_FF H.
Mat<2> second_of_deviation(double eta, const Mat<2>& eta_F, const Mat<2>& eta_FF_H, const Mat<2>& H);

// 2.5, too: at the identity it vanishes. The c with (eta(I + h H) - 1)^2 = c h^4 + O(h^5).
double fourth_order(const Mat<2>& H);

// 2.6 Derivatives without a formula for them. Numbers value + one e1 + two e2 + both e1 e2, in which e1 e1 = e2 e2 = 0
// and e1 e2 = e2 e1 is not: their product, quotient and square root (of value > 0).
struct Hyper {
    double value = 0, one = 0, two = 0, both = 0;
};
Hyper product(const Hyper& a, const Hyper& b);
Hyper quotient(const Hyper& a, const Hyper& b);
Hyper root(const Hyper& a);

// 2.6, too: eta_delta (Eqs. 2 and 3, n = 2) of F + e1 H + e2 K, calculated in these numbers. Its parts are eta_delta,
// the slopes along H and along K, and H : eta_FF K: all to ten digits, also where det F < 0 and delta is small.
Hyper eta_delta(const Mat<2>& F, const Mat<2>& H, const Mat<2>& K, double delta);

}  // namespace almesh::lessons
