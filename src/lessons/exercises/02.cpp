// Answers to the exercises of lesson 2: change the lines marked ANSWER.
#include "lessons/exercises/02.hpp"

#include <cmath>

namespace almesh::lessons {

double observed_order(const std::function<double(double)>& /*f*/, double /*slope*/, double /*h*/) {
    return 0;  // ANSWER 2.1
}

Mat<2> eta_gradient_2d(const Mat<2>& /*F*/) {
    return {};  // ANSWER 2.2
}

Mat<2> gradient_by_ideal(const Mat<2>& /*A*/, const Mat<2>& /*B*/) {
    return {};  // ANSWER 2.2
}

Mat<3> eta_gradient_3d(const Mat<3>& /*F*/) {
    return {};  // ANSWER 2.3
}

Mat<3> sized_gradient_3d(const Mat<3>& /*F*/) {
    return {};  // ANSWER 2.3
}

Mat<2> eta_second_2d(const Mat<2>& /*F*/, const Mat<2>& /*H*/) {
    return {};  // ANSWER 2.4
}

Mat<2> falling_curvature(const Mat<2>& /*F*/) {
    return {};  // ANSWER 2.4
}

Mat<2> second_of_deviation(double /*eta*/, const Mat<2>& /*eta_F*/, const Mat<2>& /*eta_FF_H*/, const Mat<2>& /*H*/) {
    return {};  // ANSWER 2.5
}

double fourth_order(const Mat<2>& /*H*/) {
    return 0;  // ANSWER 2.5
}

Hyper product(const Hyper& /*a*/, const Hyper& /*b*/) {
    return {};  // ANSWER 2.6
}

Hyper quotient(const Hyper& /*a*/, const Hyper& /*b*/) {
    return {};  // ANSWER 2.6
}

Hyper root(const Hyper& /*a*/) {
    return {};  // ANSWER 2.6
}

Hyper eta_delta(const Mat<2>& /*F*/, const Mat<2>& /*H*/, const Mat<2>& /*K*/, double /*delta*/) {
    return {};  // ANSWER 2.6
}

}  // namespace almesh::lessons
