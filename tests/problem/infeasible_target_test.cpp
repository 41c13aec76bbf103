// split = auto and around: what is written, whatever the format.
#include "problem/infeasible_target.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "check/certificate.hpp"
#include "io/su2.hpp"
#include "support/meshes.hpp"
#include "support/msh_formats.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::string node_data = "$NodeData\n1\n\"T\"\n1\n0\n3\n0\n1\n2\n1 0.5\n3 0.25\n$EndNodeData\n";
const std::string corner_data = "$ElementNodeData\n1\n\"T\"\n1\n0\n3\n0\n1\n1\n7 3 1 2 3\n$EndElementNodeData\n";

// The unit square, whose corner (1, 0) is pushed in until it is wider than 180 degrees. `mesh`: of its file.
std::string dented_square(const TemporaryFolder& folder, const std::string& mesh) {
    const std::string by = "0.3*x^2*(1 - y)^2\"";
    return folder.write("square.deck", "mesh = " + mesh + "\nthreads = 1\nsplit = auto\noutput = " + folder.path("out") +
                                           "\nboundary rest = expression \"x - " + by + " \"y + " + by + "\n");
}

void check_mesh(const Mesh& before, const Mesh& after) {
    CHECK(after.nodes() > before.nodes());
    CHECK(after.element_count() == before.element_count() + 2);
    for (const auto ids : {&FileTags::node_id, &FileTags::element_id, &FileTags::face_id}) {
        if (before.file.format.ending == ".su2" && ids == &FileTags::face_id) continue;  // it has none
        std::vector<long long> old = before.file.*ids, now = after.file.*ids;
        std::sort(old.begin(), old.end());
        std::sort(now.begin(), now.end());
        CHECK(std::includes(now.begin(), now.end(), old.begin(), old.end()));
    }
    CHECK(after.boundaries == before.boundaries);
    CHECK(after.face_count() == before.face_count());
    CHECK(certify(after, after.x).valid);
}

}  // namespace

TEST_CASE("split = auto in every format that is written anew, and degree: all that was in the file is there, and two elements more") {
    const Mesh linear = square_mesh(4);
    for (const int degree : {1, 2, 3})
        for (const int version : {22, 41})
            for (const bool binary : {false, true}) {
                CAPTURE(degree);
                CAPTURE(version);
                Mesh before = raise_degree(linear, degree);
                before.file.format = {".msh", version, binary};
                const TemporaryFolder folder;
                folder.write("square.msh", msh_text(before, before.x, before.file.format));
                const Outcome outcome = almesh_with({dented_square(folder, "square.msh")});
                CAPTURE(outcome.error);
                REQUIRE(outcome.code == 0);
                CHECK(has(outcome.out, "divided by 1 node inside, the mesh has 2 elements more:\n  triangle "));
                check_mesh(before, mesh_of(folder.path("out/final.msh")));
            }
}

TEST_CASE("split = auto of an SU2 file") {
    const Mesh before = square_mesh(4);
    const TemporaryFolder folder;
    write_su2(folder.path("square.su2"), before, before.x);
    REQUIRE(almesh_with({dented_square(folder, "square.su2")}).code == 0);
    check_mesh(mesh_of(folder.path("square.su2")), mesh_of(folder.path("out/final.su2")));
}

TEST_CASE("a mesh that is split says that the data of its file are left out") {
    const Mesh before = square_mesh(4);
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(before) + node_data + corner_data);
    const Outcome outcome = almesh_with({dented_square(folder, "square.msh")});
    REQUIRE(outcome.code == 0);
    CHECK(has(outcome.out, "note: not in the final mesh, which is written anew: $NodeData, $ElementNodeData\n"));
    CHECK(!has(text_of(folder.path("out/final.msh")), "NodeData"));
}

TEST_CASE("where the elements that are divided do not suffice, split = around is advised, and does") {
    const TemporaryFolder folder;
    const std::string by = " - 1.4*y*(1 - y)*exp(-8*((1 - x)^2 + (1 - z)^2))\"";
    const std::string deck = folder.write(
        "dent.deck", "mesh = " + std::filesystem::absolute("inputs/meshes/cube.msh").string() + "\noutput = " +
                         folder.path("out") + "\nboundary all = expression \"x" + by + " \"y\" \"z" + by + "\n");
    const Outcome divided = almesh_with({deck, "split=auto", "target=least_squares"});
    CHECK(divided.code == 3);
    CHECK(has(divided.out, "\ntry split = around; "));
    const auto elements = number(summary_of(folder.path("out")), "elements");
    CHECK(almesh_with({deck, "split=around", "target=least_squares"}).code == 0);
    CHECK(number(summary_of(folder.path("out")), "elements") > elements);
    CHECK(summary_of(folder.path("out")).at("split_elements") == "7");
}

TEST_CASE("a target that no element can mend is refused with the elements of the file") {
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(square_mesh(4)));
    const std::string deck = dented_square(folder, "square.msh");
    std::vector<Outcome> outcomes;
    for (const std::string setting : {"split=auto", "split=never"})
        outcomes.push_back(almesh_with({deck, setting, "boundary rest=expression \"0.3*x\" \"-y\""}));
    CHECK(outcomes[0].code == 2);
    CHECK(has(outcomes[0].error, "the target makes the boundary itself invalid at 1 face and 2 elements:\n"));
    CHECK(outcomes[0].error == outcomes[1].error);
}

TEST_CASE("local_repair = 1 leaves the elements as they are: no split") {
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(square_mesh(4)));
    const Outcome outcome =
        almesh_with({dented_square(folder, "square.msh"), "boundary rest=fixed", "local_repair=1"});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.error, ": split does not go with local_repair = 1"));
}
