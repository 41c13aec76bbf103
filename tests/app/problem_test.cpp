// Targets that fold faces and elements by their curvature alone: refused or mended, as the key `surface` says.
#include "app/problem.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "check/certificate.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr int around = 12;

// A ring of degree 2 whose boundaries are circles. `crowd`: how far the node within one edge of the inner one is from
// its middle, over half the edge: where that is more than a half the edge is folded.
Mesh round_ring(double crowd) {
    Mesh mesh = raise_degree(ring_mesh(around, 3, 6), 2);
    int crowded = 0;
    while (mesh.boundaries[mesh.face_boundary[crowded]] != "inner") ++crowded;
    for (int f = 0; f < mesh.face_count(); ++f) {
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
        if (mesh.boundaries[mesh.face_boundary[k / mesh.face_nodes()]] == boundary) nodes.push_back(mesh.faces[k]);
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
    CHECK(has(kept.error, "try surface = auto, with which nodes slide along the surface there"));
    CHECK(!std::filesystem::exists(ring.output));

    for (const std::string setting : {"surface=auto", "start=identity", "algorithm=paper"}) {
        CAPTURE(setting);
        const Outcome mended = ring.run({"boundary inner=translate 0.25 0", setting});
        CAPTURE(mended.error);
        REQUIRE(mended.code == 0);
        CHECK(has(mended.out, "note: the target folds "));
        CHECK(has(mended.out, " around slide along the surface:"));
        CHECK(has(mended.out, "boundary inner slides along: circle of radius 1"));
        CHECK(has(mended.out, " nodes slid along the surface, by at most "));
        const auto summary = summary_of(ring.output);
        check_inner_circle(ring.output);
        CHECK(number(summary, "released_nodes") == 7);  // of the folded face and its neighbours
        CHECK(number(summary, "max_boundary_error") < 1e-7);
        CHECK(number(summary, "largest_slide") > 0.1);
        CHECK(number(summary, "largest_slide") < 0.3);
        CHECK(number(summary, "surface_distance") > 0);
        CHECK(number(summary, "surface_distance") < 1e-2);
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
        CHECK(summary_of(ring.output).at("released_nodes") == "0");
        CHECK(summary_of(ring.output).at("largest_slide") == "0");
        CHECK(number(summary_of(ring.output), "surface_distance") > 0);
        check_inner_circle(ring.output);
    }
    const RingDeck fair(round_ring(0));
    for (const char* const setting : {"surface=auto", "surface=keep"}) {
        const Outcome outcome = fair.run({"boundary inner=translate 0.25 0", setting});
        REQUIRE(outcome.code == 0);
        CHECK(!has(outcome.out, "slid"));
        for (const char* const quantity : {"released_nodes", "largest_slide", "surface_distance"})
            CHECK(summary_of(fair.output).at(quantity) == "0");
    }
}
