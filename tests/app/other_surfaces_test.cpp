#include "problem/node_targets.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support/high_order.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<int> nodes_of(const Mesh& mesh, const std::string& boundary) {
    std::vector<int> nodes;
    for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k)
        if (mesh.boundaries[mesh.face_boundary[k / mesh.face_nodes(0)]] == boundary) nodes.push_back(mesh.faces[k]);
    return nodes;
}

// A mesh of degree p, its points moved.
Mesh curved(const Mesh& linear, int degree, const std::function<void(double*)>& map) {
    Mesh mesh = with_degree(linear, degree);
    mesh.x = mapped(mesh, map);
    return mesh;
}

double egg_radius(double angle) { return 5 + 0.5 * std::cos(angle) + 0.3 * std::cos(3 * angle); }

// A ring of degree p whose outer part is that egg; its inner one is a circle.
Mesh egg(int around, int degree) {
    return curved(ring_mesh(around, 2, 6), degree, [around](double* x) {
        const double angle = std::atan2(x[1], x[0]), half = std::numbers::pi / around;
        const double from_vertex = angle + 2 * std::numbers::pi - 2 * half * std::floor(angle / (2 * half) + around);
        const double r = std::hypot(x[0], x[1]) * std::cos(from_vertex - half) / std::cos(half);  // of the circle
        const double egg = r * (1 + (r - 1) / 5 * (egg_radius(angle) / 6 - 1));
        x[0] = egg * std::cos(angle), x[1] = egg * std::sin(angle);
    });
}

double largest_distance_from_egg(const Mesh& mesh) {
    double largest = 0;
    for (const int i : nodes_of(mesh, "outer")) {
        const double *const x = point(mesh.x, i, 2), angle = std::atan2(x[1], x[0]);
        largest = std::max(largest, std::abs(std::hypot(x[0], x[1]) - egg_radius(angle)));
    }
    return largest;
}

// A disc of rings of 6, 12, ... cells; its boundary is "rim".
Mesh disc(int rings) {
    std::vector<double> x = {0, 0};
    std::vector<int> triangles;
    const auto node = [](int ring, int k) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + k % (6 * ring); };
    for (int ring = 1; ring <= rings; ++ring)
        for (int k = 0; k < 6 * ring; ++k) {
            const double angle = std::numbers::pi * k / (3 * ring), r = static_cast<double>(ring) / rings;
            x.insert(x.end(), {r * std::cos(angle), r * std::sin(angle)});
            const int sector = k / ring, inside = k - sector;  // of the ring below: the node before
            triangles.insert(triangles.end(), {node(ring, k), node(ring, k + 1), node(ring - 1, inside)});
            if (k % ring != ring - 1)
                triangles.insert(triangles.end(), {node(ring, k + 1), node(ring - 1, inside + 1), node(ring - 1, inside)});
        }
    return linear_mesh(2, x, triangles, [](const double*) { return "rim"; });
}

void peanut(double* x) {
    const double angle = std::atan2(x[1], x[0]), factor = 1 + 0.15 * std::cos(2 * angle) + 0.05 * std::sin(3 * angle);
    x[0] *= factor, x[1] *= factor;
}

void bump(double* x) { x[2] += 0.15 * (1 - x[2]) * std::sin(2 * x[0] + 0.5) * std::cos(3 * x[1]); }

}  // namespace

TEST_CASE("a coarse ring along the wall of a finer one, straight or curved, at any degree and refinement") {
    const RingDeck ring;
    ring.folder.write("fine.msh", msh_of(egg(80, 1)));
    ring.folder.write("curved.msh", msh_of(egg(20, 4)));
    for (const std::string other : {"fine.msh", "curved.msh"})
        for (const std::string setting : {"degree=1", "degree=3", "refine=1"}) {
            CAPTURE(other);
            CAPTURE(setting);
            const Outcome outcome = ring.run({"boundary inner=fixed", setting,
                                              "boundary outer=slide along " + ring.folder.path(other)});
            CAPTURE(outcome.error);
            CAPTURE(outcome.out);
            REQUIRE(outcome.code == 0);
            CHECK(has(outcome.out, other + ": the mesh's own faces"));
            CHECK(largest_distance_from_egg(mesh_of(ring.output + "/final.msh")) < 1e-3);
            CHECK(number(summary_of(ring.output), "newton_iterations") <= 20);
            CHECK(number(summary_of(ring.output), "surface_distance") < (setting == "degree=3" ? 0.05 : 0.4));
            REQUIRE(almesh_with({ring.output + "/deck.txt"}).code == 0);  // the file is found from there too
        }
    const Outcome scaled = ring.run({"boundary outer=scale 0.8; slide along " + ring.folder.path("fine.msh")});
    CHECK(scaled.code == 0);
}

