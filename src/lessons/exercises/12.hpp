// Exercises of lesson 12. Answers go into 12.cpp and inputs/lessons/12-project/exercises/; `make check-lesson-12` says
// which hold.
#pragma once
#include "energy/densities.hpp"

namespace almesh::lessons {

// 12.1 f(eta) = (eta - 1)^3 + kappa (eta - 1)^2 with its first two derivatives.
struct CubicDensity {
    using Measure = Shape;
    double kappa;
    double f(double eta) const;
    double f1(double eta) const;
    double f2(double eta) const;
};

// 12.2 Another barrier than the lesson's: f = a + b / (M - eta) for eta < M, with those a and b for which f(1) = 0 and
// f'(1) = 1, and f infinite from M on; M > 1. With its first two derivatives, which count below M alone.
struct BarrierDensity {
    using Measure = Shape;
    double M;
    double f(double eta) const;
    double f1(double eta) const;
    double f2(double eta) const;
};

// 12.3 A valid start for a motion: the ring 1 <= |y| <= 21, of which the inner circle moves by (d, 0), |d| < 20, and
// the outer one stays. Returns where the point y goes. The map has to be continuous, with det > 0 everywhere.
Vec<2> blended(Vec<2> y, double d);

// 12.4 exercises/ellipse.deck: the inner circle x^2 + y^2 = 1 becomes the ellipse (x / 2)^2 + (2 y)^2 = 1; formulas.
// 12.5 exercises/table_row.deck: row 3 of Table 1.

}  // namespace almesh::lessons
