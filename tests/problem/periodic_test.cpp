// Runs of meshes with periodic sides.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "linalg/vector_ops.hpp"
#include "mesh/periodic.hpp"
#include "support/periodic_box.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct PeriodicDeck {
    TemporaryFolder folder;
    std::string output = folder.path("out"), deck;
    Outcome outcome{};

    explicit PeriodicDeck(const std::string& mesh, const std::string& text) {
        folder.write("box.msh", mesh);
        deck = folder.write("box.deck", "mesh = box.msh\noutput = " + output + "\nthreads = 1\nvtk = none\n" + text);
    }
    PeriodicDeck& run(std::vector<std::string> arguments = {}) {
        arguments.insert(arguments.begin() + (arguments.empty() || arguments[0] != "tangent" ? 0 : 1), deck);
        outcome = almesh_with(arguments);
        return *this;
    }
    double of(const std::string& key) const { return number(summary_of(output), key); }
};

// The largest distance of a node of `side` in one mesh and another, relative to their largest coordinate.
double moved(const Mesh& before, const Mesh& after, const std::string& side) {
    double largest = 0, size = 0;
    for_face_nodes(before, [&](int f, std::size_t k) {
        for (int a = 0; a < before.dim; ++a) {
            const double from = point(before.x, before.faces[k], before.dim)[a];
            size = std::max(size, std::abs(from));
            if (before.boundaries[before.face_boundary[f]] == side)
                largest = std::max(largest, std::abs(point(after.x, before.faces[k], before.dim)[a] - from));
        }
    });
    return largest / size;
}

const std::string rest = "boundary rest = fixed\n";

}  // namespace

TEST_CASE("a body in a channel with periodic sides takes them along, in every degree and refinement") {
    for (const bool simplices : {true, false})
        for (const int degree : {1, 2, 3})
            for (const int refine : {0, 1}) {
                if (refine && degree == 3) continue;
                CAPTURE(simplices); CAPTURE(degree); CAPTURE(refine);
                PeriodicDeck deck(PeriodicBox{{8, 6, 0}, simplices}.msh(),
                                  "boundary body = translate 0.2 0.1\n" + rest);
                deck.run({concat("degree=", degree), concat("refine=", refine)});
                REQUIRE(deck.outcome.code == 0);
                CHECK(has(deck.outcome.out, "periodic sides that move as one: \"left\", \"right\", "));
                CHECK(deck.of("periodic_pairs") == 6 * degree * (refine + 1) + 1);
                CHECK(deck.of("periodic_mismatch") <= 1e-15);
                if (degree > 1 || refine) continue;
                const Mesh before = mesh_of(deck.folder.path("box.msh")), after = mesh_of(deck.output + "/final.msh");
                for (const char* side : {"left", "right"}) CHECK(moved(before, after, side) > 0.003);
                for (const char* side : {"top", "bottom"}) CHECK(moved(before, after, side) == 0);
                CHECK(has(text_of(deck.output + "/final.msh"), "$EndPeriodic"));
            }
}

TEST_CASE("sides far from the origin") {
    const auto box = [](double shift) {
        PeriodicBox of{{8, 6, 0}, false};
        of.map = [shift](Vec<3> x) { return Vec<3>{x[0] + shift, x[1], x[2]}; };
        return of.msh();
    };
    const std::string text = "boundary body = translate 0.2 0.1\n" + rest;
    PeriodicDeck here(box(0), text), there(box(1e3), text);
    REQUIRE(here.run().outcome.code == 0);
    REQUIRE(there.run().outcome.code == 0);
    CHECK(std::abs(here.of("relative_quality") - there.of("relative_quality")) < 1e-6);
    CHECK(there.of("periodic_mismatch") <= 1e3 * 1e-13);
}

TEST_CASE("sectors whose sides turn into each other, in 2D and 3D") {
    for (const int dim : {2, 3})
        for (const bool simplices : {true, false}) {
            CAPTURE(dim); CAPTURE(simplices);
            PeriodicBox box{{6, 4, dim == 3 ? 4 : 0}, simplices};
            box.map = to_sector(30);
            const std::string turn = dim == 3 ? "rotate 1 axis 0 0 1 about 0 0 0\n" : "rotate 1 about 0 0\n";
            PeriodicDeck deck(box.msh(), "boundary body = " + turn + rest);
            deck.run();
            REQUIRE(deck.outcome.code == 0);
            CHECK(deck.of("periodic_mismatch") <= 1e-15);
            const Mesh before = mesh_of(deck.folder.path("box.msh")), after = mesh_of(deck.output + "/final.msh");
            for (const char* side : {"left", "right"}) CHECK(moved(before, after, side) > 1e-4);
            if (dim == 2) {
                deck.run({"degree=2", "refine=1"});
                REQUIRE(deck.outcome.code == 0);
                CHECK(deck.of("periodic_mismatch") <= 1e-15);
            }
        }
}