TEST_CASE("a disc that nothing else holds slides onto a closed curve in some thirty steps, however many faces either has") {
    const TemporaryFolder folder;
    const auto steps = [&](int rings, int rings_of_other) {
        folder.write("disc.msh", msh_of(disc(rings)));
        folder.write("peanut.msh", msh_of(curved(disc(rings_of_other), 1, peanut)));
        const std::string output = folder.path("out");
        const std::string deck = folder.write("a.deck", "mesh = disc.msh\noutput = " + output +
                                                            "\nboundary rim = slide along peanut.msh\n");
        const Outcome outcome = almesh_with({deck});
        CAPTURE(outcome.out);
        CHECK(outcome.code == 0);
        auto summary = summary_of(output);
        CHECK(std::stod(summary.at("max_distortion")) < 1.01);
        CHECK(summary.at("nodes_off_target") == "0");
        const Mesh mesh = mesh_of(output + "/final.msh");
        double farthest = 0;
        for (const int i : nodes_of(mesh, "rim")) {
            const double angle = std::atan2(mesh.x[2 * i + 1], mesh.x[2 * i]);
            double on_peanut[2] = {std::cos(angle), std::sin(angle)};
            peanut(on_peanut);
            farthest = std::max(farthest, std::hypot(mesh.x[2 * i] - on_peanut[0], mesh.x[2 * i + 1] - on_peanut[1]));
        }
        CHECK(farthest < 1e-4);
        return std::stoi(summary.at("newton_iterations"));
    };
    CHECK(steps(10, 10) == 30);
    CHECK(steps(10, 30) == 23);
    CHECK(steps(20, 10) == 38);
    CHECK(steps(20, 30) == 36);
}

TEST_CASE("another unit and origin lead to the same mesh") {
    const auto placed = [](double* x) { x[0] = 1e3 * x[0] + 2e5, x[1] = 1e3 * x[1] - 1e5; };
    const RingDeck ring, far(curved(ring_mesh(12, 3, 6), 1, placed));
    const auto run = [](const RingDeck& deck, const Mesh& other) {
        const Outcome outcome = deck.run({"degree=3", "boundary inner=fixed",
                                          "boundary outer=slide along " + deck.folder.write("o.msh", msh_of(other))});
        CHECK(outcome.code == 0);
        return mesh_of(deck.output + "/final.msh");
    };
    Mesh moved = egg(20, 3);
    moved.x = mapped(moved, placed);
    const Mesh a = run(ring, egg(20, 3)), b = run(far, moved);
    REQUIRE(a.x.size() == b.x.size());
    double largest = 0;
    for (int i = 0; i < a.nodes(); ++i) {
        double x[2] = {a.x[2 * i], a.x[2 * i + 1]};
        placed(x);
        largest = std::max(largest, std::hypot(x[0] - b.x[2 * i], x[1] - b.x[2 * i + 1]));
    }
    CHECK(largest < 6e-3);  // a millionth of the outer radius
}

