// Targets that fold faces and elements by their curvature alone: refused or mended, as the key `surface` says.
#include "problem/problem.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "check/certificate.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr int around = 12;

// A ring of degree 2 whose boundaries are circles. `crowd`: how far the node within one edge of the inner one is from
// its middle, over half the edge: where that is more than a half the edge is folded. What the linear mesh has within
// the inner circle stays straight.
Mesh round_ring(double crowd, const Mesh& linear = ring_mesh(around, 3, 6)) {
    Mesh mesh = raise_degree(linear, 2);
    const auto radius = [&](int f) {
        const double* const vertex = point(mesh.x, mesh.face(f)[0], 2);
        return std::hypot(vertex[0], vertex[1]);
    };
    int crowded = 0;
    while (std::abs(radius(crowded) - 1) > 1e-9) ++crowded;
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (radius(f) < 1 - 1e-9) continue;
        double* const middle = point(mesh.x, mesh.face(f)[2], 2);
        const double *const a = point(mesh.x, mesh.face(f)[0], 2), *const b = point(mesh.x, mesh.face(f)[1], 2);
        const double r = std::hypot(a[0], a[1]), along = f == crowded ? crowd * std::numbers::pi / around : 0;
        const double sense = a[0] * b[1] > a[1] * b[0] ? 1 : -1;
        const double angle = std::atan2(a[1] + b[1], a[0] + b[0]) + sense * along;
        middle[0] = r * std::cos(angle), middle[1] = r * std::sin(angle);
    }
    return mesh;
}

std::vector<int> nodes_of(const Mesh& mesh, const std::string& boundary) {
    std::vector<int> nodes;
    for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k)
        if (mesh.boundaries[mesh.face_boundary[k / mesh.face_nodes(0)]] == boundary) nodes.push_back(mesh.faces[k]);
    return nodes;
}

// That the nodes of the inner boundary are on the unit circle about (0.25, 0).
void check_inner_circle(const std::string& folder) {
    const Mesh mesh = mesh_of(folder + "/final.msh");
    CHECK(certify(mesh, mesh.x).valid);
    for (const int i : nodes_of(mesh, "inner"))
        CHECK(std::hypot(point(mesh.x, i, 2)[0] - 0.25, point(mesh.x, i, 2)[1]) == doctest::Approx(1).epsilon(1e-7));
}

}  // namespace

TEST_CASE("a boundary that its nodes fold: refused with surface = keep, else they slide along it") {
    const RingDeck ring(round_ring(0.8));
    const Outcome kept = ring.run({"boundary inner=translate 0.25 0", "surface=keep"});
    CHECK(kept.code == 2);
    CHECK(has(kept.error, "the target makes the boundary itself invalid at 1 face:"));
    CHECK(has(kept.error, "folds the face back on itself"));
    CHECK(has(kept.error, "try surface = auto (nodes slide along the surface there)"));
    CHECK(!std::filesystem::exists(ring.output));

    for (const std::string setting : {"surface=auto", "start=identity", "algorithm=paper"}) {
        CAPTURE(setting);
        const Outcome mended = ring.run({"boundary inner=translate 0.25 0", setting});
        CAPTURE(mended.error);
        REQUIRE(mended.code == 0);
        CHECK(has(mended.out, "note: the target makes "));
        CHECK(has(mended.out, " around them slide along the surface:"));
        CHECK(has(mended.out, "boundary inner slides along: circle of radius 1"));
        CHECK(has(mended.out, " nodes slid along the surface, by at most "));
        const auto summary = summary_of(ring.output);
        check_inner_circle(ring.output);
        CHECK(number(summary, "freed_nodes") == 7);  // of the folded face and its neighbours
        CHECK(number(summary, "max_boundary_error") < 1e-7);
        CHECK(number(summary, "largest_slide") > 0.1);
        CHECK(number(summary, "largest_slide") < 0.3);
        CHECK(number(summary, "surface_distance") > 0);
        CHECK(number(summary, "surface_distance") < 1e-2);
        CHECK(has(mended.out, "\ninner"));
        CHECK(number(summary, "boundary_distance") > 0);  // from the polynomials that came
    }
}

TEST_CASE("a layer of one element that a motion of any kind inverts: its nodes slide along the surface of the target") {
    const Mesh ring = ring_mesh(16, 1, 1.25);
    const TemporaryFolder folder;
    std::string turned;
    const std::vector<int> inner = nodes_of(ring, "inner");
    for (const int i : std::set<int>(inner.begin(), inner.end()))
        turned += concat(ring.file.node_id[i], " ", -point(ring.x, i, 2)[1], " ", point(ring.x, i, 2)[0], "\n");
    const std::string file = folder.write("turned.txt", turned);
    for (const std::string& motion :
         {std::string("rotate 120 about 0 0"), std::string("scale 1.1 about 0 0; rotate 60 about 0 0"),
          std::string("expression \"x*cos(0.9*x)-y*sin(0.9*x)\" \"x*sin(0.9*x)+y*cos(0.9*x)\""),
          "file " + file}) {
        CAPTURE(motion);
        const RingDeck deck(ring);
        const Outcome outcome = deck.run({"boundary inner=" + motion});
        CAPTURE(outcome.error);
        REQUIRE(outcome.code == 0);
        CHECK(has(outcome.out, "boundary inner slides along: circle of radius 1"));
        const auto summary = summary_of(deck.output);
        CHECK(number(summary, "freed_nodes") > 0);
        CHECK(number(summary, "largest_slide") > 0.1);
        CHECK(summary.at("nodes_off_target") == "0");
        CHECK(deck.run({"boundary inner=" + motion, "surface=keep"}).code == 2);
    }
}

