#include "geometry/closest_point.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/patches.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the closest point is found from any start on a curve with one minimum") {
    const PatchBasis basis(1, 4);
    const Patch patch = arc(basis, 1, 0, 0.5);
    const FaceProjector projector(1, 4);
    std::vector<Vec<3>> control, work(2 * projector.count());
    for (int k = 0; k < projector.count(); ++k) control.push_back(patch[k]);
    for (double start : {0.0, 0.3, 1.0}) {
        const Vec<3> x = {1.2 * std::cos(0.2), 1.2 * std::sin(0.2), 0}, beyond = {1.1, -0.3, 0};
        CHECK(std::sqrt(projector.squared_distance(control.data(), x, {1 - start, start, 0}, work)) ==
              doctest::Approx(0.2).epsilon(1e-5));
        CHECK(std::sqrt(projector.squared_distance(control.data(), beyond, {1 - start, start, 0}, work)) ==
              doctest::Approx(std::hypot(0.1, 0.3)).epsilon(1e-14));
    }
}

TEST_CASE("on a triangle the closest point is inside, on a side or at a corner") {
    const PatchBasis basis(2, 3);
    const Patch patch = triangle(basis, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const FaceProjector projector(2, 3);
    std::vector<Vec<3>> control, work(2 * projector.count());
    for (int k = 0; k < projector.count(); ++k) control.push_back(patch[k]);
    const struct {
        Vec<3> x;
        double distance;
    } cases[] = {{{0.2, 0.3, -0.5}, 0.5},
                 {{0.4, -0.3, 0.4}, 0.5},
                 {{1, 1, 0}, std::sqrt(0.5)},
                 {{-3, -4, 0}, 5},
                 {{2, -0.5, 0}, std::hypot(1, 0.5)},
                 {{0.25, 0.25, 0}, 0}};
    for (const auto& c : cases)
        for (const Barycentric& start : {Barycentric{1, 0, 0}, {0, 1, 0}, {0, 0.5, 0.5}, {0.3, 0.3, 0.4}}) {
            const double found = std::sqrt(projector.squared_distance(control.data(), c.x, start, work));
            CHECK(std::abs(found - c.distance) < 1e-14);
        }
}

TEST_CASE("a degenerate face is measured as far as it goes") {
    const PatchBasis basis(2, 1);
    const Patch flat = triangle(basis, {0, 0, 0}, {1, 0, 0}, {2, 0, 0});
    const FaceProjector projector(2, 1);
    const std::vector<Vec<3>> control = {flat[0], flat[1], flat[2]};
    std::vector<Vec<3>> work(2 * projector.count());
    const double squared = projector.squared_distance(control.data(), {1.5, 3, 0}, {0.4, 0.3, 0.3}, work);
    CHECK(squared == doctest::Approx(9));
}
