#include "constraint/surface.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace almesh;

namespace {

// z = s^2 / 2 - s t / 4 + t^3 / 3 + s^4 / 5 over a plane through the centre, whose axes are across, along and normal.
const Vec<3> centre = {1, 2, -1}, across = {0.8, 0, -0.6}, along = {0, 1, 0}, normal = {0.6, 0, 0.8};

Vec<3> on_graph(double s, double t) {
    const double z = s * s / 2 - s * t / 4 + t * t * t / 3 + s * s * s * s / 5;
    return centre + s * across + t * along + z * normal;
}

Vec<3> normal_of_graph(double s, double t) {
    const Vec<3> n = normal - (s - t / 4 + 4 * s * s * s / 5) * across - (t * t - s / 4) * along;
    return 1 / length(n) * n;
}

std::vector<Vec<3>> grid(int half) {
    std::vector<Vec<3>> points;
    for (int i = -half; i <= half; ++i)
        for (int j = -half; j <= half; ++j) points.push_back(on_graph(0.2 * i, 0.2 * j));
    return points;
}

}  // namespace

TEST_CASE("a smooth patch through the points of a graph of degree 4 is the graph") {
    const auto patch = fit_height_patch(3, centre, normal, grid(3));
    REQUIRE(patch);
    for (const double s : {-0.3, 0.0, 0.25})
        for (const double t : {-0.2, 0.1})
            for (const double off : {0.0, 0.1, -0.05}) {
                const Vec<3> p = on_graph(s, t), n = normal_of_graph(s, t);
                const SurfacePoint projection = patch->closest(p + off * n);
                CHECK(length(projection.position - p) < 1e-11);
                CHECK(std::abs(dot(projection.normal, n)) > 1 - 1e-11);
            }
}

TEST_CASE("there is no smooth patch through few points, or through those of a line") {
    std::vector<Vec<3>> line;
    for (int i = -10; i <= 10; ++i) line.push_back(centre + 0.125 * i * along);
    CHECK(fit_height_patch(3, centre, normal, grid(1)));
    CHECK(!fit_height_patch(3, centre, normal, {on_graph(0.1, 0), on_graph(0, 0.1), on_graph(-0.1, 0.2)}));
    CHECK(!fit_height_patch(3, centre, normal, line));
    CHECK(!fit_height_patch(3, centre, normal, {centre}));
}