TEST_CASE("a box that is periodic in two or all directions") {
    for (const bool simplices : {true, false})
        for (const int directions : {2, 3}) {
            CAPTURE(simplices); CAPTURE(directions);
            PeriodicDeck deck(PeriodicBox{{4, 4, 4}, simplices, directions}.msh(),
                              "boundary body = translate 0.1 0.05 0.02\n" + std::string(directions == 2 ? rest : ""));
            deck.run();
            REQUIRE(deck.outcome.code == 0);
            CHECK(deck.of("periodic_mismatch") <= 1e-15);
            // With no walls the whole box goes with the body.
            const Mesh before = mesh_of(deck.folder.path("box.msh")), after = mesh_of(deck.output + "/final.msh");
            if (directions == 3) CHECK(std::abs(moved(before, after, "left") - 0.05) < 1e-6);
            else CHECK(moved(before, after, "left") > 1e-3);
        }
}

TEST_CASE("a line of its own ends a pair, and without one `rest` is not needed") {
    const std::string mesh = PeriodicBox{{8, 6, 0}}.msh(), body = "boundary body = translate 0.2 0.1\n";
    for (const char* line : {"boundary left = fixed\n", "boundary right = fixed\n"}) {
        PeriodicDeck deck(mesh, body + line + rest);
        REQUIRE(deck.run().outcome.code == 0);
        CHECK(has(deck.outcome.out, "note: no periodic sides move as one here: "));
        const Mesh before = mesh_of(deck.folder.path("box.msh")), after = mesh_of(deck.output + "/final.msh");
        for (const char* side : {"left", "right"}) CHECK(moved(before, after, side) == 0);
    }
    PeriodicDeck deck(mesh, body + "boundary top = fixed\nboundary bottom = fixed\n");
    CHECK(deck.run().outcome.code == 0);
    PeriodicDeck missing(mesh, body + "boundary top = fixed\nboundary left = fixed\n");
    const std::string lines = "boundary bottom = fixed\n  boundary right = fixed\nsides that are periodic";
    CHECK(has(missing.run().outcome.error, lines));
    PeriodicDeck still(mesh, rest);
    CHECK(still.run().outcome.code == 0);
    CHECK(text_of(still.output + "/final.msh") == mesh);
    CHECK(has(almesh_with({"info", deck.folder.path("box.msh")}).out, "\n# boundary left = fixed\n"));
}

TEST_CASE("walls beside periodic sides move alike at both, slide, or the run is refused") {
    const std::string mesh = PeriodicBox{{8, 6, 0}}.msh(), body = "boundary body = translate 0.1 0.05\n";
    PeriodicDeck along(mesh, body + "boundary top = expression \"x + 0.05*cos(pi*x)\" \"y + 0.1*cos(pi*x)\"\n" + rest);
    REQUIRE(along.run().outcome.code == 0);
    CHECK(along.of("periodic_mismatch") <= 1e-15);
    PeriodicDeck off(mesh, body + "boundary top = expression \"x\" \"y + 0.1*x\"\n" + rest);
    CHECK(off.run().outcome.code == 2);
    CHECK(has(off.outcome.error, "periodic sides cannot move as one: node "));
    CHECK(has(off.outcome.error, " of boundary top to (0, 1), but its image, node "));
    PeriodicDeck slide(mesh, body + "boundary top = slide\n" + rest);
    REQUIRE(slide.run().outcome.code == 0);
    CHECK(slide.of("periodic_mismatch") <= 1e-15);
    const Mesh before = mesh_of(slide.folder.path("box.msh")), after = mesh_of(slide.output + "/final.msh");
    CHECK(moved(before, after, "top") > 1e-3);
    for_face_nodes(before, [&](int f, std::size_t k) {
        if (before.boundaries[before.face_boundary[f]] != "top") return;
        CHECK(std::abs(point(after.x, before.faces[k], 2)[1] - 1) < 1e-12);
    });
}

TEST_CASE("a curve inside the mesh that is half of a pair does not drift") {
    std::string mesh = PeriodicBox{{8, 6, 0}}.msh();
    mesh.replace(mesh.find("1 2 1\n7"), 5, "1 7 1");  // the side `left` and the body
    PeriodicDeck deck(mesh, "boundary body = translate 0.2 0.1\n" + rest);
    REQUIRE(deck.run().outcome.code == 0);
    CHECK(deck.of("periodic_pairs") == 0);
    const Mesh before = mesh_of(deck.folder.path("box.msh")), after = mesh_of(deck.output + "/final.msh");
    CHECK(moved(before, after, "left") == 0);
}

