// Solutions of the exercises of lesson 12.
#include <cmath>

#include "lessons/exercises/12.hpp"

namespace almesh::lessons {

double CubicDensity::f(double eta) const { return (eta - 1) * (eta - 1) * (eta - 1 + kappa); }
double CubicDensity::f1(double eta) const { return (eta - 1) * (3 * (eta - 1) + 2 * kappa); }
double CubicDensity::f2(double eta) const { return 6 * (eta - 1) + 2 * kappa; }

// f' = b / (M - eta)^2, so b = (M - 1)^2 and a = -(M - 1).
double BarrierDensity::f(double eta) const { return eta < M ? (M - 1) * ((M - 1) / (M - eta) - 1) : INFINITY; }
double BarrierDensity::f1(double eta) const { return std::pow((M - 1) / (M - eta), 2); }
double BarrierDensity::f2(double eta) const { return 2 * std::pow((M - 1) / (M - eta), 2) / (M - eta); }

Vec<2> blended(Vec<2> y, double d) {
    return {y[0] + d * (21 - std::hypot(y[0], y[1])) / 20, y[1]};  // 1 + d/dx of the shift is at least 1 - |d| / 20
}

}  // namespace almesh::lessons
