// What the program refuses before it solves anything: exit codes 1 and 2, with what, where and what to do.
#include <doctest/doctest.h>

#include <cmath>

#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

void check_refused(const Outcome& outcome, int code, const std::vector<std::string>& parts) {
    CAPTURE(outcome.error);
    CHECK(outcome.code == code);
    CHECK(outcome.error.starts_with("almesh: "));
    CHECK(outcome.error.ends_with('\n'));
    for (const std::string& part : parts) {
        CAPTURE(part);
        CHECK(has(outcome.error, part));
    }
}

// A run of ring.deck on another mesh file.
Outcome run_on(const std::string& msh) {
    const RingDeck ring;
    ring.folder.write("ring.msh", msh);
    const Outcome outcome = ring.run();
    CHECK(!std::filesystem::exists(ring.output));
    return outcome;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("faults of the deck: code 1 with file, line and advice, nothing written") {
    for (const auto& [lines, parts] : std::vector<std::pair<std::string, std::vector<std::string>>>{
             {"max_al_iteration = 3\n", {"ring.deck:6: ", "`max_al_iteration`", "did you mean `max_al_iterations`?"}},
             {"refine = 0\nrefine = 1\n", {"ring.deck:7: ", "`refine` is already set", "ring.deck:6"}},
             {"objective = cubed\n", {"ring.deck:6: ", "squared | deviation"}},
             {"refine = 9\n", {"ring.deck:6: ", "integer in 0..8"}},
             {"boundary wing = fixed\n", {"ring.deck:6: ", "\"wing\"", "\"inner\"", "\"outer\""}},
             {"boundary inner = fixed\n", {"ring.deck:6: ", "already set"}},
             {"wall = wing\n", {"ring.deck:6: ", "wall", "wing", "inner"}},
             {"expect quality >= 0.9\n", {"ring.deck:6: ", "`quality`", "did you mean"}},
             {"just some words\n", {"ring.deck:6: ", "key = value"}}}) {
        const RingDeck ring(ring_mesh(12, 3, 6), lines);
        check_refused(ring.run(), 1, parts);
        CHECK(!std::filesystem::exists(ring.output));
    }
}

TEST_CASE("a boundary without a motion, and motions of another dimension: code 1") {
    const RingDeck ring;
    ring.folder.write("ring.deck", "mesh = ring.msh\noutput = " + ring.output + "\nboundary inner = fixed\n");
    check_refused(ring.run(), 1,
                  {"ring.deck", "1 boundary line missing", "boundary rest = fixed", "\n  boundary outer = fixed"});
    check_refused(ring.run({"boundary outer=translate 1 0 0"}), 1, {"command line", "\"outer\"", "2 components in 2D"});
    check_refused(ring.run({"boundary outer=sphere 0 0 0 1"}), 1, {"command line", "use a circle"});
}

TEST_CASE("a deck that is not there, is a folder, a mesh, or names no mesh: code 1") {
    const RingDeck ring;
    check_refused(almesh_with({ring.folder.path("none.deck")}), 1, {"none.deck"});
    check_refused(almesh_with({ring.folder.path()}), 1, {"folder"});
    check_refused(almesh_with({ring.folder.path("ring.msh")}), 1, {"ring.msh:1: "});
    check_refused(almesh_with({ring.folder.write("empty.deck", "")}), 1, {"empty.deck", "mesh = FILE"});
}

TEST_CASE("mesh files that cannot be read: code 2, naming the file") {
    const RingDeck ring;
    std::filesystem::remove(ring.folder.path("ring.msh"));
    check_refused(ring.run(), 2, {ring.folder.path("ring.msh")});
    std::filesystem::create_directory(ring.folder.path("ring.msh"));
    check_refused(ring.run(), 2, {ring.folder.path("ring.msh")});
    check_refused(run_on(""), 2, {"ring.msh", "empty"});
    check_refused(run_on(std::string("$MeshFormat\n4.1 1 8\n\1\0\0\0", 24)), 2,
                  {"ring.msh: $MeshFormat, byte 24", "cut off"});
    check_refused(run_on("$MeshFormat\n4.1 1 8\n$EndMeshFormat\n"), 2,
                  {"ring.msh: $MeshFormat, byte 20", "order of bytes"});
    check_refused(run_on("$MeshFormat\n3.0 0 8\n$EndMeshFormat\n"), 2, {"ring.msh:2", "2.2, 4.0 and 4.1"});
    check_refused(run_on("solid cube\nfacet normal 0 0 1\n"), 2, {"ring.msh:1", "not a Gmsh mesh file"});
}

TEST_CASE("mesh files whose contents cannot be meant: code 2 with file and line") {
    for (int version : {22, 41}) {
        Mesh mesh = ring_mesh(8, 1, 2);
        mesh.file.format.msh_version = version;
        const std::string good = msh_of(mesh);
        check_refused(run_on(good.substr(0, good.size() / 2)), 2, {"ring.msh:"});
        check_refused(run_on(good.substr(0, good.find("$Elements"))), 2, {"ring.msh", "$Elements"});
    }
    const std::string good = msh_of(ring_mesh(8, 1, 2)), nodes = "$Nodes\n16\n", first = nodes + "1 1 0 0\n";
    check_refused(run_on(replaced(good, nodes, "$Nodes\n2000000000\n")), 2,
                  {"ring.msh:", "announces 2000000000 nodes, only 16"});
    check_refused(run_on(replaced(good, nodes, "$Nodes\n15\n")), 2,
                  {"ring.msh:", "$Nodes holds more than it announces"});
    check_refused(run_on(replaced(good, first, nodes + "2 1 0 0\n")), 2, {"ring.msh:", "node id 2 is there twice"});
    check_refused(run_on(replaced(good, first, nodes + "1 nan 0 0\n")), 2, {"ring.msh:"});
    check_refused(run_on(replaced(good, first, nodes + "99 1 0 0\n")), 2,
                  {"ring.msh:", "node 1, which is not in $Nodes"});
    check_refused(
        run_on("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n"
               "$Elements\n1\n1 3 2 1 1 1 2 3 4\n$EndElements\n"),
        2, {"ring.msh:13: ", "quadrangle"});
}

TEST_CASE("a quadrature that cannot see the nodes inside an element: code 1, naming the line") {
    const RingDeck ring(ring_mesh(8, 2, 4));
    check_refused(ring.run({"degree=3", "quadrature=1"}), 1,
                  {"command line: quadrature = 1", "degree 3", "at least 4"});
}

// All boundary nodes are where they should be, but an inner one lies outside its neighbours.
TEST_CASE("a mesh that is tangled from the start: code 2, naming an element") {
    Mesh mesh = ring_mesh(12, 3, 6);
    mesh.x[2 * 12] += 3;
    check_refused(run_on(msh_of(mesh)), 2, {"ring.msh", "element "});
}

TEST_CASE("targets that make the boundary itself invalid: code 2, naming faces before anything is solved") {
    // In a curved file, the middle node of an edge far from its middle.
    Mesh folded = raise_degree(ring_mesh(6, 2, 4), 2);
    int bad = -1;
    for (int f = 0; f < folded.face_count(); ++f)
        if (folded.boundaries[folded.face_boundary[f]] == "inner") bad = f;
    double* const middle = &folded.x[2 * folded.face(bad)[2]];
    const double* const end = &folded.x[2 * folded.face(bad)[0]];
    for (int a = 0; a < 2; ++a) middle[a] = 0.05 * middle[a] + 0.95 * end[a];
    const RingDeck ring(folded);
    check_refused(ring.run(), 2,
                  {"the target makes the boundary itself invalid at 1 face", "folds the face back",
                   "face " + std::to_string(folded.file.face_id[bad]) + " of inner"});
    CHECK(!std::filesystem::exists(ring.output));

    // Onto the closest points of a circle elsewhere: the whole inner boundary falls on one side of that.
    const RingDeck far;
    check_refused(far.run({"boundary inner=circle 9 0 1"}), 2,
                  {"the target makes the boundary itself invalid", "of inner at ("});
}

TEST_CASE("a projection that is not defined, or boundaries that are torn apart: code 2") {
    const RingDeck ring;
    check_refused(ring.run({"boundary inner=circle 1 0 1"}), 2, {"boundary inner", "(1, 0)", "not defined"});
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(square_mesh(2)));
    const std::string deck =
        folder.write("square.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                                        "\nboundary left = translate -1 0\nboundary right = fixed\n"
                                        "boundary top = fixed\nboundary bottom = fixed\n");
    check_refused(
        almesh_with({deck}), 2,
        {"node 1 lies on two boundaries whose motions disagree", "left to (-1, 0)", "bottom takes it to (0, 0)"});
}

TEST_CASE("an output folder that cannot be made: code 2, before anything is solved") {
    const RingDeck ring;
    const std::string file = ring.folder.write("a_file", "not a folder\n");
    const Outcome outcome = ring.run({"output=" + file + "/results"});
    check_refused(outcome, 2, {file});
    CHECK(outcome.out.empty());
    check_refused(ring.run({"output=" + file}), 2, {file});
    CHECK(text_of(file) == "not a folder\n");
}
