// Answers to the exercises of lesson 9: change the lines marked ANSWER.
#include "lessons/exercises/09.hpp"

namespace almesh::lessons {

int edges_needed(double /*R*/, double /*tolerance*/) {
    return 0;  // ANSWER 9.1
}

std::array<double, 2> projection(double m_0, double m_1) {
    return {m_0, m_1};  // ANSWER 9.2
}

Quadratic bezier_coefficients(double at_start, double at_middle, double at_end) {
    return {at_start, at_middle, at_end};  // ANSWER 9.3
}

bool positive_everywhere(const Quadratic& b) {
    return b[0] > 0 && b[2] > 0;  // ANSWER 9.4
}

std::array<double, 6> jacobian_coefficients(const CurvedTriangle& /*x*/) {
    return {};  // ANSWER 9.6: the coefficients
}

bool proved_valid(const CurvedTriangle& /*x*/) {
    return true;  // ANSWER 9.6: the proof
}

}  // namespace almesh::lessons
