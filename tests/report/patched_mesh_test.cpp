// Final meshes that are the user's own file with other coordinates.
#include <doctest/doctest.h>

#include <fstream>

#include "app/commands.hpp"
#include "base/bytes.hpp"
#include "check/certificate.hpp"
#include "deck/deck.hpp"
#include "io/msh.hpp"
#include "io/vtk.hpp"
#include "problem/summary.hpp"
#include "support/msh_formats.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::vector<std::string> all_fixed = {"boundary inner=fixed", "vtk=none"};

// What other programs write into a file, by which it is no other mesh.
std::string decorated(std::string text) {
    const std::size_t nodes = text.find("$Nodes");
    text.insert(nodes, "$Comments\nby hand\n$EndComments\n$Unknown\n1 2 3\n$EndUnknown\n");
    text.replace(text.find("\n1 1 0 0\n"), 9, "\n1  1.000 +0.0 0e0  \n");
    return text + "$NodeData\n1\n\"T\"\n1\n0\n3\n0\n1\n1\n1 0.5\n$EndNodeData\n\n";
}

std::string triangles_in_vtk(const Mesh& mesh, VtkFormat format) {
    const std::vector<double> id(mesh.nodes(), 0.25);
    return vtk_text({"by hand", 2, 1, mesh.x, mesh.elements, 2, {{"T", 1, id}}, {}, {}}, format);
}

// Quadrilaterals of 8 nodes; their middle nodes stay in the file, without an element.
std::string of_8_nodes(const std::string& text_of_9) {
    std::string text;
    for (const std::string& line : pieces(text_of_9, '\n')) {
        const auto row = words(line);
        if (row.size() == 14 && row[1] == "10") {
            text += concat(row[0], " 16");
            for (std::size_t k = 2; k + 1 < row.size(); ++k) text += concat(" ", row[k]);
            text += "\n";
        } else if (!line.empty()) {
            text += line + "\n";
        }
    }
    return text;
}

}  // namespace

TEST_CASE("patched: with every boundary fixed the file comes back, to the last byte") {
    const RingDeck ring;
    const Mesh mesh = ring_mesh(12, 3, 6);
    for (const bool binary : {false, true})
        for (const int version : {22, 41}) {
            const std::string text = msh_text(mesh, mesh.x, {.msh_version = version, .binary = binary});
            ring.folder.write("ring.msh", text);
            REQUIRE(ring.run(all_fixed).code == 0);
            CHECK(text_of(ring.output + "/final.msh") == text);
        }
    const std::string plain = msh_of(mesh);
    for (const std::string& text : {decorated(plain), with_crlf(decorated(plain))}) {
        ring.folder.write("ring.msh", text);
        const Outcome outcome = ring.run(all_fixed);
        REQUIRE(outcome.code == 0);
        CHECK(!has(outcome.out, "written anew"));
        CHECK(text_of(ring.output + "/final.msh") == text);
    }
    Mesh curved = raise_degree(mesh, 3);
    curved.x = wavy(curved.x, 2, 0.02);
    ring.folder.write("ring.msh", msh_of(curved));
    std::vector<std::string> settings = all_fixed;
    settings.push_back("ideal=given");
    REQUIRE(ring.run(settings).code == 0);
    CHECK(text_of(ring.output + "/final.msh") == msh_of(curved));
}

TEST_CASE("patched: what moves is other coordinates, and what does not keeps its characters") {
    const RingDeck ring;
    const std::string text = decorated(msh_of(ring_mesh(12, 3, 6)));
    ring.folder.write("ring.msh", text);
    REQUIRE(ring.run({"vtk=none", "boundary outer=translate 0 1", "boundary inner=translate 0 1"}).code == 0);
    const auto before = pieces(text, '\n'), after = pieces(text_of(ring.output + "/final.msh"), '\n');
    REQUIRE(after.size() == before.size());
    CHECK(std::find(after.begin(), after.end(), "1  1.000 1 0e0  ") != after.end());
    const auto at = [&](const std::string& line) { return std::find(before.begin(), before.end(), line) - before.begin(); };
    for (long k = 0; k < static_cast<long>(before.size()); ++k)
        if (k <= at("$Nodes") || k >= at("$EndNodes")) CHECK(after[k] == before[k]);
    const Outcome raised = ring.run({"vtk=none", "degree=2"});
    CHECK(raised.code == 0);
    CHECK(has(raised.out, "note: not in the final mesh, which is written anew: $Unknown, $NodeData"));
    CHECK(mesh_of(ring.output + "/final.msh").degree == 2);
}

