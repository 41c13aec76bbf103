#include "check/surface_distance.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr int around = 12;
constexpr double radius = 3;

// A ring with all nodes on circles: those between its vertices are moved outward, from chords to their arcs.
Mesh round_ring(int degree) {
    Mesh mesh = with_degree(ring_mesh(around, 2, radius), degree);
    mesh.x = mapped(mesh, [](double* p) {
        const double half = std::numbers::pi / around, angle = std::atan2(p[1], p[0]);
        const double stretch = std::cos(std::remainder(angle - half, 2 * half)) / std::cos(half);
        p[0] *= stretch, p[1] *= stretch;
    });
    return mesh;
}

SlidingSurfaces surfaces_of(const Mesh& mesh, const BoundaryTarget& target, const Frame& frame = {}) {
    return {mesh, target.node, std::vector<char>(mesh.boundaries.size(), 1), 30, frame};
}

}  // namespace

TEST_CASE("the distance of a polygon from its circle is the sagitta, in any unit") {
    Mesh mesh = ring_mesh(around, 2, radius);
    const double sagitta = radius * (1 - std::cos(std::numbers::pi / around));
    BoundaryTarget target = target_of(mesh, {{"inner", "slide"}, {"outer", "slide"}});
    CHECK(distance_from_surfaces(mesh, target, surfaces_of(mesh, target), mesh.x) == doctest::Approx(sagitta));
    const SlidingSurfaces in_units = surfaces_of(mesh, target, {.origin = {}, .length = 10});
    for (double& v : mesh.x) v /= 10;
    CHECK(distance_from_surfaces(mesh, target, in_units, mesh.x) == doctest::Approx(sagitta / 10));
}

TEST_CASE("of faces that slide or have a node that is released: not of others that are free or prescribed") {
    const Mesh mesh = ring_mesh(around, 2, radius);
    const double unit_sagitta = 1 - std::cos(std::numbers::pi / around);
    BoundaryTarget target = target_of(mesh, {{"inner", "slide"}, {"outer", "free"}});
    const SlidingSurfaces sliding = surfaces_of(mesh, target);
    CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) == doctest::Approx(unit_sagitta));
    target = target_of(mesh, {});
    CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) == 0);
    target.freed.assign(mesh.nodes(), 0);
    CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) == 0);
    target.freed[2 * around] = 1;  // on the outer circle
    CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) == doctest::Approx(radius * unit_sagitta));
}

TEST_CASE("the distance of curved faces falls with their degree, and that of one which leaves its circle is found") {
    std::vector<double> distances = {1, 1};
    for (int degree = 1; degree <= 6; ++degree) {
        Mesh mesh = round_ring(degree);
        const BoundaryTarget target = target_of(mesh, {{"inner", "slide"}, {"outer", "slide"}});
        const SlidingSurfaces sliding = surfaces_of(mesh, target);
        REQUIRE(sliding.parts() == 2);
        distances.push_back(distance_from_surfaces(mesh, target, sliding, mesh.x));
        CHECK(distances[degree + 1] < (degree > 2 ? 0.05 : 0.2) * distances[degree - 1]);
        if (degree != 5) continue;
        double* const node = point(mesh.x, mesh.face(0)[3], 2);  // within an edge
        node[0] *= 1.01, node[1] *= 1.01;
        CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) >= 0.01 * std::hypot(node[0], node[1]) / 1.02);
    }
    CHECK(distances.back() < 1e-7);
}

TEST_CASE("the largest slide is that of a released node from its target") {
    const Mesh mesh = ring_mesh(around, 2, radius);
    BoundaryTarget target = target_of(mesh, {{"inner", "translate 1 0"}});
    std::vector<double> x = at_target(mesh, target, mesh.x);
    CHECK(largest_slide(mesh, target, mesh.x) == 0);
    target.freed.assign(mesh.nodes(), 0);
    target.freed[0] = target.freed[3] = 1;
    CHECK(largest_slide(mesh, target, x) == 0);
    point(x, 0, 2)[0] += 0.3;
    point(x, 0, 2)[1] -= 0.4;
    point(x, 3, 2)[1] += 0.1;
    point(x, 5, 2)[1] += 2;  // this one is not freed
    CHECK(largest_slide(mesh, target, x) == doctest::Approx(0.5));
}
