// A node of a fixed boundary is where the file has it, one of a boundary that a formula moves is at its formula, both to
// the last bit, whatever the boundaries beside them do; and what the report says of that.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "constraint/motion.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

using Position = std::array<double, 3>;

struct Bulge {
    const char* text;
    std::function<Position(const Position&)> at;
};

// Of the lid (y = 1 or z = 1) of the unit square or cube, 0 at its rim; none is affine.
const Bulge bulges_2d[] = {
    {"expression \"x\" \"y + 0.3*x*(1 - x)\"",
     [](const Position& p) { return Position{p[0], p[1] + 0.3 * p[0] * (1 - p[0]), 0}; }},
    {"expression \"x\" \"y - 0.2*x*x*(1 - x)\"",
     [](const Position& p) { return Position{p[0], p[1] - 0.2 * p[0] * p[0] * (1 - p[0]), 0}; }}};
const Bulge bulge_3d = {"expression \"x\" \"y\" \"z + 0.5*x*(1 - x)*y*(1 - y)\"", [](const Position& p) {
                            return Position{p[0], p[1], p[2] + 0.5 * p[0] * (1 - p[0]) * p[1] * (1 - p[1])};
                        }};

struct Case {
    TemporaryFolder folder;
    std::string output = folder.path("out"), deck;
    Mesh mesh;

    Case(Mesh of_file, const std::string& lines) : mesh(std::move(of_file)) {
        folder.write("box.msh", msh_of(mesh));
        deck = folder.write("box.deck", "mesh = box.msh\nvtk = none\nthreads = 1\noutput = " + output + "\n" + lines);
    }

    // Largest distance from `at` of the nodes of the boundary, in the mesh of this degree that the run has written.
    double farthest(const std::string& boundary, int degree, const std::function<Position(const Position&)>& at) const {
        const Mesh before = degree == 1 ? mesh : interpolated(mesh, degree), after = mesh_of(output + "/final.msh");
        REQUIRE(before.faces.size() == after.faces.size());
        double largest = 0;
        for_face_nodes(before, [&](int f, std::size_t k) {
            if (before.boundaries[before.face_boundary[f]] != boundary) return;
            Position p{};
            std::copy_n(point(before.x, before.faces[k], before.dim), before.dim, p.begin());
            p = at(p);
            for (int a = 0; a < before.dim; ++a)
                largest = std::max(largest, std::abs(p[a] - point(after.x, after.faces[k], before.dim)[a]));
        });
        return largest;
    }
};

Position stays(const Position& p) { return p; }

void check(const Mesh& mesh, const std::string& lid, const std::vector<std::string>& fixed, const Bulge& bulge,
           int degree, const std::string& rest) {
    std::string lines = "boundary " + lid + " = " + bulge.text + "\n" + rest;
    for (const std::string& name : fixed) lines += "boundary " + name + " = fixed\n";
    const Case box(mesh, lines);
    const Outcome run = almesh_bounded({box.deck, "degree=" + std::to_string(degree)});
    CAPTURE(lines);
    CAPTURE(degree);
    CAPTURE(run.out + run.error);
    REQUIRE(run.code == 0);
    CHECK(has(run.out, "every boundary node is where its motion takes it to the last bit"));
    CHECK(summary_of(box.output).at("nodes_off_motion") == "0");
    CHECK(summary_of(box.output).at("off_motion") == "0");
    CHECK(box.farthest(lid, degree, bulge.at) <= 3e-16);
    for (const std::string& name : fixed) CHECK(box.farthest(name, degree, stays) == 0);
}

}  // namespace

TEST_CASE("fixed nodes stay and moved ones are at their formula, beside fixed, moved and sliding sides") {
    for (int degree = 1; degree <= 4; ++degree)
        for (const Mesh& mesh : {square_mesh(3), quad_mesh(3, 0.1), mixed_mesh(4, 0.1)})
            for (const Bulge& bulge : bulges_2d) {
                check(mesh, "top", {"left", "right", "bottom"}, bulge, degree, "");
                check(mesh, "top", {"bottom"}, bulge, degree, "boundary left = slide\nboundary right = fixed\n");
                check(mesh, "top", {"left", "right"}, bulge, degree, "boundary bottom = translate 0 0\n");
            }
}

