// The small decks of the paper, from the repository's top folder, where `make test` runs.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

#include "app/commands.hpp"
#include "deck/deck.hpp"
#include "base/text.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the small decks of the paper hold what they expect") {
    if (!std::filesystem::is_directory("inputs")) {
        MESSAGE("no folder inputs here: run the tests from the repository's top folder");
        return;
    }
    for (const char* name :
         {"circle", "circle-refined-1", "circle-refined-2", "circle-printed", "circle-size-shape", "curving",
          "curving-printed"}) {
        CAPTURE(name);
        const TemporaryFolder folder;
        const std::string deck = std::string("inputs/") + name + ".deck";
        CHECK(read_deck(deck).expectations.size() >= 5);
        const Outcome outcome = almesh_bounded({deck, "output=" + folder.path("out"), "threads=1"});
        CAPTURE(outcome.out);
        REQUIRE(outcome.code == 0);
        CHECK(outcome.error.empty());
        CHECK(has(outcome.out, "expectations of the deck hold"));
    }
}

TEST_CASE("the decks of inputs/slide hold what they expect") {
    if (!std::filesystem::is_directory("inputs")) return;
    for (const char* name : {"bump", "rotor", "piston", "half-aircraft", "onto-bump"}) {
        CAPTURE(name);
        const TemporaryFolder folder;
        const Outcome outcome =
            almesh_bounded({std::string("inputs/slide/") + name + ".deck", "output=" + folder.path("out")});
        CAPTURE(outcome.out);
        REQUIRE(outcome.code == 0);
        CHECK(has(outcome.out, "slides along"));
    }
}

namespace {

void check_deck(const std::string& name) {
    CAPTURE(name);
    const TemporaryFolder folder;
    const Outcome outcome = almesh_bounded({"inputs/" + name + ".deck", "output=" + folder.path("out"), "vtk=none"});
    CAPTURE(outcome.out);
    REQUIRE(outcome.code == 0);
}

}  // namespace

TEST_CASE("the decks of inputs/targets, inputs/cad and inputs/cells hold what they expect") {
    if (!std::filesystem::is_directory("inputs")) return;
    for (const char* name : {"targets/flap", "targets/wave", "cad/torus", "cad/narrow-face", "cad/sphere-pole",
                             "cad/all-edges", "cad/concave-edge", "cad/tangent-faces", "cells/circle",
                             "cells/circle-far", "cells/circle-turned", "cells/curving", "cells/airfoil"})
        check_deck(name);
}

TEST_CASE("decks that take seconds hold what they expect" * doctest::test_suite("long")) {
    if (!std::filesystem::is_directory("inputs")) return;
    for (const char* name :
         {"cad/cylinder-box", "cad/layers", "cad/torus-in-sphere", "cad/ellipsoid", "cad/sliver-face", "cad/poles",
          "cad/cone-apex", "cad/torus-seam", "cad/face-twice", "slide/finer-surface", "gauntlet/sphere-layers-degree-2",
          "gauntlet/shell-moved"})
        check_deck(name);
}

TEST_CASE("a deck that takes its walls from the final mesh of another one") {
    if (!std::filesystem::is_directory("inputs")) return;
    const TemporaryFolder folder;
    REQUIRE(almesh_bounded({"inputs/targets/wave.deck", "output=" + folder.path("wave"), "vtk=none"}).code == 0);
    const Outcome outcome = almesh_bounded({"inputs/targets/from-wave.deck", "output=" + folder.path("out"), "vtk=none",
                                            "boundary all=mesh " + folder.path("wave/final.msh")});
    CAPTURE(outcome.out);
    CHECK(outcome.code == 0);
}

TEST_CASE("small decks of large motions hold what their decks expect") {
    if (!std::filesystem::is_directory("inputs")) return;
    for (const char* name : {"circle-turned", "circle-refined-turned", "plate-turned", "plate-degree-2", "block-turned",
                             "airfoil-pitched", "airfoil-turned", "airfoil-layers", "layers-degree-4", "torus",
                             "circle-turned-worst", "circle-quarter-worst", "circle-moved-worst"})
        check_deck(std::string("gauntlet/") + name);
}

TEST_CASE("a body turned by any angle: converged and valid, and never a leap in the number of Newton steps") {
    if (!std::filesystem::is_directory("inputs")) return;
    for (const std::string body : {"circle", "plate", "block"}) {
        int before = 5;
        for (int angle = 10; angle <= 360; angle += 10) {
            CAPTURE(body);
            CAPTURE(angle);
            const TemporaryFolder folder;
            const std::string boundary = body == "circle" ? "inner" : body;
            almesh_bounded({"inputs/gauntlet/" + body + "-turned.deck", "output=" + folder.path("out"), "vtk=none",
                            "boundary " + boundary + "=rotate " + std::to_string(angle) + " about 0 0"});
            const auto summary = summary_of(folder.path("out"));
            REQUIRE(summary.at("status") == "converged");
            CHECK(summary.at("certified_injective") == "yes");
            CHECK(summary.at("nodes_off_target") == "0");
            const int steps = static_cast<int>(number(summary, "newton_iterations")) +
                              static_cast<int>(number(summary, "earlier_newton_iterations"));
            CHECK(steps <= 3 * before);
            before = std::max(steps, 5);
        }
    }
}

