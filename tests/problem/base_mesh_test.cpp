// ideal = auto | straight | given, from the deck to the results.
#include "problem/base_mesh.hpp"

#include <doctest/doctest.h>

#include <string>

#include "support/high_order.hpp"
#include "support/program.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// x + t^2 s (2, -1, 0), t = x + 2 y: keeps volumes, but with s = 1 not those of elements with straight edges.
Mesh sheared(const Mesh& linear, int degree, double s = 1) {
    Mesh mesh = with_degree(linear, degree);
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, mesh.dim);
        const double t = x[0] + 2 * x[1];
        x[0] += 2 * s * t * t;
        x[1] -= s * t * t;
    }
    return mesh;
}

struct Sheared {
    TemporaryFolder folder;
    std::string output = folder.path("out"), deck;

    explicit Sheared(const Mesh& mesh) {
        folder.write("sheared.msh", msh_of(mesh));
        const std::string axis = mesh.dim == 3 ? " 0 axis 0 0 1" : "";
        deck = folder.write("sheared.deck", "mesh = sheared.msh\noutput = " + output +
                                                "\nboundary all = rotate 20 about 0 0" + axis +
                                                "\nobjective = size_shape\n");
    }
    Outcome run(std::vector<std::string> settings = {}) const {
        settings.insert(settings.begin(), deck);
        return almesh_bounded(settings);
    }
};

}  // namespace

TEST_CASE("a valid curved mesh whose straight form folds is its own ideal mesh, of every degree, in 2D and 3D") {
    for (const Mesh& mesh : {sheared(square_mesh(4), 2), sheared(square_mesh(3), 3), sheared(square_mesh(3), 4),
                             sheared(cube_mesh(2), 2), sheared(cube_mesh(2), 3)}) {
        const Sheared of(mesh);
        const Outcome run = of.run();
        CAPTURE(run.out + run.error);
        CHECK(run.code == 0);
        CHECK(has(run.out, "note: the straight-sided form of the mesh folds over itself: the curved mesh of the "
                           "file is the ideal mesh (ideal = given)"));
        const auto rows = summary_of(of.output);
        CHECK(std::stod(rows.at("max_distortion")) == doctest::Approx(1).epsilon(1e-6));
        CHECK(std::stod(rows.at("relative_quality")) == doctest::Approx(1).epsilon(1e-6));
        CHECK(std::stod(rows.at("size_skew_min")) > 0);
        CHECK(rows.at("certified_injective") == "yes");
        CHECK(of.run({"ideal=straight"}).code == 2);
    }
}

TEST_CASE("ideal = given takes a curved mesh as it is also where its straight form is valid, auto does not") {
    const Sheared of(sheared(square_mesh(4), 2, 0.05));
    REQUIRE(of.run().code == 0);
    const std::string bits = text_of(of.output + "/final.msh"), eta = summary_of(of.output).at("max_distortion");
    CHECK(std::stod(eta) > 1.01);  // it has been curved anew
    REQUIRE(of.run({"ideal=straight"}).code == 0);
    CHECK(summary_of(of.output).at("max_distortion") == eta);
    REQUIRE(of.run({"ideal=given"}).code == 0);
    CHECK(std::stod(summary_of(of.output).at("max_distortion")) == doctest::Approx(1).epsilon(1e-6));
    const Sheared linear(square_mesh(3));
    REQUIRE(linear.run({"ideal=given"}).code == 0);
    CHECK(text_of(linear.output + "/deck.txt").find("ideal = given") != std::string::npos);
}

TEST_CASE("what a run has curved and turned can be moved again, with every method that keeps elements valid") {
    const RingDeck ring(ring_mesh(12, 2, 6));
    REQUIRE(ring.run({"degree=2", "boundary inner=rotate 180 about 0 0"}).code == 0);
    const std::string turned = "mesh=" + ring.folder.write("turned.msh", text_of(ring.output + "/final.msh"));
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
             {}, {"boundary inner=rotate 60 about 0 0"}, {"boundary inner=rotate -180 about 0 0"},
             {"objective=minimax"},
             {"boundary outer=slide"}, {"boundary outer=free"}, {"method=penalty"},
             {"continuation=always"}, {"algorithm=paper"}, {"degree=3"}}) {
        std::vector<std::string> settings = {turned};
        for (const std::string& setting : more) settings.push_back(setting);
        const Outcome run = ring.run(settings);
        CAPTURE(more.empty() ? "translate" : more[0]);
        CAPTURE(run.out + run.error);
        CHECK(run.code == 0);
    }
    const Outcome repair = ring.run({turned, "boundary inner=fixed", "local_repair=1"});
    CHECK(repair.code == 0);
    CHECK(has(repair.out, "no element is invalid in the file: nothing moves"));
}

