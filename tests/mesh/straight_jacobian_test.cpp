#include "mesh/straight_jacobian.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("the columns are the edges from the first vertex") {
    const std::vector<double> plane = {9, 9, 1, 2, 4, 2, 2, 7}, space = {1, 1, 1, 3, 1, 1, 1, 4, 1, 1, 1, 5};
    const int triangle[] = {1, 2, 3}, tetrahedron[] = {0, 1, 2, 3};
    CHECK(straight_jacobian<2>(triangle, plane) == Mat<2>{{{3, 1}, {0, 5}}});
    CHECK(straight_jacobian<3>(tetrahedron, space) == Mat<3>{{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}});
}
