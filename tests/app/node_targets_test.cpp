#include "app/node_targets.hpp"

#include <doctest/doctest.h>

#include <set>
#include <sstream>

#include "base/index.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Rows of the nodes of a boundary, moved by dx; as displacements where asked for.
std::string rows_of(const Mesh& mesh, const std::string& boundary, double dx, bool displacement, const char* comma) {
    std::set<int> nodes;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (mesh.boundaries[mesh.face_boundary[f]] == boundary)
            nodes.insert(mesh.face(f), mesh.face(f) + mesh.face_nodes());
    std::ostringstream out;
    out.precision(17);
    for (const int i : nodes) {
        out << mesh.file.node_id[i];
        for (int a = 0; a < mesh.dim; ++a)
            out << comma << (displacement ? 0 : mesh.x[offset(i, mesh.dim, a)]) + (a == 0 ? dx : 0);
        out << '\n';
    }
    return out.str();
}

double max_difference_of(const std::string& a, const std::string& b) {
    const Mesh left = mesh_of(a), right = mesh_of(b);
    double largest = 0;
    for (std::size_t i = 0; i < left.x.size(); ++i) largest = std::max(largest, std::abs(left.x[i] - right.x[i]));
    return largest;
}

}  // namespace

TEST_CASE("places, displacements and another run's mesh lead where the motion itself leads") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const std::string expected = ring.folder.write("expected.msh", text_of(ring.output + "/final.msh"));
    const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
    ring.folder.write("places.csv", "id, x, y\n# places\n" + rows_of(mesh, "inner", 2, false, ", "));
    ring.folder.write("moves.txt", rows_of(mesh, "inner", 2, true, " "));
    for (const std::string motion : {"file places.csv", "file moves.txt displacement", "mesh expected.msh"}) {
        CAPTURE(motion);
        const std::string deck = ring.folder.write(
            "by_file.deck", "mesh = ring.msh\noutput = " + ring.output + "\nboundary inner = " + motion +
                                "\nboundary rest = fixed\nthreads = 1\n");
        const Outcome outcome = almesh_with({deck});
        CAPTURE(outcome.error);
        REQUIRE(outcome.code == 0);
        CHECK(max_difference_of(ring.output + "/final.msh", expected) < 1e-12);
        REQUIRE(almesh_with({ring.output + "/deck.txt"}).code == 0);  // the file is found from there too
    }
}

TEST_CASE("a curved target from a mesh of the same degree, and refined or raised from a linear one") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\ndegree = 2\n");
    REQUIRE(ring.run({"boundary inner=circle 0 0 1", "boundary outer=circle 0 0 6"}).code == 0);
    ring.folder.write("curved.msh", text_of(ring.output + "/final.msh"));
    const std::string deck = ring.folder.write("on_curved.deck", "mesh = curved.msh\noutput = " + ring.output +
                                                                     "\nboundary all = mesh curved.msh\n");
    const Outcome curved = almesh_with({deck, "boundary inner=mesh " + ring.folder.path("curved.msh") + "; rotate 20"});
    CAPTURE(curved.out);
    CHECK(curved.code == 0);
    ring.folder.write("moves.txt", rows_of(mesh_of(ring.folder.path("ring.msh")), "inner", 1, true, " "));
    const Outcome raised = ring.run({"degree=3", "refine=1",
                                     "boundary inner=file " + ring.folder.path("moves.txt") + " displacement"});
    CAPTURE(raised.error);
    CHECK(raised.code == 0);
}

TEST_CASE("errors of node files name the line, the node and the boundary") {
    const RingDeck ring;
    const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
    const std::string good = rows_of(mesh, "inner", 2, false, " ");
    const std::string outer = rows_of(mesh, "outer", 0, false, " ");
    const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
        const Outcome outcome = ring.run({"boundary inner=file " + ring.folder.write("nodes.txt", text)});
        CHECK(outcome.code == 2);
        for (const std::string& part : parts) {
            CAPTURE(outcome.error);
            CHECK(has(outcome.error, part));
        }
    };
    const std::string first_row = good.substr(0, good.find('\n') + 1), rest = good.substr(first_row.size());
    refused(rest, {"nodes.txt: 1 node of boundary inner missing"});
    refused(good + first_row, {"nodes.txt:13:", "is here already, in line 1"});
    refused(outer.substr(0, outer.find('\n') + 1) + good, {"nodes.txt:1:", "is not on boundary inner"});
    refused("1 2\n" + good, {"nodes.txt:1: expected a coordinate"});
    refused("1 2 3 4\n" + good, {"nodes.txt:1: expected the end of the line, or a third coordinate of 0"});
    refused("1 nan 3\n", {"nodes.txt:1:"});
    refused("# none\n", {"12 nodes of boundary inner missing"});
    CHECK(ring.run({"boundary inner=file nowhere.txt"}).code == 2);
    const Outcome disagree = ring.run({"boundary outer=mesh " + ring.folder.path("other.msh")});
    CHECK(disagree.code == 2);
}

TEST_CASE("all and rest stand for the boundaries that are not named") {
    const RingDeck ring;
    const std::string head = "mesh = ring.msh\noutput = " + ring.output + "\n";
    CHECK(almesh_with({ring.folder.write("a.deck", head + "boundary all = rotate 20\n")}).code == 0);
    const std::string rest = head + "boundary inner = rotate 20\nboundary rest = fixed\n";
    CHECK(almesh_with({ring.folder.write("b.deck", rest)}).code == 0);
    const Outcome none = almesh_with({ring.folder.write("c.deck", head)});
    CHECK(none.code == 1);
    CHECK(has(none.error, "2 boundary lines missing"));
}
