// Files that gmsh has written (tests/io/data), through the whole program and back.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "support/msh_formats.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::string data = "tests/io/data/interface-";

// Cells of all dimensions: id -> type, tags and node ids.
std::map<long long, std::vector<long long>> cells_of(const RawMesh& raw) {
    std::map<long long, std::vector<long long>> cells;
    for (const RawElement& e : raw.elements) {
        std::vector<long long>& cell = cells[e.id] = {e.dim, e.degree, e.physical, e.entity};
        std::vector<long long> nodes;
        for (int k = 0; k < simplex_node_count(e.dim, e.degree); ++k)
            nodes.push_back(raw.nodes[raw.element_nodes[e.first + k]].id);
        if (e.dim > 0) std::sort(nodes.begin(), nodes.end());  // the boundary is turned outward
        cell.insert(cell.end(), nodes.begin(), nodes.end());
    }
    return cells;
}

std::map<long long, std::vector<double>> nodes_of(const RawMesh& raw) {
    std::map<long long, std::vector<double>> nodes;
    for (const RawNode& node : raw.nodes) nodes[node.id] = {node.x[0], node.x[1], node.x[2]};
    return nodes;
}

// Those of the mesh: not the point at the centre of the arc, which is no node of it.
std::map<long long, std::vector<long long>> cells_in_mesh(const RawMesh& raw) {
    auto cells = cells_of(raw);
    CHECK(std::erase_if(cells, [](const auto& cell) { return cell.second[0] == 0 && cell.second.back() == 5; }) == 1);
    return cells;
}

const std::vector<FileFormat> all_formats = {{.msh_version = 22}, {.msh_version = 22, .binary = true},
                                             {.msh_version = 41}, {.msh_version = 41, .binary = true}};

}  // namespace

TEST_CASE("gmsh's own files of every version hold the same mesh, with points, the interface and names") {
    const RawMesh first = read_mesh(data + "22.msh");
    CHECK(to_string(first.format) == "MSH 2.2, binary");
    CHECK(to_string(read_mesh(data + "40.msh").format) == "MSH 4.0, ASCII");
    CHECK(to_string(read_mesh(data + "41.msh").format) == "MSH 4.1, binary");
    for (const char* version : {"22", "40", "41"}) {
        const RawMesh raw = read_mesh(data + version + ".msh");
        CHECK(cells_of(raw) == cells_of(first));
        for (const auto& [id, x] : nodes_of(raw))
            for (int a = 0; a < 3; ++a) CHECK(x[a] == doctest::Approx(nodes_of(first)[id][a]).epsilon(1e-15).scale(1));
        const Mesh mesh = mesh_of(data + version + ".msh");
        CHECK(mesh.kept[0].physical == std::vector<int>{9});
        CHECK(mesh.kept[1].physical == std::vector<int>{3});
        CHECK(mesh.file.loose == 1);  // the centre of the arc
        CHECK(mesh.boundaries == std::vector<std::string>{"wall", "inlet"});
    }
}

TEST_CASE("gmsh's files written anew and read again have all cells, tags, names and bits, but no loose node") {
    for (const char* version : {"22", "40", "41"})
        for (const FileFormat& format : all_formats) {
            CAPTURE(version);
            CAPTURE(to_string(format));
            const RawMesh raw = read_mesh(data + version + ".msh");
            std::vector<std::string> notes;
            const Mesh mesh = build_mesh(raw, notes);
            const std::string text = msh_text(mesh, mesh.x, format);
            const RawMesh back = parse_msh(text, "back.msh");
            CHECK(back.format == format);
            CHECK(cells_of(back) == cells_in_mesh(raw));
            std::map<long long, std::vector<double>> nodes = nodes_of(raw);
            nodes.erase(5);
            CHECK(nodes_of(back) == nodes);
            CHECK(back.groups.size() == 7);
            const Mesh again = build_mesh(back, notes);
            CHECK(notes.empty());
            CHECK(msh_text(again, again.x, format) == text);
        }
}

TEST_CASE("an element of an entity with several physical groups is written once for each") {
    RawMesh raw = read_mesh(data + "41.msh");
    raw.entities.back().physical = {12, 13};
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(raw, notes);
    const auto count = [](const RawMesh& of, int physical) {
        return std::count_if(of.elements.begin(), of.elements.end(), [&](const RawElement& element) {
            return element.dim == 2 && element.entity == 2 && element.physical == physical;
        });
    };
    const RawMesh back = parse_msh(msh_text(mesh, mesh.x), "back.msh");
    CHECK(count(back, 12) > 0);
    CHECK(count(back, 13) == count(back, 12));
    CHECK(count(back, 12) == count(raw, 12));
    CHECK(back.elements.size() == cells_in_mesh(raw).size() + count(raw, 12));
}

TEST_CASE("a run moves the points and curves of its input with the mesh, in every format") {
    for (const char* version : {"22", "40", "41"}) {
        const TemporaryFolder folder;
        const std::string deck =
            folder.write("a.deck", "mesh = " + std::filesystem::absolute(data).string() + version +
                                       ".msh\noutput = " + folder.path("out") +
                                       "\nboundary all = translate 2 0\nthreads = 1\nvtk = none\n");
        const Outcome outcome = almesh_with({deck});
        CAPTURE(outcome.error);
        REQUIRE(outcome.code == 0);
        const RawMesh before = read_mesh(data + version + ".msh"), after = read_mesh(folder.path("out/final.msh"));
        CHECK(after.format == before.format);
        CHECK(after.element_nodes == before.element_nodes);
        CHECK(cells_of(after) == cells_of(before));
        for (const auto& [id, x] : nodes_of(before)) {
            if (id == 10) continue;                // inside, on the interface
            const double shift = id == 5 ? 0 : 2;  // the centre of the arc is on no element
            CHECK(nodes_of(after)[id][0] == doctest::Approx(x[0] + shift));
            CHECK(nodes_of(after)[id][1] == doctest::Approx(x[1]).epsilon(1e-9).scale(1));
        }
        REQUIRE(almesh_with({deck, "degree=3"}).code == 0);
        const RawMesh raised = read_mesh(folder.path("out/final.msh"));
        CHECK(raised.elements.size() == before.elements.size() - 1);
        CHECK(std::count_if(raised.elements.begin(), raised.elements.end(),
                            [](const RawElement& element) { return element.degree == 3; }) == 7);
    }
}

TEST_CASE("the interface is a marker of SU2") {
    const TemporaryFolder folder;
    const Mesh mesh = linear_part(mesh_of(data + "22.msh"));
    write_su2(folder.path("a.su2"), mesh, mesh.x);
    const Mesh back = mesh_of(folder.path("a.su2"));
    CHECK(back.boundaries == std::vector<std::string>{"wall", "inlet"});
    REQUIRE(back.kept[1].count() == 1);
    CHECK(group_name(back.file.groups, 1, back.kept[1].physical[0]) == "interface");
    write_su2(folder.path("b.su2"), back, back.x);
    CHECK(text_of(folder.path("b.su2")) == text_of(folder.path("a.su2")));
}