TEST_CASE("frames keep periodic sides together") {
    PeriodicDeck deck(PeriodicBox{{8, 6, 0}}.msh(), "boundary body = translate \"0.1*sin(t)\" \"0.1*t\"\n" + rest);
    REQUIRE(deck.run({"frames=0:0.5:1"}).outcome.code == 0);
    for (const char* name : {"frame-0002.msh", "frame-0003.msh"}) {
        const Mesh mesh = mesh_of(deck.output + "/" + name);
        const std::vector<char> all(mesh.boundaries.size(), 1);
        const std::vector<int> free(mesh.nodes(), 0);
        const PeriodicPairs pairs = periodic_pairs(mesh, periodic_boundaries(mesh, all), free, 1);
        CHECK(pairs.pairs.size() == 7);
        CHECK(pairs.mismatch(mesh.x) <= 1e-15);
        CHECK(moved(mesh_of(deck.folder.path("box.msh")), mesh, "left") > 1e-3);
    }
}

TEST_CASE("improve keeps periodic sides together, and slides them") {
    for (const int dim : {2, 3}) {
        CAPTURE(dim);
        PeriodicBox box{{6, 6, dim == 3 ? 4 : 0}, true, 1};
        box.map = [](Vec<3> x) {
            const double pi = std::acos(-1.0);
            const double bump = std::sin(pi * x[1]) * std::sin(2 * pi * x[1]);
            return Vec<3>{x[0] + 0.04 * std::sin(pi * x[0]), x[1] + 0.12 * bump * std::cos(pi * x[0]), x[2]};
        };
        const TemporaryFolder folder;
        const std::string mesh = folder.write("box.msh", box.msh());
        const Outcome outcome = almesh_with({"improve", mesh, "output=" + folder.path("out"), "vtk=none"});
        REQUIRE(outcome.code == 0);
        CHECK(number(summary_of(folder.path("out")), "periodic_mismatch") <= 1e-15);
        CHECK(number(summary_of(folder.path("out")), "periodic_pairs") == (dim == 2 ? 7 : 35));
        CHECK(moved(mesh_of(mesh), mesh_of(folder.path("out/final.msh")), "left") > 1e-3);
    }
}

TEST_CASE("derivatives of meshes with periodic sides are those of runs") {
    for (const std::string wall : {"fixed", "slide"})
        for (const bool is_sector : {false, true}) {
            CAPTURE(wall); CAPTURE(is_sector);
            PeriodicBox box{{8, 6, 0}};
            if (is_sector) box.map = to_sector(30);
            PeriodicDeck deck(box.msh(), "let a = 1\nobjective = squared\nboundary top = " + wall + "\n" + rest +
                                             "boundary body = translate \"0.04*a^2\" \"0.03*a\"\n");
            REQUIRE(deck.run({"tangent"}).outcome.error == "");
            const Mesh mesh = mesh_of(deck.output + "/final.msh");
            std::vector<double> tangent;
            for (const auto& row : csv_rows(text_of(deck.output + "/tangent-a.csv")))
                for (std::size_t k = 1; k < row.size(); ++k)
                    if (const auto value = parse_double(row[k])) tangent.push_back(*value);
            REQUIRE(tangent.size() == mesh.x.size());
            std::vector<double> error = tangent;
            const double h = 1e-3;
            for (const int k : {-2, -1, 1, 2}) {
                REQUIRE(deck.run({"tangent", concat("let a=", 1 + k * h)}).outcome.error == "");
                const Mesh there = mesh_of(deck.output + "/final.msh");
                axpy((k == -2 ? -1 : k == -1 ? 8 : k == 1 ? -8 : 1) / (12 * h), there.x, error);
            }
            CHECK(norm_inf(error) < 1e-8 * norm_inf(tangent));

            std::string rows;  // of J: numbers at the nodes
            std::vector<double> J;
            for (int i = 0; i < mesh.nodes(); ++i) {
                rows += std::to_string(mesh.file.node_id[i]);
                for (int a = 0; a < 2; ++a) rows += concat(",", J.emplace_back(std::sin(1.0 + 3.7 * i + a)));
                rows += "\n";
            }
            const std::string file = deck.folder.write("J.csv", rows);
            const Outcome adjoint = almesh_with({"adjoint", deck.deck, file});
            REQUIRE(adjoint.error == "");
            const auto table = csv_rows(text_of(deck.output + "/adjoint-constants.csv"));
            const double difference = parse_double(table.at(1).at(2)).value() - dot(J, tangent);
            CHECK(std::abs(difference) < 1e-11 * norm_2(J) * norm_2(tangent));
        }
}
