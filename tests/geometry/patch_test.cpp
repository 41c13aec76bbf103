#include "geometry/patch.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/patches.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("corners are kept to the bit, halves join, and the hull encloses") {
    const PatchBasis basis(1, 4);
    const Patch patch = arc(basis, 1, 0.1, 0.7);
    CHECK(patch.point(0)[0] == std::cos(0.1));
    const auto [near, far] = bisect(basis.bernstein, patch, 0, 1);
    CHECK(near.point(0) == patch.point(0));
    CHECK(far.point(1) == patch.point(1));
    CHECK(near.point(1) == far.point(0));
    CHECK(std::abs(std::hypot(near.point(1)[0], near.point(1)[1]) - 1) < 1e-4);
    CHECK(size_of(patch, 1) == doctest::Approx(2 * std::sin(0.3)));
    CHECK(deviation(basis.bernstein, patch) >= 1 - std::cos(0.3));
    CHECK(deviation(basis.bernstein, segment(basis, {0, 0, 0}, {1, 2, 0})) < 1e-15);
    CHECK(overlap(box_of(patch), box_of(near)));
}
