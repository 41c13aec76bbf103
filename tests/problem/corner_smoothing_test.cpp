// The least scaled Jacobian at corners: raised to the best there is where that is known.
#include "problem/corner_smoothing.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "check/scaled_jacobian.hpp"
#include "constraint/sliding.hpp"
#include "constraint/sliding_boundary.hpp"
#include "constraint/sliding_nodes.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<char> nodes_inside(const Mesh& mesh) {
    std::vector<char> moves(mesh.nodes(), 1);
    for (const int i : mesh.faces) moves[i] = 0;
    return moves;
}

// The constraint of a mesh whose boundary has this motion.
struct Held {
    std::shared_ptr<SlidingSurfaces> sliding;
    std::unique_ptr<Constraint> constraint;

    explicit Held(const Mesh& mesh, const std::string& motion = "fixed") {
        const BoundaryTarget target = make_target(mesh, {mesh.boundaries.size(), parse_motion(motion)});
        if (motion == "slide")
            sliding = std::make_shared<SlidingSurfaces>(mesh, target.node, slides(mesh, target), 30, Frame());
        constraint = make_constraint(mesh, mesh.x, target, TargetKind::nodal, sliding);
    }
};

const PeriodicPairs no_pairs;

// Moves the nodes inside; returns the number of steps.
int smooth(Mesh& mesh, double size_change = 0) {
    const Held held(mesh);
    const std::vector<char> moves = nodes_inside(mesh);
    return smooth_corners({mesh, moves, *held.constraint, no_pairs, size_change, {}},
                          [](const auto&, auto&) { return true; }, mesh.x);
}

Mesh shaken(Mesh mesh, double by) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-by, by);
    const std::vector<char> moves = nodes_inside(mesh);
    for (int i = 0; i < mesh.nodes(); ++i)
        for (int a = 0; a < mesh.dim && moves[i]; ++a) point(mesh.x, i, mesh.dim)[a] += number(random);
    return mesh;
}

// Triangles around node 0, whose other nodes are on the unit circle.
Mesh fan(int count, double x, double y) {
    std::vector<double> at{x, y};
    std::vector<int> elements;
    for (int k = 0; k < count; ++k) {
        const double angle = 2 * std::numbers::pi * k / count;
        at.insert(at.end(), {std::cos(angle), std::sin(angle)});
        elements.insert(elements.end(), {0, k + 1, (k + 1) % count + 1});
    }
    return linear_mesh(2, at, elements, [](const double*) { return "rim"; });
}

// Tetrahedra around node 0, an octahedron without it.
Mesh octahedron(const Vec<3>& middle) {
    const std::vector<double> x{middle[0], middle[1], middle[2], 1, 0, 0, -1, 0, 0, 0, 1, 0,
                                0, -1, 0, 0, 0, 1, 0, 0, -1};
    std::vector<int> elements;
    for (const int a : {1, 2})
        for (const int b : {3, 4})
            for (const int c : {5, 6}) {
                const bool even = (a + b + c) % 2 == 1;
                elements.insert(elements.end(), {0, even ? a : b, even ? b : a, c});
            }
    return linear_mesh(3, x, elements, [](const double*) { return "rim"; });
}

}  // namespace

TEST_CASE("the gradient of E_k is that of its values, of all cells, with sizes and with nodes that slide") {
    for (const Mesh& regular : {square_mesh(4), mixed_mesh(4), cube_mesh(3), solid_mesh(3, "hdu"), solid_mesh(3, "ppp")}) {
        CAPTURE(regular.elements_text());
        const Mesh mesh = shaken(regular, 0.05);
        for (const char* motion : {"fixed", "slide"}) {
            const Held held(mesh, motion);
            const std::vector<int> directions = held_directions(*held.constraint, mesh.x, mesh.dim);
            std::vector<char> moves = nodes_inside(mesh);
            for (const int i : mesh.faces) moves[i] = directions[i] < mesh.dim;
            const auto E = corner_function({mesh, moves, *held.constraint, no_pairs, 0.02, {}}, mesh.x, 20);
            std::mt19937 random(2);
            std::uniform_real_distribution<double> number(-1, 1);
            std::vector<double> d(mesh.x.size()), g(d.size()), z(d.size()), ignored(d.size());
            for (double& of : d) of = number(random);
            for (std::size_t k = 0; k < d.size(); ++k) z[k] = 0.02 * (moves[k / mesh.dim] ? d[k] : 0);
            E->value(z, g);
            for (std::size_t k = 0; k < d.size(); ++k) d[k] = g[k] != 0 ? d[k] : 0;  // in the surfaces
            double slope = 0;
            for (std::size_t k = 0; k < d.size(); ++k) slope += g[k] * d[k];
            const double h = 1e-6;
            std::vector<double> up = z, down = z;
            for (std::size_t k = 0; k < d.size(); ++k) up[k] += h * d[k], down[k] -= h * d[k];
            const double difference = (E->value(up, ignored) - E->value(down, ignored)) / (2 * h);
            CHECK(slope != 0);
            CHECK(std::abs(difference - slope) < 1e-6 * std::abs(slope) + 1e-9);
        }
    }
}

