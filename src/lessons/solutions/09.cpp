// Solutions of the exercises of lesson 9.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lessons/exercises/09.hpp"

namespace almesh::lessons {

int edges_needed(double R, double tolerance) {
    return static_cast<int>(std::ceil(std::numbers::pi / std::acos(1 - tolerance / R)));  // R (1 - cos(pi / n))
}

std::array<double, 2> projection(double m_0, double m_1) {
    return {4 * m_0 - 2 * m_1, 4 * m_1 - 2 * m_0};  // the inverse of [1/3 1/6; 1/6 1/3]
}

Quadratic bezier_coefficients(double at_start, double at_middle, double at_end) {
    return {at_start, 2 * at_middle - 0.5 * (at_start + at_end), at_end};
}

bool positive_everywhere(const Quadratic& b) {
    if (std::min({b[0], b[1], b[2]}) > 0) return true;
    if (b[0] <= 0 || b[2] <= 0) return false;
    const double left = 0.5 * (b[0] + b[1]), right = 0.5 * (b[1] + b[2]), middle = 0.5 * (left + right);
    return positive_everywhere({b[0], left, middle}) && positive_everywhere({middle, right, b[2]});
}

}  // namespace almesh::lessons
