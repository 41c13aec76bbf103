// Answers to the exercises of lesson 1: change the lines marked ANSWER.
#include "lessons/exercises/01.hpp"

#include <cmath>

namespace almesh::lessons {

double eta_of_lengths(const Lengths& /*ideal*/, const Lengths& /*physical*/) {
    return 0;  // ANSWER 1.1
}

Circle level_set(const Vec<2>& /*apex*/, double /*eta*/) {
    return {};  // ANSWER 1.2
}

double eta_3d(const Mat<3>& /*F*/) {
    return 0;  // ANSWER 1.3
}

double eta_regularised(const Mat<2>& /*F*/, double /*delta*/) {
    return 0;  // ANSWER 1.4
}

double stretch_of(double /*eta*/) {
    return 0;  // ANSWER 1.5
}

Measured measure_tetrahedron(const SixLengths& /*ideal*/, const SixLengths& /*physical*/) {
    return {0, 0};  // ANSWER 1.6
}

double largest_stretch(double /*eta*/) {
    return 0;  // ANSWER 1.6
}

}  // namespace almesh::lessons
