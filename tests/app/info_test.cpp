#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "io/msh.hpp"
#include "support/meshes.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("info tells what is in a mesh, and is a deck that runs") {
    const RingDeck ring;
    const std::string mesh = ring.folder.path("ring.msh");
    const Outcome told = almesh_with({"info", mesh});
    CHECK(told.code == 0);
    CHECK(has(told.out, "ring.msh, MSH 2.2, ASCII: 48 nodes, 72 triangles of degree 1"));
    CHECK(has(told.out, "(-6, -6) to (6, 6)"));
    CHECK(has(told.out, "inner   12 faces, 12 nodes, (-1, -1) to (1, 1)"));
    CHECK(has(told.out, "all elements certified valid, none overlap"));
    const std::string deck = ring.folder.write("from_info.deck", told.out);
    const Outcome run = almesh_with({deck, "output=" + ring.output, "boundary inner=translate 1 0"});
    CAPTURE(run.error);
    CHECK(run.code == 0);
    CHECK(almesh_with({"info"}).code == 1);
    CHECK(almesh_with({"info", ring.folder.path("nothing.msh")}).code == 2);
}

TEST_CASE("a deck from info runs from any folder") {
    const RingDeck ring;
    const auto here = std::filesystem::current_path();
    std::filesystem::current_path(ring.folder.path());
    const Outcome told = almesh_with({"info", "ring.msh"});
    std::filesystem::create_directories("far/away");
    std::filesystem::current_path("far/away");
    std::ofstream("my.deck") << told.out;
    const Outcome run = almesh_with({"my.deck"});
    const bool has_result = std::filesystem::exists("outputs/ring/final.msh");
    std::filesystem::current_path(here);
    CAPTURE(run.error);
    CHECK(run.code == 0);
    CHECK(has_result);
}

TEST_CASE("info tells the format of a file, and what comes along with the mesh") {
    const Outcome told = almesh_with({"info", "tests/io/data/interface-41.msh"});
    CHECK(told.code == 0);
    CHECK(has(told.out, "interface-41.msh, MSH 4.1, binary: 9 nodes, 2 triangles of degree 2\n"));
    CHECK(has(told.out, "# carried along with the mesh: 1 point, 1 line inside the mesh, in no group or repeated, 1 node without an element (not moved)\n"));
}

TEST_CASE("info lists the groups inside and the volumes, with lines to uncomment, and keeps the keys given") {
    const Outcome told = almesh_with({"info", "inputs/meshes/inclusion.msh", "threads=1", "degree=2"});
    CHECK(told.code == 0);
    CHECK(has(told.out, "# Boundaries:\n#   far        51 faces, 51 nodes, "));
    CHECK(has(told.out, "# Inside the mesh (free unless a line moves them):\n#   interface  16 faces, 16 nodes, "));
    CHECK(has(told.out, "# Volumes (free unless a line moves them):\n#   solid      "));
    CHECK(has(told.out, "#   fluid      "));
    CHECK(has(told.out, "\ndegree = 2\nthreads = 1\nboundary far = fixed\n# boundary interface = fixed\n# volume solid = fixed\n"
                        "# volume fluid = fixed\n"));
}

TEST_CASE("lines that are given to info stand in its deck") {
    const Outcome told = almesh_with({"info", "inputs/meshes/inclusion.msh", "boundary interface=translate 1 0",
                                      "boundary far=slide", "continuation=never"});
    CHECK(has(told.out, "\nboundary far = slide\nboundary interface = translate 1 0\n# volume solid = fixed\n"));
    CHECK(has(told.out, "\ncontinuation = never\n"));
}

TEST_CASE("info numbers the smooth parts of a boundary that the file does not name") {
    const TemporaryFolder folder;
    Mesh cube = cube_mesh(1);
    for (int& tag : cube.file.face_physical) tag = 0;
    cube.faces.clear();
    cube.file.face_id.clear();
    cube.file.face_physical.clear();
    cube.file.face_entity.clear();
    const std::string mesh = folder.write("cube.msh", msh_text(cube, cube.x));
    const Outcome told = almesh_with({"info", mesh});
    CHECK(has(told.out, "# Smooth parts of the boundary, cut at angles above 30 degrees (select NAME = part NUMBER):\n"));
    CHECK(has(told.out, "#   part 6  2 faces, "));
    CHECK(has(told.out, "mean normal (0.000, 0.000, 1.000)"));
    CHECK(!has(told.out, "part 7"));
    CHECK(has(almesh_with({"info", mesh, "feature_angle=120"}).out, "#   part 1  12 faces, "));
}