TEST_CASE("a block along another one with a bumpy floor: surfaces, edges and corners are the other's") {
    const TemporaryFolder folder;
    folder.write("run.msh", msh_of(cube_mesh(3)));
    for (const int degree : {1, 3}) {  // of the other
        CAPTURE(degree);
        folder.write("other.msh", msh_of(curved(cube_mesh(degree == 1 ? 12 : 4), degree, [](double* x) {
            bump(x);
            x[0] = 1.3 * x[0] - 0.1;
        })));
        const std::string deck = folder.write("block.deck", "mesh = run.msh\noutput = " + folder.path("out") +
                                                                "\nboundary all = slide along other.msh\n");
        for (const std::string setting : {"degree=1", "degree=2"}) {
            CAPTURE(setting);
            const Outcome outcome = almesh_with({deck, setting});
            CAPTURE(outcome.out);
            CAPTURE(outcome.error);
            REQUIRE(outcome.code == 0);
            const Mesh mesh = mesh_of(folder.path("out/final.msh"));
            double largest = 0, corners[2] = {1e9, -1e9};
            for (const int i : nodes_of(mesh, "bottom")) {
                const double* const x = point(mesh.x, i, 3);
                double y[3] = {(x[0] + 0.1) / 1.3, x[1], 0};
                bump(y);
                largest = std::max(largest, std::abs(x[2] - y[2]));
            }
            CHECK(largest < (degree == 1 ? 5e-3 : 5e-4));
            for (const int i : nodes_of(mesh, "sides")) {
                const double* const x = point(mesh.x, i, 3);
                corners[0] = std::min(corners[0], x[0]);
                corners[1] = std::max(corners[1], x[0]);
                const double off = std::min({std::abs(x[0] + 0.1), std::abs(x[0] - 1.2), std::abs(x[1]),
                                             std::abs(x[1] - 1)});
                CHECK(off < 1e-9);
            }
            CHECK(corners[0] == doctest::Approx(-0.1).epsilon(1e-9));
            CHECK(corners[1] == doctest::Approx(1.2).epsilon(1e-9));
        }
    }
}

TEST_CASE("which boundary of the other mesh: the one named, of the same name, or the only one; errors say where") {
    const RingDeck ring;
    ring.folder.write("fine.msh", msh_of(ring_mesh(24, 2, 6)));
    ring.folder.write("cube.msh", msh_of(cube_mesh(1)));
    Mesh one = ring_mesh(24, 2, 6);
    one.boundaries = {"rim"};
    one.boundary_groups = {{"rim"}};
    for (int& boundary : one.face_boundary) boundary = 0;
    for (int& tag : one.file.face_physical) tag = 1;
    one.file.groups = {{1, 1, "rim"}};
    ring.folder.write("one.msh", msh_of(one));
    const auto along = [&](const std::string& what) {
        return ring.run({"boundary inner=fixed", "boundary outer=slide along " + ring.folder.path(what)});
    };
    for (const char* const what : {"fine.msh", "fine.msh boundary outer", "one.msh"}) CHECK(along(what).code == 0);
    const auto refused = [&](const std::string& what, const std::string& why) {
        const Outcome outcome = along(what);
        CAPTURE(outcome.error);
        CHECK(outcome.code == 2);
        CHECK(has(outcome.error, "command line: boundary \"outer\": "));
        CHECK(has(outcome.error, why));
    };
    refused("none.msh", "cannot read");
    refused("ring.deck", "ring.deck");
    refused("cube.msh", "a mesh in 3 dimensions, the one that moves has 2");
    refused("fine.msh boundary hull", "no boundary \"hull\" there, only \"inner\", \"outer\"; say which one");
}

TEST_CASE("along a curved mesh whose straight form folds, but not along one that folds itself") {
    const RingDeck ring(ring_mesh(12, 2, 6));
    REQUIRE(ring.run({"degree=2", "boundary inner=rotate 180 about 0 0"}).code == 0);
    const std::string turned = ring.folder.write("turned.msh", text_of(ring.output + "/final.msh"));
    REQUIRE(has(ring.run({"mesh=" + turned, "ideal=straight"}).error, "without their curves"));
    CHECK(ring.run({"boundary inner=fixed", "boundary outer=slide along " + turned}).code == 0);
    Mesh folded = ring_mesh(12, 2, 6);
    for (int i = 0; i < folded.nodes(); ++i)
        if (std::abs(std::hypot(folded.x[2 * i], folded.x[2 * i + 1]) - 3.5) < 2 && folded.x[2 * i] > 2)
            folded.x[2 * i] += 20;
    const std::string path = ring.folder.write("folded.msh", msh_of(folded));
    const Outcome refused = ring.run({"boundary inner=fixed", "boundary outer=slide along " + path});
    CHECK(refused.code == 2);
    CHECK(has(refused.error, ": the mesh folds over itself; `almesh quality` tells where, `almesh improve` mends it"));
}
