#include "app/straightening.hpp"

#include <doctest/doctest.h>

#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("faces that hold up the run are made flat too, until a mesh is certified") {
    const TemporaryFolder folder;
    const Outcome outcome =
        almesh_with({"inputs/cad/torus.deck", "surface=straighten", "vtk=none", "output=" + folder.path("torus")});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "8 faces there are made flat:"));
    CHECK(has(outcome.out, " faces made flat, beside 8 that are: "));
    const auto summary = summary_of(folder.path("torus"));
    CHECK(summary.at("certified_injective") == "yes");
    CHECK(std::stoi(summary.at("straight_faces")) > 8);
    CHECK(std::stoi(summary.at("straight_faces")) < 314 / 2);
    CHECK(summary.at("nodes_off_target") == "0");
    CHECK(std::stod(summary.at("straightening_distance")) > 0);
    CHECK(std::stod(summary.at("straightening_distance")) < 0.1);
    CHECK(almesh_with({"quality", folder.path("torus/final.msh")}).code == 0);
}
