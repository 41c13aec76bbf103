#include "geometry/half_space.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

using namespace almesh;

namespace {

std::vector<Vec<3>> around(const Vec<3>& axis, double opening, int count, std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Vec<3>> vectors;
    while (static_cast<int>(vectors.size()) < count) {
        const Vec<3> v = {uniform(random), uniform(random), uniform(random)};
        if (dot(v, axis) > opening * std::sqrt(dot(v, v) * dot(axis, axis))) vectors.push_back(v);
    }
    return vectors;
}

}  // namespace

TEST_CASE("vectors in a half space are found to be there, however narrow the rest of it") {
    std::mt19937 random(5);
    for (const double opening : {0.5, 1e-2, 1e-4}) {
        const Vec<3> axis = {0.3, -0.5, 0.8};
        CHECK(are_in_half_space(around(axis, opening, 200, random), 0));
    }
    for (const double gap : {1e-3, 1e-8, 1e-14}) {
        CHECK(are_in_half_space({{1, 0, gap}, {-1, 1, gap}, {-1, -1, gap}}, 0));
        CHECK(are_in_half_space({{1, gap, 0}, {-1, gap, 0}}, 0));
        CHECK_FALSE(are_in_half_space({{1, 0, -gap}, {-1, 1, -gap}, {-1, -1, -gap}, {0, 0, 1}}, 0));
    }
}

TEST_CASE("vectors around zero are in no half space, nor those that leave less than the margin") {
    CHECK_FALSE(are_in_half_space({{1, 0, 0}, {-1, 0, 0}}, 0));
    CHECK_FALSE(are_in_half_space({{1, 0, 0}, {0, 1, 0}, {-1, -1, 0}}, 0));
    CHECK_FALSE(are_in_half_space({{0, 0, 0}, {1, 0, 0}}, 0));
    CHECK(are_in_half_space({{1, 0.1, 0}, {-1, 0.1, 0}}, 0.09));
    CHECK_FALSE(are_in_half_space({{1, 0.1, 0}, {-1, 0.1, 0}}, 0.11));
}

TEST_CASE("the half space of up to four vectors is that of the point of their hull nearest to zero") {
    const HalfSpace two = half_space_of({{1, 1, 0}, {-1, 1, 0}});
    CHECK(two.least == doctest::Approx(1));
    CHECK(two.d[1] == doctest::Approx(1));
    CHECK(two.support.size() == 2);
    const HalfSpace one = half_space_of({{0, 0, 3}, {1, 0, 5}, {-1, 1, 4}});
    CHECK(one.least == doctest::Approx(3));
    CHECK(one.support.size() == 1);
    CHECK(half_space_of({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 2, 2}}).least == doctest::Approx(1 / std::sqrt(3)));
    CHECK(half_space_of({{1, 0, 0}, {-1, 0, 0}}).least == 0);
}
