// The least scaled Jacobian at corners: raised to the best there is where that is known, never lowered.
#include "problem/corner_smoothing.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "check/scaled_jacobian.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

CornerSmoothing smoothed(Mesh& mesh, const std::vector<double>& ideal) {
    std::vector<char> fixed(mesh.nodes(), 0);
    for (const int i : mesh.faces) fixed[i] = 1;
    const auto energy = make_energy(mesh, ideal, {});
    return smooth_corners(mesh, fixed, *energy, {}, mesh.x);
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

TEST_CASE("a node goes to the middle of a regular polygon and of an octahedron, where the least corner is the best") {
    for (Mesh mesh : {fan(6, 0.5, 0.2), fan(5, -0.3, 0.4), octahedron({0.3, -0.2, 0.25})}) {
        CAPTURE(mesh.elements_text());
        const double before = least_corner_jacobian(mesh, mesh.x);
        const CornerSmoothing found = smoothed(mesh, mesh.x);
        CHECK(found.before == before);
        CHECK(found.after == least_corner_jacobian(mesh, mesh.x));
        CHECK(found.newton_steps > 0);
        for (int a = 0; a < mesh.dim; ++a) CHECK(std::abs(mesh.x[a]) < 0.01);
    }
}

TEST_CASE("the worst corner of meshes with nodes at random gets better, and what is fixed stays") {
    for (const Mesh& regular : {square_mesh(8), cube_mesh(4)}) {
        Mesh mesh = regular;
        std::vector<char> fixed(mesh.nodes(), 0);
        for (const int i : mesh.faces) fixed[i] = 1;
        std::mt19937 random(5);
        std::uniform_real_distribution<double> number(-0.25, 0.25);
        for (int i = 0; i < mesh.nodes(); ++i)
            for (int a = 0; a < mesh.dim && !fixed[i]; ++a)
                point(mesh.x, i, mesh.dim)[a] += number(random) / (mesh.dim == 2 ? 8 : 4);
        const double before = least_corner_jacobian(mesh, mesh.x);
        REQUIRE(before > 0);
        const CornerSmoothing found = smoothed(mesh, mesh.x);
        CHECK(found.after > 1.5 * before);
        CHECK(least_corner_jacobian(mesh, mesh.x) >= before);
        for (int i = 0; i < mesh.nodes(); ++i)
            for (int a = 0; a < mesh.dim && fixed[i]; ++a)
                CHECK(point(mesh.x, i, mesh.dim)[a] == point(regular.x, i, mesh.dim)[a]);
    }
}

TEST_CASE("nothing moves where no corner can be better, and where an element is inverted") {
    for (Mesh mesh : {fan(6, 0, 0), fan(6, 1.5, 0)}) {
        const std::vector<double> x = mesh.x;
        const CornerSmoothing found = smoothed(mesh, fan(6, 0, 0).x);
        CHECK(found.after == found.before);
        CHECK(mesh.x == x);
    }
}

namespace {

// Of inputs/meshes/NAME.msh, improved.
double least_after(const std::string& name, std::vector<std::string> settings, std::string& out) {
    const TemporaryFolder folder;
    settings.insert(settings.begin(), {"improve", "inputs/meshes/" + name + ".msh", "output=" + folder.path("results"),
                                       "objective=minimax", "threads=1"});
    const Outcome outcome = almesh_with(settings);
    CHECK(outcome.code == 0);
    out = outcome.out;
    const Mesh mesh = mesh_of(folder.path("results/final.msh"));
    return least_corner_jacobian(mesh, mesh.x);
}

}  // namespace

TEST_CASE("minimax takes the power with the larger least scaled Jacobian: in tetrahedra a low one, in triangles not") {
    std::string out;
    for (const char* name : {"cube", "circle"}) {
        const bool is_solid = name == std::string("cube");
        const double low = least_after(name, {"power=8"}, out), high = least_after(name, {"power=64"}, out);
        CHECK((low > high) == is_solid);
        CHECK(!has(out, "with power = 8"));
        CHECK(least_after(name, {}, out) >= std::max(low, high));  // corners are raised after it
        CHECK(has(out, "least scaled Jacobian: " + rounded_down(low, 4) + " with power = 8, " + rounded_down(high, 4) +
                           " with all powers\n"));
    }
}
