#include "geometry/half_space.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
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

// tests/proofs.py compares them with exact arithmetic: ALMESH_CORNERS=FILE writes ALMESH_COUNT of them.
TEST_CASE("two triangles at a corner are told apart up to rounding, in nearly degenerate cases") {
    const char* const path = std::getenv("ALMESH_CORNERS");
    const char* const wanted = std::getenv("ALMESH_COUNT");
    std::FILE* const file = path ? std::fopen(path, "w") : nullptr;
    const int count = wanted ? std::atoi(wanted) : 20000;
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int apart = 0;
    for (int i = 0; i < count; ++i) {
        const double size = std::pow(10, 3 * uniform(random));
        const Vec<3> origin = {size * uniform(random), size * uniform(random), 10 * size * uniform(random)};
        const Vec<3> normal = {uniform(random), uniform(random), uniform(random)}, side = cross(normal, {1, 0.3, 0.1});
        const double up = uniform(random);
        Vec<3> corner[4];  // two of each triangle, all around in a plane, and off it by what is about rounding
        for (int k = 0; k < 4; ++k) {
            const double angle = 2.0944 * k + 0.4 * uniform(random), off = 1e-13 * size * (up + 0.7 * uniform(random));
            const Vec<3> away = size * (std::cos(angle) * side + std::sin(angle) * cross(normal, side)) + off * normal;
            corner[k] = k < 2 ? origin + away : origin - away;
        }
        double largest = 0;
        for (const Vec<3>& x : {origin, corner[0], corner[1], corner[2], corner[3]})
            for (const double a : x) largest = std::max(largest, std::abs(a));
        const bool is_apart = are_in_half_space({corner[0] - origin, corner[1] - origin, origin - corner[2],
                                                 origin - corner[3]}, 2e-14 * largest);
        apart += is_apart;
        if (!file) continue;
        std::fprintf(file, "%d", is_apart);
        for (const Vec<3>& x : {origin, corner[0], corner[1], corner[2], corner[3]})
            std::fprintf(file, " %a %a %a", x[0], x[1], x[2]);
        std::fprintf(file, "\n");
    }
    if (file) std::fclose(file);
    CHECK(apart > count / 10);
    CHECK(apart < count - count / 10);
}
