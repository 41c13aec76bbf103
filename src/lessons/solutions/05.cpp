// Solutions of the exercises of lesson 5.
#include "lessons/exercises/05.hpp"

#include <cmath>

namespace almesh::lessons {

Mat<3> laplacian_of_triangle(const std::array<Vec<2>, 3>& vertex) {
    // The edge opposite to vertex i, turned by 90 degrees, is 2 |e| grad N_i.
    Vec<2> edge[3];
    for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 2; ++a) edge[i][a] = vertex[(i + 2) % 3][a] - vertex[(i + 1) % 3][a];
    const double area = (edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]) / 2;
    Mat<3> K{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) K[i][j] = (edge[i][0] * edge[j][0] + edge[i][1] * edge[j][1]) / (4 * area);
    return K;
}

double reach_of_translation(double r, double R) { return r * std::log(R / r); }

double determinant_of_profile(double theta, double slope) { return 1 + slope * (1 - std::cos(theta)); }

double determinant_at_circle(double theta, double R) {
    const double slope_at_1 = -2 * R * R / (R * R - 1);  // s(r) = (R^2 / r^2 - 1) / (R^2 - 1)
    return 1 + slope_at_1 * (1 - std::cos(theta));
}

}  // namespace almesh::lessons