TEST_CASE("the circle moved up to the outer boundary: every deck's objective gets there, and nothing goes beyond") {
    if (!std::filesystem::is_directory("inputs")) return;
    const auto run = [](const std::string& distance, const char* objective, const TemporaryFolder& folder) {
        return almesh_bounded({"inputs/gauntlet/circle-turned.deck", "output=" + folder.path("out"), "vtk=none",
                               objective, "boundary inner=translate " + distance + " 0"});
    };
    for (const char* objective : {"objective=squared", "objective=deviation"})
        for (const char* distance : {"2", "8", "14", "18", "19", "19.5", "19.8", "19.9"}) {
            CAPTURE(objective);
            CAPTURE(distance);
            const TemporaryFolder folder;
            run(distance, objective, folder);
            const auto summary = summary_of(folder.path("out"));
            REQUIRE(summary.at("status") == "converged");
            CHECK(summary.at("certified_injective") == "yes");
            CHECK(summary.at("nodes_off_target") == "0");
            CHECK(number(summary, "newton_iterations") <= 160);
        }
    for (const char* distance : {"20", "21", "30"}) {  // through the outer boundary, and past it
        const TemporaryFolder folder;
        CHECK(run(distance, "objective=squared", folder).code == 2);
    }
}

TEST_CASE("thin layers at a wall that moves far: converged means that the wall is where its cells need it") {
    if (!std::filesystem::is_directory("inputs")) return;
    double error[2];
    int k = 0;
    for (const char* tolerance : {"wall_tolerance=1e9", "wall_tolerance=1e-4"}) {
        const TemporaryFolder folder;
        CHECK(almesh_bounded({"inputs/curving.deck", "output=" + folder.path("out"), "vtk=none", "degree=1",
                              "algorithm=adaptive", "epsilon_star=1e-6", tolerance,
                              "boundary wall=rotate 20 about 0 0; translate 3 -5", "boundary outer=fixed"})
                  .code == 5);
        const auto summary = summary_of(folder.path("out"));
        REQUIRE(summary.at("status") == "converged");
        const auto rows = history_without_times(folder.path("out"));  // before nodes are set to their targets
        const auto column = std::find(rows[0].begin(), rows[0].end(), "relative_boundary_error") - rows[0].begin();
        error[k++] = std::stod(rows.back()[column]);
    }
    CHECK(error[0] > 1e-3);
    CHECK(error[1] < 1e-4);
}

// With one of them power 4 takes a single loose step, which raises the worst eta.
TEST_CASE("objective = minimax goes on to high powers where an early one is solved loosely" * doctest::test_suite("long")) {
    if (!std::filesystem::is_directory("inputs")) return;
    for (const char* preconditioner : {"preconditioner=pmg", "preconditioner=ssor"}) {
        CAPTURE(preconditioner);
        const TemporaryFolder folder;
        almesh_bounded({"inputs/sphere-shell.deck", "output=" + folder.path("out"), "vtk=none", "algorithm=adaptive",
                        "objective=minimax", preconditioner});
        const auto summary = summary_of(folder.path("out"));
        REQUIRE(summary.at("status") == "converged");
        CHECK(number(summary, "max_distortion") <= 1.045);
    }
}

// The paper's decks leave it to their algorithm, and here they are run with another.
std::string weight_of(const std::string& deck) {
    return deck.find("weighted") == std::string::npos ? "weight_exponent=1" : "weight_exponent=0.5";
}

// The largest entry of a column of history.csv over all Newton steps, such as cuts_inverted: the trial lengths refused
// because an element was inverted.
int most_in_a_step(const char* name, const std::string& folder) {
    const auto rows = history_without_times(folder);
    const auto column = std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin();
    int most = 0;
    for (const auto& row : rows)
        if (row[0] == "newton") most = std::max(most, std::stoi(row[column]));
    return most;
}

// Each from the identity map, with the deck's own final tolerances.
TEST_CASE("algorithm = adaptive takes few Newton steps on the decks of the paper, whatever the refinement" * doctest::test_suite("long")) {
    if (!std::filesystem::is_directory("inputs")) return;
    struct Bound {
        const char *name, *setting;
        int newton;
    };
    for (const Bound& bound : {Bound{"circle", "refine=0", 9}, Bound{"circle", "refine=2", 9},
                               Bound{"circle", "refine=3", 9}, Bound{"circle", "refine=4", 9},
                               Bound{"circle-printed", "refine=0", 9}, Bound{"circle-printed", "refine=2", 9},
                               Bound{"circle-printed", "refine=3", 16}, Bound{"circle-printed", "refine=4", 16},
                               Bound{"curving", "refine=0", 8}, Bound{"curving-printed", "refine=0", 14},
                               Bound{"aircraft", "refine=0", 17}, Bound{"aircraft-weighted", "refine=0", 12}}) {
        CAPTURE(bound.name);
        CAPTURE(bound.setting);
        const TemporaryFolder folder;
        const std::string deck = std::string("inputs/") + bound.name + ".deck";
        almesh_bounded({deck, "output=" + folder.path("out"), "vtk=none", "algorithm=adaptive", weight_of(deck),
                        "start=identity", bound.setting});
        const auto summary = summary_of(folder.path("out"));
        REQUIRE(summary.at("status") == "converged");
        CHECK(summary.at("certified_valid") == "yes");
        CHECK(number(summary, "newton_iterations") <= bound.newton);
        // Damping has learned from the steps before: no row of hopeless trials.
        CHECK(most_in_a_step("cuts_inverted", folder.path("out")) <= 5);
    }
}