TEST_CASE("a node goes to the middle of a regular polygon and of an octahedron, where the least corner is the best") {
    for (Mesh mesh : {fan(6, 0.5, 0.2), fan(5, -0.3, 0.4), octahedron({0.3, -0.2, 0.25})}) {
        CAPTURE(mesh.elements_text());
        CHECK(smooth(mesh) > 0);
        for (int a = 0; a < mesh.dim; ++a) CHECK(std::abs(mesh.x[a]) < 0.01);
    }
}

TEST_CASE("the worst corner of meshes with nodes at random gets better, of all cells, and what is fixed stays") {
    for (const Mesh& regular : {square_mesh(8), quad_mesh(8), mixed_mesh(6), cube_mesh(4), solid_mesh(4, "hhhh"),
                                solid_mesh(4, "pppp"), solid_mesh(4, "hduh")}) {
        CAPTURE(regular.elements_text());
        Mesh mesh = shaken(regular, 0.2 / (regular.dim == 2 ? 8 : 4));
        const double before = least_corner_jacobian(mesh, mesh.x);
        REQUIRE(before > 0);
        CHECK(smooth(mesh) > 0);
        CHECK(least_corner_jacobian(mesh, mesh.x) > 0.99 * least_corner_jacobian(regular, regular.x));
        const std::vector<char> moves = nodes_inside(mesh);
        for (int i = 0; i < mesh.nodes(); ++i)
            for (int a = 0; a < mesh.dim && !moves[i]; ++a)
                CHECK(point(mesh.x, i, mesh.dim)[a] == point(regular.x, i, mesh.dim)[a]);
    }
}

TEST_CASE("sizes stay within their bound, and what is not taken leaves no trace") {
    const Mesh regular = quad_mesh(6);
    Mesh mesh = shaken(regular, 0.04), free = mesh;
    const std::vector<double> before = element_sizes(mesh, mesh.x);
    smooth(mesh, 0.05);
    smooth(free);
    double kept = 0, freed = 0;
    for (int e = 0; e < mesh.element_count(); ++e) {
        kept = std::max(kept, std::abs(std::log(element_sizes(mesh, mesh.x)[e] / before[e])));
        freed = std::max(freed, std::abs(std::log(element_sizes(free, free.x)[e] / before[e])));
    }
    CHECK(kept < 1.1 * std::log(1.05));
    CHECK(freed > 2 * kept);
    CHECK(least_corner_jacobian(mesh, mesh.x) > least_corner_jacobian(regular, shaken(regular, 0.04).x));
    Mesh refused = shaken(regular, 0.04);
    const std::vector<double> x = refused.x;
    const std::vector<char> moves = nodes_inside(refused);
    const Held held(refused);
    smooth_corners({refused, moves, *held.constraint, no_pairs, 0, {}}, [](const auto&, auto&) { return false; },
                   refused.x);
    CHECK(refused.x == x);
}

TEST_CASE("nodes slide along straight and curved boundaries, and stay on them") {
    for (const Mesh& mesh : {shaken(square_mesh(6), 0.02), shaken(solid_mesh(3, "hhh"), 0.03), shaken(ring_mesh(48, 3, 6), 0.05)}) {
        const Held held(mesh, "slide");
        std::vector<char> moves = nodes_inside(mesh);
        const std::vector<int> directions = held_directions(*held.constraint, mesh.x, mesh.dim);
        REQUIRE(!directions.empty());
        for (const int i : mesh.faces) moves[i] = directions[i] < mesh.dim;
        std::vector<double> x = mesh.x;
        smooth_corners({mesh, moves, *held.constraint, no_pairs, 0, {}}, [](const auto&, auto&) { return true; }, x);
        CHECK(least_corner_jacobian(mesh, x) > least_corner_jacobian(mesh, mesh.x));
        CHECK(held.constraint->max_error(x) < 1e-9);
        bool slid = false;
        for (const int i : mesh.faces) slid = slid || point(x, i, mesh.dim)[0] != point(mesh.x, i, mesh.dim)[0];
        CHECK(slid);
    }
}

TEST_CASE("nothing moves where no corner can be better; the bits are those of any number of threads") {
    Mesh best = fan(6, 0, 0);
    smooth(best);
    CHECK(best.x == fan(6, 0, 0).x);
    const auto positions = for_threads([] {
        Mesh mesh = shaken(solid_mesh(6, "hhhhhh"), 0.04);
        smooth(mesh);
        return mesh.x;
    });
    CHECK(positions[1] == positions[0]);
    CHECK(positions[2] == positions[0]);
}
