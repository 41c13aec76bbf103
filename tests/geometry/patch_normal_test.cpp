#include "geometry/patch_normal.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/patches.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("normals point right of a curve and out of a counter-clockwise triangle; cones have their measure") {
    const PatchBasis line(1, 3), face(2, 3);
    const PatchNormal normal_2(2, 3), normal_3(3, 3);
    const auto n = normal_2.coefficients(segment(line, {0, 0, 0}, {2, 0, 0}));
    for (double v : n[1]) CHECK(v == doctest::Approx(-2));
    CHECK(normal_2.cone(segment(line, {0, 0, 0}, {2, 0, 0}), {0, 1, 0}) == doctest::Approx(1));
    const Patch corner = triangle(face, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    CHECK(normal_3.cone(corner, {0, 0, 0}) == doctest::Approx(1.0 / 6));
    CHECK(normal_3.cone(corner, {1, 1, 1}) == doctest::Approx(-1.0 / 3));
    // A sector of the unit disc, up to the interpolation error of degree 3.
    CHECK(normal_2.cone(arc(line, 1, 0, 0.5), {0, 0, 0}) == doctest::Approx(0.25).epsilon(1e-4));
}
