// Exercises of lesson 6. Answers go into 06.cpp; `make check-lesson-06` says which hold.
#pragma once
#include <functional>

#include "base/small_matrix.hpp"

namespace almesh::lessons {

// 6.1 Two springs in a row, as the inside of a mesh and its boundary: one of stiffness k_1 > 0 from 0 to the point y,
// one of stiffness k_2 > 0 from y to x. A penalty mu >= 0 wants x at g. The x at which 1/2 k_1 y^2 + 1/2 k_2 (x - y)^2
// + mu/2 (x - g)^2 is smallest, y being free.
double penalised_place(double k_1, double k_2, double g, double mu);

// 6.2 A single spring, of stiffness kappa > 0: the smallest mu >= 0 for which the x of the smallest
// 1/2 kappa x^2 + mu/2 (x - g)^2 is no farther than `tolerance` from g.
double penalty_for(double kappa, double g, double tolerance);

// 6.3 A quantity q that depends on mu like q = q_infinity + a / mu has been computed for two penalties. Returns
// q_infinity.
double without_penalty_error(double mu_1, double q_1, double mu_2, double q_2);

// 6.4 The condition number, largest over smallest eigenvalue, of K + mu a a' with K symmetric positive definite;
// to six digits for mu = 1e15, too.
double condition_with_penalty(const Mat<2>& K, const Vec<2>& a, double mu);

// 6.6 A minimum of f + mu/2 c^2 in two unknowns, c any smooth function, for mu from 1 to 1e18: Newton's method with
// full steps for x and for the force y = mu c as an unknown of its own, from the given x and the y for which
// |f' + y c'| is the least there. Ends where f' + y c' and c - y/mu have no entry above 1e-10. f2 is called once in
// each step.
struct Constrained {
    std::function<Vec<2>(const Vec<2>& x)> f1;  // f'
    std::function<Mat<2>(const Vec<2>& x)> f2;  // f''
    std::function<double(const Vec<2>& x)> c;
    std::function<Vec<2>(const Vec<2>& x)> c1;  // c'
    std::function<Mat<2>(const Vec<2>& x)> c2;  // c''
};
struct Penalised {
    Vec<2> x;
    double force;
};
Penalised penalised_minimum(const Constrained& problem, double mu, Vec<2> x);

}  // namespace almesh::lessons
