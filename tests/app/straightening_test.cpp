#include "app/straightening.hpp"

#include <doctest/doctest.h>

#include <map>
#include <string>
#include <vector>

#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::map<std::string, std::string> straightened(const std::string& deck, const std::vector<std::string>& settings,
                                                std::string& out) {
    const TemporaryFolder folder;
    std::vector<std::string> arguments = {deck, "surface=straighten", "vtk=none", "output=" + folder.path("results")};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    const Outcome outcome = almesh_with(arguments);
    CAPTURE(outcome.error);
    CHECK((outcome.code == 0 || outcome.code == 5));  // 5: the deck expects the worst eta of sliding nodes
    CHECK(almesh_with({"quality", folder.path("results/final.msh")}).code == 0);
    out = outcome.out;
    return summary_of(folder.path("results"));
}

}  // namespace

TEST_CASE("a folded CAD surface with flat faces where it is folded, and no others where a run is only cut short") {
    std::string out;
    const auto summary = straightened("inputs/cad/torus.deck", {}, out);
    CHECK(has(out, "8 faces there are made flat:"));
    CHECK(has(out, "8 faces of 314 made flat\n"));
    CHECK(has(out, "distance of the faces from the target as it came"));
    CHECK(has(out, "\ntorus        314      24 "));  // the flat ones, and those that share edges with them
    CHECK(summary.at("status") == "converged");
    CHECK(summary.at("certified_injective") == "yes");
    CHECK(summary.at("straight_faces") == "8");
    CHECK(summary.at("nodes_off_target") == "0");
    CHECK(number(summary, "boundary_distance") > 0);
    CHECK(number(summary, "boundary_distance") < 0.06);
    CHECK(number(summary, "relative_boundary_distance") > number(summary, "boundary_distance"));
    CHECK(number(summary, "relative_boundary_distance") < 0.15);
}

TEST_CASE("faces that hold up the run are made flat too, until a mesh is certified") {
    std::string out;
    const auto summary = straightened("inputs/cad/torus.deck", {"max_newton_iterations=1"}, out);
    CHECK(has(out, " faces to be made flat, in addition to 8: "));
    CHECK(summary.at("status") == "converged");
    CHECK(summary.at("certified_injective") == "yes");
    CHECK(std::stoi(summary.at("straight_faces")) > 8);
    CHECK(summary.at("nodes_off_target") == "0");
}

TEST_CASE("a run whose sliding nodes do not find their way names the way out") {
    const TemporaryFolder folder;
    for (const std::string local_repair : {"0", "1"}) {
        const Outcome outcome =
            almesh_with({"inputs/cad/torus.deck", "max_newton_iterations=1", "continuation=never", "vtk=none",
                         "local_repair=" + local_repair, "output=" + folder.path("results")});
        CHECK(outcome.code == 3);
        CHECK(has(outcome.out, local_repair == "0"
                                   ? "surface = straighten: faces become flat where nodes now slide"
                                   : "surface = straighten and local_repair = 0: faces "));
    }
}