TEST_CASE("nodes that are not released keep their places to the last bit") {
    const Mesh before = round_ring(0.8);
    const RingDeck ring(before);
    REQUIRE(ring.run({"boundary inner=translate 0.25 0"}).code == 0);
    const Mesh after = mesh_of(ring.output + "/final.msh");
    std::vector<int> inner = nodes_of(before, "inner");
    std::sort(inner.begin(), inner.end());
    inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
    const auto stays = [&](int i) {
        return point(after.x, i, 2)[0] == point(before.x, i, 2)[0] + 0.25 &&
               point(after.x, i, 2)[1] == point(before.x, i, 2)[1];
    };
    CHECK(std::count_if(inner.begin(), inner.end(), stays) == 2 * around - 7);
}

TEST_CASE("surface = slide lets all prescribed boundaries slide, folded or not; auto none of one that is not folded") {
    for (const double crowd : {0.8, 0.0}) {
        const RingDeck ring(round_ring(crowd));
        const Outcome outcome = ring.run({"boundary inner=translate 0.25 0", "surface=slide"});
        CAPTURE(outcome.error);
        REQUIRE(outcome.code == 0);
        CHECK(has(outcome.out, "boundary inner slides along: circle of radius 1"));
        CHECK(has(outcome.out, "boundary outer slides along: circle of radius 6"));
        CHECK(summary_of(ring.output).at("freed_nodes") == "0");
        CHECK(summary_of(ring.output).at("largest_slide") == "0");
        CHECK(number(summary_of(ring.output), "surface_distance") > 0);
        check_inner_circle(ring.output);
    }
    const RingDeck fair(round_ring(0));
    for (const char* const setting : {"surface=auto", "surface=keep"}) {
        const Outcome outcome = fair.run({"boundary inner=translate 0.25 0", setting});
        REQUIRE(outcome.code == 0);
        CHECK(!has(outcome.out, "slid"));
        CHECK(!has(outcome.out, "distance of the faces"));
        for (const char* const quantity : {"freed_nodes", "largest_slide", "surface_distance", "boundary_distance"})
            CHECK(summary_of(fair.output).at(quantity) == "0");
    }
}

TEST_CASE("surface = straighten is refused where boundaries move") {
    const RingDeck ring(round_ring(0.8));
    const Outcome outcome = ring.run({"boundary inner=translate 0.25 0", "surface=straighten"});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.error, "command line: surface = straighten is for a curved mesh that is made valid where it is"));
}

TEST_CASE("a curved mesh whose straight-sided form overlaps itself is not certified, and the place is told") {
    // A small part of the mesh between the folded edge's circle and its chord.
    const Mesh ring = ring_mesh(around, 3, 6);
    int folded = 0;
    while (ring.boundaries[ring.face_boundary[folded]] != "inner") ++folded;
    const double *const a = point(ring.x, ring.face(folded)[0], 2), *const b = point(ring.x, ring.face(folded)[1], 2);
    const double angle = std::atan2(a[1] + b[1], a[0] + b[0]);
    const Mesh linear = two_parts(ring, 0.001, {0.98 * std::cos(angle), 0.98 * std::sin(angle), 0});
    const TemporaryFolder folder;
    folder.write("both.msh", msh_of(round_ring(0.8, linear)));
    const std::string deck =
        folder.write("both.deck", "mesh = both.msh\nboundary all = fixed\noutput = " + folder.path("results") + "\n");
    const Outcome outcome = almesh_with({deck, "surface=straighten"});
    CAPTURE(outcome.out);
    CHECK(outcome.code == 4);
    CHECK(has(outcome.out, "with straight sides too, "));
    CHECK(summary_of(folder.path("results")).at("certified_valid") == "yes");
}

TEST_CASE("a motion that only curves starts from the identity, with a large penalty, where the Hessian there is not zero") {
    const RingDeck ring;
    const auto run = [&](const std::string& objective, const std::string& inner) {
        const Outcome outcome = ring.run({"degree=4", "objective=" + objective, "boundary inner=" + inner,
                                          "boundary outer=circle 0 0 6"});
        CHECK(outcome.code == 0);
        return outcome.out;
    };
    CHECK(!has(run("squared", "circle 0 0 1"), " coarse "));
    CHECK(std::stod(summary_of(ring.output).at("newton_iterations")) <= 6);
    CHECK(has(run("deviation", "circle 0 0 1"), " coarse "));
    CHECK(has(run("squared", "circle 0 0 1; translate 0.5 0"), " coarse "));
}