TEST_CASE("the same of all solid cells") {
    for (int degree = 1; degree <= 2; ++degree)
        for (const char* layers : {"hh", "hdpuh"})
            for (const char* sides : {"fixed", "slide"}) {
                Mesh mesh = solid_mesh(2, layers, 0.1);
                for (std::size_t k = 2; k < mesh.x.size(); k += 3) mesh.x[k] /= static_cast<double>(std::string(layers).size());
                check(mesh, "top", {"bottom"}, bulge_3d, degree, std::string("boundary sides = ") + sides + "\n");
            }
    check(cube_mesh(2), "top", {"bottom", "sides"}, bulge_3d, 3, "");
}

TEST_CASE("nodes are at their motion, whatever it is, in every degree") {
    const std::vector<std::string> plane = {"rotate 40 about 0.1 0.2; translate 1 2", "scale 2 0.5",
                                            "expression \"x + 0.1*sin(y)\" \"y*exp(0.3*x)\"; rotate 20"},
                                   space = {"twist 20 about 0.5 0.5 0 axis 0 0 1",
                                            "rotate 30 axis 1 1 0 about 0 0 1; expression \"x\" \"y + 0.1*x^2\" \"z\""};
    for (const Mesh& mesh : {mixed_mesh(4, 0.1), solid_mesh(2, "hd", 0.1), ring_mesh(12, 3, 4)})
        for (const std::string& text : mesh.dim == 3                  ? space
                                       : mesh.boundaries.size() == 4 ? plane
                                                                     : std::vector<std::string>{"circle 0 0 1"})
            for (int degree = 1; degree <= (mesh.dim == 2 ? 4 : 2); ++degree) {
                const bool is_ring = mesh.dim == 2 && mesh.boundaries.size() == 2;
                const Case box(mesh, is_ring ? "boundary inner = " + text + "\nboundary outer = fixed\n"
                                             : "boundary all = " + text + "\n");
                const Outcome run = almesh_bounded({box.deck, "degree=" + std::to_string(degree)});
                CAPTURE(text);
                CAPTURE(degree);
                CAPTURE(run.out + run.error);
                REQUIRE(run.code == 0);
                const Motion motion = parse_motion(text);
                for (const std::string& name : mesh.boundaries)
                    CHECK(box.farthest(name, degree, [&](Position p) {
                        if (name != "outer") apply(motion, mesh.dim, p.data());
                        return p;
                    }) == 0);
                CHECK(summary_of(box.output).at("nodes_off_motion") == "0");
            }
}

TEST_CASE("target = least_squares holds the nodes of fixed boundaries, and the report tells how far nodes are off") {
    const Bulge& bulge = bulges_2d[0];
    for (int degree = 1; degree <= 3; ++degree) {
        const Case box(quad_mesh(3, 0.1), std::string("boundary top = ") + bulge.text + "\nboundary rest = fixed\n");
        const Outcome run =
            almesh_bounded({box.deck, "degree=" + std::to_string(degree), "target=least_squares"});
        CAPTURE(run.out);
        REQUIRE(run.code == 0);
        for (const char* name : {"left", "right", "bottom"}) CHECK(box.farthest(name, degree, stays) == 0);
        const double off = box.farthest("top", degree, bulge.at), told = number(summary_of(box.output), "off_motion");
        CHECK(told == doctest::Approx(off).epsilon(1e-5));
        if (degree > 1) continue;  // a parabola is in the space of the others
        CHECK(off > 1e-3);
        CHECK(summary_of(box.output).at("nodes_off_motion") == "2");
        CHECK(has(run.out, "target = least_squares fits the boundary to its motion in the mean: 2 boundary nodes off their motions by at most 0.00667"));
    }
}

TEST_CASE("a node between a fixed boundary and one that moves it by next to nothing stays") {
    const Case box(square_mesh(3), "boundary top = expression \"x + 1e-8*x\" \"y + 0.3*x*(1 - x) + 1e-8\"\n"
                                    "boundary rest = fixed\n");
    const Outcome run = almesh_bounded({box.deck});
    CAPTURE(run.out + run.error);
    REQUIRE(run.code == 0);
    for (const char* name : {"left", "right", "bottom"}) CHECK(box.farthest(name, 1, stays) == 0);
    CHECK(summary_of(box.output).at("nodes_off_motion") == "2");  // the corners, for the motion of the top
    CHECK(number(summary_of(box.output), "off_motion") == doctest::Approx(std::hypot(1e-8, 1e-8)));
    CHECK(has(run.out, "2 boundary nodes off their motions by at most 1.41e-08"));
}