TEST_CASE("patched: a mesh of VTK, with its data, beside the VTK files of the run") {
    const TemporaryFolder folder;
    const Mesh mesh = ring_mesh(12, 3, 6);
    const std::string output = folder.path("out");
    for (const VtkFormat format : {VtkFormat::ascii, VtkFormat::binary}) {
        const std::string text = triangles_in_vtk(mesh, format);
        folder.write("ring.vtk", text);
        const std::string deck = folder.write("ring.deck", "mesh = ring.vtk\nthreads = 1\noutput = " + output +
                                                               "\nboundary boundary-1 = fixed\nboundary rest = fixed\n");
        REQUIRE(almesh_with({deck}).code == 0);
        CHECK(text_of(output + "/final-mesh.vtk") == text);
        CHECK(has(text_of(output + "/final.vtk"), "distortion"));
        CHECK(!std::filesystem::exists(output + "/final.msh"));
        REQUIRE(almesh_with({deck, "frames=0, 1", "boundary boundary-1=translate \"0.1*t\" 0"}).code == 0);
        CHECK(text_of(output + "/frame-0001-mesh.vtk") == text);
        CHECK(mesh_of(output + "/frame-0002-mesh.vtk").elements == mesh_of(folder.path("ring.vtk")).elements);
        CHECK(!std::filesystem::exists(output + "/final-mesh.vtk"));
        REQUIRE(almesh_with({deck, "final=msh"}).code == 0);
        CHECK(!std::filesystem::exists(output + "/frame-0001-mesh.vtk"));
        CHECK(mesh_of(output + "/final.msh").x == mesh.x);
    }
}

TEST_CASE("patched: float coordinates are certified as they will be read") {
    const TemporaryFolder folder;
    const Mesh mesh = ring_mesh(12, 3, 6);
    std::string text = triangles_in_vtk(mesh, VtkFormat::binary), floats;
    for (int i = 0; i < mesh.nodes(); ++i)
        for (const double x : {mesh.x[offset(i, 2)], mesh.x[offset(i, 2, 1)], 0.0})
            append_bytes(floats, static_cast<float>(x), std::endian::big);
    const std::string head = concat("POINTS ", mesh.nodes(), " double\n");
    text.replace(text.find(head), head.size() + 24 * mesh.nodes(), concat("POINTS ", mesh.nodes(), " float\n") + floats);
    folder.write("ring.vtk", text);
    const std::string output = folder.path("out");
    const std::string deck = folder.write("ring.deck", "mesh = ring.vtk\nvtk = none\nthreads = 1\noutput = " + output +
                                                           "\nboundary all = expression \"1.1*x + 0.01*y\" \"y\"\n");
    REQUIRE(almesh_with({deck, "boundary all=fixed"}).code == 0);
    CHECK(text_of(output + "/final-mesh.vtk") == text);
    const Outcome told = almesh_with({deck});
    REQUIRE(told.code == 0);
    CHECK(has(told.out, " boundary nodes are at the nearest position that the numbers of the mesh file can have; "));
    const Mesh moved = mesh_of(output + "/final-mesh.vtk");
    const std::vector<double> bound = certify(moved, moved.x).certified_bound;
    CHECK(number(summary_of(output), "certified_bound") ==
          doctest::Approx(*std::min_element(bound.begin(), bound.end())).epsilon(1e-6));
    CHECK(text_of(output + "/final-mesh.vtk").size() == text.size());
}

TEST_CASE("patched: quadrilaterals of 8 nodes come back with 8, certified with the middle where these put it") {
    const TemporaryFolder folder;
    const std::string square =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n"
        "$EndNodes\n$Elements\n2\n1 3 2 1 1 1 2 3 4\n2 3 2 1 1 2 5 6 3\n$EndElements\n";
    std::vector<std::string> notes;
    const Mesh mesh = raise_degree(build_mesh(parse_msh(square, "a.msh"), notes), 2);
    const std::string text = of_8_nodes(msh_of(mesh));
    folder.write("a.msh", text);
    const std::string output = folder.path("out");
    const std::string deck =
        folder.write("a.deck", "mesh = a.msh\nvtk = none\nthreads = 1\noutput = " + output +
                                   "\nboundary all = expression \"x + 0.2*sin(2*y)\" \"y + 0.2*x*x - 0.1*x*y*y\"\n");
    REQUIRE(almesh_with({deck, "boundary all=fixed"}).code == 0);
    CHECK(text_of(output + "/final.msh") == text);
    REQUIRE(almesh_with({deck}).code == 0);
    const RawMesh after = read_mesh(output + "/final.msh");
    CHECK(after.implied.size() == 2);
    CHECK(pieces(text_of(output + "/final.msh"), '\n').size() == pieces(text, '\n').size());
    const Mesh moved = mesh_of(output + "/final.msh");
    const std::vector<double> bound = certify(moved, moved.x).certified_bound;
    CHECK(number(summary_of(output), "certified_bound") ==
          doctest::Approx(*std::min_element(bound.begin(), bound.end())).epsilon(1e-6));
}

TEST_CASE("patched: a mesh file that has changed since, or is gone, comes back as it was read") {
    const RingDeck ring;
    const std::string file = ring.folder.path("ring.msh"), text = decorated(text_of(file));
    for (const bool is_gone : {false, true}) {
        ring.folder.write("ring.msh", text);
        RunHooks hooks;
        hooks.begins = [&](const Problem&) {
            if (is_gone) std::filesystem::remove(file);
            else std::ofstream(file) << square_mesh(1).nodes();
        };
        const Deck deck = read_deck(ring.deck, {"vtk=none", "boundary inner=fixed"});
        std::FILE* const out = std::tmpfile();
        CHECK(run(deck, out, hooks) == ExitCode::success);
        std::fclose(out);
        const std::string final_mesh = text_of(ring.output + "/final.msh");
        CHECK(has(final_mesh, "$Unknown"));
        CHECK(mesh_of(ring.output + "/final.msh").elements == ring_mesh(12, 3, 6).elements);
    }
}