TEST_CASE("conjugate gradients take few iterations to 1e-8 in every Newton step of the aircraft, however soft" * doctest::test_suite("long")) {
    if (!std::filesystem::is_directory("inputs")) return;
    struct Bound {
        const char* preconditioner;
        int iterations;
    };
    for (const std::string deck : {"inputs/aircraft.deck", "inputs/aircraft-weighted.deck"})
        for (const std::string algorithm : {"algorithm=paper", "algorithm=adaptive"})
            for (const Bound& bound : {Bound{"ilu0", 60}, Bound{"ssor", 75}}) {  // an iteration costs less with SSOR
                CAPTURE(deck);
                CAPTURE(algorithm);
                CAPTURE(bound.preconditioner);
                const TemporaryFolder folder;
                Deck settings = read_deck(
                    deck, {"output=" + folder.path("out"), "vtk=none", algorithm, weight_of(deck), "forcing=fixed",
                           "max_al_iterations=8", "max_newton_iterations=20",
                           concat("preconditioner=", bound.preconditioner)});
                settings.linear.tolerance = 1e-8;
                const std::string report = folder.path("report.txt");
                const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(report.c_str(), "w"), std::fclose);
                REQUIRE(run(settings, out.get()) == ExitCode::success);
                std::fflush(out.get());
                CHECK_FALSE(has(text_of(report), "the iterative solver failed"));
                CHECK(most_in_a_step("linear_iterations", folder.path("out")) <= bound.iterations);
            }
}

TEST_CASE("local elimination acts from the eleventh step of a subproblem on, and in the subproblems after it") {
    if (!std::filesystem::is_directory("inputs")) return;
    const TemporaryFolder folder;
    CHECK(almesh_bounded({"inputs/circle.deck", "output=" + folder.path("out"), "vtk=none", "algorithm=adaptive",
                          "start=identity", "boundary inner=translate 19 0"}).code != 3);
    const auto rows = history_without_times(folder.path("out"));
    const auto column = [&](const char* name) {
        return std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin();
    };
    int early = 0, relaxed = 0, newton = 0, later = 0;
    for (const auto& row : rows) {
        if (row[0] != "newton") continue;
        const int steps = std::stoi(row[column("local_steps")]), nodes = std::stoi(row[column("local_nodes")]);
        const bool first = row[column("al_iteration")] == "1";
        if (first && std::stoi(row[column("newton_iteration")]) <= 10) early += nodes;
        if (!first) later += nodes;
        CHECK((steps > 0) <= (nodes > 0));
        relaxed += steps;
        ++newton;
    }
    REQUIRE(newton > 10);
    CHECK(early == 0);
    CHECK(relaxed > 0);
    CHECK(later > 0);
    CHECK(number(summary_of(folder.path("out")), "local_steps") == relaxed);
}

TEST_CASE("the decks of the lessons hold what they expect, and curving works in 3D") {
    if (!std::filesystem::is_directory("inputs")) return;
    const TemporaryFolder folder;
    const std::string output = "output=" + folder.path("out");
    CHECK(almesh_bounded({"inputs/channel-bump.deck", output}).code == 0);
    CHECK(almesh_bounded({"inputs/sphere-shell.deck", output, "degree=2"}).code == 0);
    const Outcome literal = almesh_bounded({"inputs/circle-literal.deck", output});
    CHECK(literal.code == 3);
    CHECK(has(literal.out, "expectations of the deck hold"));
}

TEST_CASE("curved surfaces inside the mesh are no boundary that elements could lie over") {
    if (!std::filesystem::is_directory("inputs")) return;
    for (const char* name : {"slides", "solid-3d"}) {
        const TemporaryFolder folder;
        const Outcome outcome =
            almesh_bounded({std::string("inputs/inner/") + name + ".deck", "output=" + folder.path("out")});
        CAPTURE(outcome.out);
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, "certified valid and injective"));
    }
}

TEST_CASE("every deck in inputs can be read, and its mesh is there") {
    if (!std::filesystem::is_directory("inputs")) return;
    int decks = 0;
    for (const auto& entry : std::filesystem::directory_iterator("inputs")) {
        if (entry.path().extension() != ".deck") continue;
        ++decks;
        CAPTURE(entry.path().string());
        const Deck deck = read_deck(entry.path().string());
        CHECK(std::filesystem::is_regular_file(deck.mesh));
        CHECK(!deck.title.empty());
        CHECK(deck.boundaries.size() >= 2);
    }
    CHECK(decks >= 11);
}
