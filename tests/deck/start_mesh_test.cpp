// start = FILE: the first iterate from another file than the ideal mesh.
#include "deck/make_problem.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

double steps_of(const std::string& folder) { return number(summary_of(folder), "newton_iterations"); }

}  // namespace

TEST_CASE("from the mesh of an earlier run the same minimiser is found, relative to the same ideal mesh") {
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{}, {"degree=2"}, {"refine=1"}, {"algorithm=paper"}}) {
        const RingDeck ring;
        const std::string earlier = ring.folder.path("earlier"), straight = ring.folder.path("straight");
        const auto run = [&](std::vector<std::string> settings) {
            settings.insert(settings.end(), more.begin(), more.end());
            REQUIRE(ring.run(settings).code == 0);
        };
        run({"boundary inner=translate 1.9 0", "output=" + earlier});
        run({"start=identity", "output=" + straight});
        run({"start=" + earlier + "/final.msh"});
        const std::vector<double> x = mesh_of(ring.output + "/final.msh").x, y = mesh_of(straight + "/final.msh").x;
        REQUIRE(x.size() == y.size());
        for (std::size_t i = 0; i < x.size(); ++i) CHECK(std::abs(x[i] - y[i]) < 1e-5);
        for (const char* quantity : {"relative_quality", "max_distortion"})
            CHECK(number(summary_of(ring.output), quantity) ==
                  doctest::Approx(number(summary_of(straight), quantity)).epsilon(1e-6));
        CHECK(steps_of(ring.output) < steps_of(straight));
        CHECK(has(text_of(ring.output + "/deck.txt"), "\nstart = " + earlier + "/final.msh\n"));
    }
}

TEST_CASE("the elements of the file may stand in another order, and so may their nodes") {
    const RingDeck ring;
    Mesh mesh = ring_mesh(12, 3, 6);
    for (int i = 0; i < mesh.dim * mesh.nodes(); ++i) mesh.x[i] += 0.01 * std::sin(i);
    for (const int i : mesh.faces) std::copy_n(&ring_mesh(12, 3, 6).x[2 * i], 2, &mesh.x[2 * i]);
    ring.folder.write("in-order.msh", msh_of(mesh));
    std::vector<std::array<int, 3>> elements;
    for (int e = 0; e < mesh.element_count(); ++e)
        elements.push_back({mesh.element(e)[1], mesh.element(e)[2], mesh.element(e)[0]});
    std::reverse(elements.begin(), elements.end());
    for (int e = 0; e < mesh.element_count(); ++e) std::copy_n(elements[e].data(), 3, &mesh.elements[3 * e]);
    ring.folder.write("reversed.msh", msh_of(mesh));
    REQUIRE(ring.run({"start=" + ring.folder.path("in-order.msh")}).code == 0);
    const std::vector<double> x = mesh_of(ring.output + "/final.msh").x;
    REQUIRE(ring.run({"start=" + ring.folder.path("reversed.msh")}).code == 0);
    CHECK(mesh_of(ring.output + "/final.msh").x == x);
}

TEST_CASE("a file to start from that does not fit is refused, with what does not") {
    const RingDeck ring;
    const auto refusal = [&](const Mesh& mesh, const std::vector<std::string>& more = {}) {
        ring.folder.write("start.msh", msh_of(mesh));
        std::vector<std::string> settings = {"start=" + ring.folder.path("start.msh")};
        settings.insert(settings.end(), more.begin(), more.end());
        const Outcome outcome = ring.run(settings);
        CHECK((outcome.code == 1 || outcome.code == 2));
        CHECK(!std::filesystem::exists(ring.output));
        return outcome.error;
    };
    const Mesh fits = ring_mesh(12, 3, 6);
    CHECK(has(refusal(ring_mesh(12, 4, 6)), "it has 96 elements, the mesh of the run 72"));
    CHECK(has(refusal(fits, {"refine=1"}), "it has 72 elements, the mesh of the run 288"));
    CHECK(has(refusal(fits, {"degree=2"}), "it has no element of the nodes of element "));
    Mesh other = fits;
    std::swap(other.file.node_id[0], other.file.node_id[40]);
    CHECK(has(refusal(other), "it has no element of the nodes of element "));
    Mesh folded = fits;
    std::swap_ranges(&folded.x[0], &folded.x[2], &folded.x[2 * 30]);
    CHECK(has(refusal(folded), "it is not certified valid: the certified bound of element "));
    CHECK(has(ring.run({"start=none.msh"}).error, "command line: start = none.msh: cannot read none.msh"));
    CHECK(has(ring.run({"start=identitty"}).error, "did you mean `identity`?"));
    CHECK(has(ring.run({"start=" + ring.deck}).error, "start = "));
}
