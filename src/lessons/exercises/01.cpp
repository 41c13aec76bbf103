// Answers to the exercises of lesson 1: change the lines marked ANSWER.
#include "lessons/exercises/01.hpp"

#include <cmath>

namespace almesh::lessons {

Mat<2> jacobian_of_map(const Triangle& /*ideal*/, const Triangle& /*physical*/) {
    return {};  // ANSWER 1.1
}

double eta_2d(const Mat<2>& /*F*/) {
    return 0;  // ANSWER 1.2
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

}  // namespace almesh::lessons