TEST_CASE("what does not go with a curved ideal mesh is refused, with what to do") {
    const RingDeck ring(ring_mesh(12, 2, 6));
    REQUIRE(ring.run({"degree=2", "boundary inner=rotate 180 about 0 0"}).code == 0);
    const std::string turned = "mesh=" + ring.folder.write("turned.msh", text_of(ring.output + "/final.msh"));
    const auto refused = [&](const std::string& setting, const std::string& why, int code = 1) {
        const Outcome run = ring.run({turned, setting});
        CAPTURE(run.error);
        CHECK(run.code == code);
        CHECK(has(run.error, why));
    };
    refused("start=coarse", "with ideal = given take start = identity");
    refused("degree=1", "in degree 1 the curved mesh, which is the ideal mesh with ideal = given, is not valid: take "
                        "degree = 2");
    refused("refine=1", "the mesh is curved", 2);
}

TEST_CASE("where neither the straight form nor the curved mesh is valid, both reasons are told") {
    Mesh mesh = sheared(square_mesh(4), 2);
    const int inside = mesh.element(5)[3];
    for (int a = 0; a < 2; ++a) mesh.x[2 * inside + a] += 30;
    const Sheared of(mesh);
    for (const std::string ideal : {"auto", "given"}) {
        const Outcome run = of.run({"ideal=" + ideal});
        CAPTURE(run.error);
        CHECK(run.code == 2);
        CHECK(has(run.error, "the straight form of the mesh folds over itself; as it is in the file, ") ==
              (ideal == "auto"));
        CHECK(has(run.error, "proved invalid"));
        CHECK(has(run.error, " proved invalid (id, centre, certified bound):\n  "));
    }
}

TEST_CASE("a quadrilateral that is inverted at a corner is refused, with file, element, place and what to do") {
    const TemporaryFolder folder;
    const std::string mesh = folder.write("arrow.msh",
                                          "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n"
                                          "3 0.2 0.2 0\n4 0 1 0\n$EndNodes\n$Elements\n1\n7 3 2 1 1 1 2 3 4\n"
                                          "$EndElements\n"),
                      deck = folder.write("arrow.deck", "mesh = arrow.msh\nboundary all = fixed\noutput = " +
                                                            folder.path("out") + "\n");
    for (const std::string ideal : {"auto", "straight", "given"}) {
        const Outcome run = almesh_with({deck, "ideal=" + ideal});
        CAPTURE(run.error);
        CHECK(run.code == 2);
        CHECK(has(run.error, "arrow.msh: 1 element with straight sides and a corner of 180 degrees or more (id, "
                             "centre, certified bound):\n  7  (0.3, 0.3)  "));
        CHECK(has(run.error, "\ntry almesh improve "));
    }
    const Outcome quality = almesh_with({"quality", mesh});
    CHECK(quality.code == 4);
    CHECK(has(quality.out, "NOT certified valid: 1 element proved invalid"));
}

TEST_CASE("a target that inverts a corner of a quadrilateral is refused, and split with it") {
    for (const Mesh& mesh : {quad_mesh(4), mixed_mesh(4)}) {
        const TemporaryFolder folder;
        folder.write("square.msh", msh_of(mesh));
        const std::string deck = folder.write(
            "square.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                               "\nboundary bottom = fixed\nboundary right = fixed\n"
                               "boundary left = expression \"x+0.4*max(0,4*y-3)\" \"y-0.4*max(0,4*y-3)\"\n"
                               "boundary top = expression \"x+0.4*max(0,1-4*x)\" \"y-0.4*max(0,1-4*x)\"\n");
        const Outcome run = almesh_with({deck}), split = almesh_with({deck, "split=auto"});
        CAPTURE(run.error + split.error);
        CHECK(run.code == 2);
        CHECK(has(run.error, "at (0.125, 0.875): its boundary nodes make its scaled determinant -0.75"));
        CHECK(has(run.error, "\ntry a mesh with more elements there or targets that do not invert them"));
        CHECK(!has(run.error, "split = auto"));
        CHECK(split.code == 1);
        CHECK(has(split.error, "split divides triangles and tetrahedra, but the mesh has "));
        CHECK(has(split.error, " quadrilaterals: leave it out"));
    }
}
