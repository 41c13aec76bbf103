#include "geometry/patch.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/patches.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("corners are kept to the bit, halves join, and the hull encloses") {
    const PatchBasis basis(1, 4);
    const Patch patch = arc(basis, 1, 0.1, 0.7);
    CHECK(patch[0][0] == std::cos(0.1));
    const auto [near, far] = bisect(basis.bernstein, patch, 0, 1);
    CHECK(near[0] == patch[0]);
    CHECK(far[1] == patch[1]);
    CHECK(near[1] == far[0]);
    CHECK(std::abs(std::hypot(near[1][0], near[1][1]) - 1) < 1e-4);
    CHECK(size_of(patch, 1) == doctest::Approx(2 * std::sin(0.3)));
    CHECK(deviation(basis.bernstein, patch) >= 1 - std::cos(0.3));
    CHECK(deviation(basis.bernstein, segment(basis, {0, 0, 0}, {1, 2, 0})) < 1e-15);
    CHECK(overlap(box_of(patch), box_of(near)));
}

TEST_CASE("normals point right of a curve and out of a counter-clockwise triangle; cones have their measure") {
    const PatchBasis line(1, 3), face(2, 3);
    const PatchNormal normal_2(1, 3), normal_3(2, 3);
    const auto n = normal_2.coefficients(segment(line, {0, 0, 0}, {2, 0, 0}));
    for (const Vec<3>& v : n) CHECK(v[1] == doctest::Approx(-2));
    CHECK(normal_2.cone(segment(line, {0, 0, 0}, {2, 0, 0}), {0, 1, 0}) == doctest::Approx(1));
    const Patch corner = triangle(face, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    CHECK(normal_3.cone(corner, {0, 0, 0}) == doctest::Approx(1.0 / 6));
    CHECK(normal_3.cone(corner, {1, 1, 1}) == doctest::Approx(-1.0 / 3));
    // A sector of the unit disc, up to the interpolation error of degree 3.
    CHECK(normal_2.cone(arc(line, 1, 0, 0.5), {0, 0, 0}) == doctest::Approx(0.25).epsilon(1e-4));
}
