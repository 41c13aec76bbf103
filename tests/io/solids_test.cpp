// Meshes of hexahedra, prisms, pyramids and tetrahedra, with both kinds of faces, in every format.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "check/certificate.hpp"
#include "io/foreign_cells.hpp"
#include "io/mesh_format.hpp"
#include "io/vtk.hpp"
#include "mesh/build.hpp"
#include "support/meshes.hpp"
#include "support/msh_formats.hpp"
#include "support/program.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;
using doctest::Contains;

namespace {

Mesh curved_solids(int degree) {
    Mesh mesh = raise_degree(solid_mesh(2, "hdpuh", 0.1), degree);
    mesh.x = wavy(mesh.x, 3, 0.02);
    return mesh;
}

using Cell = std::pair<std::vector<const CellType*>, std::vector<double>>;  // its type and the positions of its nodes

// Cells of a dimension, in an order of their own.
std::vector<Cell> cells_of(const RawMesh& raw, int dim) {
    std::vector<Cell> cells;
    for (const RawElement& element : raw.elements) {
        if (element.dim != dim) continue;
        Cell cell{{&element.cell()}, {}};
        for (int i = 0; i < element.node_count(); ++i) {
            const double* const x = raw.nodes[raw.element_nodes[element.first + i]].x;
            cell.second.insert(cell.second.end(), x, x + 3);
        }
        cells.push_back(std::move(cell));
    }
    std::sort(cells.begin(), cells.end());
    return cells;
}

std::string su2_text(const Mesh& mesh) {
    const TemporaryFolder folder;
    write_su2(folder.path("a.su2"), mesh, mesh.x);
    return text_of(folder.path("a.su2"));
}

std::string written(const std::string& text) {
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(parse_mesh(text, "a.su2"), notes);
    CHECK(notes.empty());
    return su2_text(mesh);
}

}  // namespace

TEST_CASE("hexahedra, prisms, pyramids and tetrahedra are read as they are written, in every MSH format and SU2") {
    for (int degree = 1; degree <= 4; ++degree) {
        CAPTURE(degree);
        const Mesh mesh = curved_solids(degree);
        const RawMesh first = parse_mesh(msh_text(mesh, mesh.x), "a.msh");
        const std::vector<Cell> cells = cells_of(first, 3), faces = cells_of(first, 2);
        CHECK(static_cast<int>(cells.size()) == mesh.element_count());
        CHECK(static_cast<int>(faces.size()) == mesh.face_count());
        const std::set names(mesh.boundaries.begin(), mesh.boundaries.end());
        std::vector<std::string> notes;
        for (const int version : {22, 41})
            for (const bool binary : {false, true}) {
                const std::string text = msh_text(mesh, mesh.x, {.msh_version = version, .binary = binary});
                const RawMesh raw = parse_mesh(text, "a.msh");
                CHECK(cells_of(raw, 3) == cells);
                CHECK(cells_of(raw, 2) == faces);
                const Mesh built = build_mesh(raw, notes);
                if (raw.format == FileFormat()) CHECK(msh_text(built, built.x) == text);
                CHECK(std::set(built.boundaries.begin(), built.boundaries.end()) == names);
            }
        const std::string text = su2_text(mesh);
        const RawMesh raw = parse_mesh(text, "a.su2");
        CHECK(cells_of(raw, 3) == cells);
        CHECK(cells_of(raw, 2) == faces);
        CHECK(written(text) == text);
        CHECK(notes.empty());
    }
}

TEST_CASE("the numbers of hexahedra, prisms and pyramids in files") {
    const int msh[][3] = {{5, 6, 7}, {12, 13, 14}, {92, 90, 118}, {93, 91, 119}, {94, 106, 120}, {95, 107, 121},
                          {96, 108, 122}};
    for (int degree = 1; degree <= 7; ++degree) {
        const Mesh mesh = curved_solids(degree);
        const std::string msh_of_it = msh_of(mesh), su2 = su2_text(mesh);
        for (int k = 0; k < 3; ++k) {
            CHECK(has(msh_of_it, concat(" ", msh[degree - 1][k], " 2 4 0 ")));
            CHECK(has(su2, concat("\n", 12 + k + 100 * (degree - 1), " ")));
        }
    }
}

TEST_CASE("solids are read from VTK as they are written, pyramids without the middle of their base or linear") {
    for (int degree = 1; degree <= 4; ++degree)
        for (const VtkFormat format : {VtkFormat::ascii, VtkFormat::binary}) {
            CAPTURE(degree);
            const Mesh mesh = curved_solids(degree);
            const RawMesh raw = parse_mesh(vtk_text({"t", 3, degree, mesh.x, mesh.elements, 3, {},
                                                     {{"id", 1, std::vector<double>(mesh.element_count())}}, {},
                                                     mesh.groups}, format), "a.vtk");
            REQUIRE(static_cast<int>(raw.elements.size()) == mesh.element_count());
            for (int e = 0; e < mesh.element_count(); ++e) {
                const RawElement& element = raw.elements[e];
                const bool is_linear = mesh.cell(e).is_collapsed && degree > 2;
                CHECK(&element.cell() == &mesh.cell(e));
                CHECK(element.degree == (is_linear ? 1 : degree));
                const int whole = mesh.cell(e).is_collapsed && degree == 2 ? 13 : element.node_count();
                for (int i = 0; i < whole; ++i)
                    for (int a = 0; a < 3; ++a)
                        CHECK(raw.nodes[raw.element_nodes[element.first + i]].x[a] ==
                              mesh.x[offset(mesh.element(e)[i], 3, a)]);
            }
            CHECK((vtk_loss(mesh.groups, degree) == "") == (degree < 3));
            const RawMesh faces = parse_mesh(vtk_text({"t", 3, degree, mesh.x, mesh.faces, 2, {}, {}, {},
                                                       mesh.groups_of_faces}, format), "a.vtk");
            CHECK(cells_of(faces, 2) == cells_of(parse_mesh(msh_of(mesh), "a.msh"), 2));
        }
}

// Row by row, then layer by layer; the numbers of Gmsh's nodes.
TEST_CASE("SU2's hexahedra, prisms and pyramids of degree 2") {
    CHECK(su2_node_order(hexahedron(), 2) == std::vector<int>{0,  8,  1,  9,  20, 11, 3, 13, 2,  10, 21, 12, 22, 26,
                                                              23, 15, 24, 14, 4,  16, 5, 17, 25, 18, 7,  19, 6});
    CHECK(su2_node_order(prism(), 2) == std::vector<int>{0, 6, 1, 7, 9, 2, 8, 15, 10, 16, 17, 11, 3, 12, 4, 13, 14, 5});
    CHECK(su2_node_order(pyramid(), 2) == std::vector<int>{0, 5, 1, 6, 13, 8, 3, 10, 2, 7, 9, 12, 11, 4});
}

TEST_CASE("solids of SU2 are read in either orientation") {
    std::string text = su2_text(solid_mesh(1, "hdp"));
    const std::string from = "\n12 0 1 3 2 4 5 7 6 ", to = "\n12 0 2 3 1 4 6 7 5 ";
    REQUIRE(has(text, from));
    text.replace(text.find(from), from.size(), to);
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(parse_mesh(text, "a.su2"), notes);
    CHECK(notes == std::vector<std::string>{"1 element with negative orientation turned, the first is element 0"});
    CHECK(certify(mesh, mesh.x).valid);
}

// The corners of the unit cube, as the vertices of one hexahedron.
RawMesh collapsed(const std::vector<int>& node, const CellType& cell = hexahedron(), int degree = 1) {
    RawMesh raw = solid_block(1, "h");
    raw.elements = {{1, 0, 7, cell.dim, degree, 4, 0, &cell}};
    raw.element_nodes = node;
    return raw;
}

TEST_CASE("a hexahedron with a node at several vertices is the prism, pyramid or tetrahedron that it stands for") {
    struct Case {
        std::vector<int> node;
        const CellType& cell;
        double volume;
    };
    // solid_block() numbers the corners by rows: 0 1 / 2 3 at the bottom, 4 5 / 6 7 on top.
    for (const Case& of : {Case{{0, 1, 3, 3, 4, 5, 7, 7}, prism(), 0.5}, {{0, 0, 3, 2, 4, 4, 7, 6}, prism(), 0.5},
                           {{0, 1, 3, 2, 4, 4, 6, 6}, prism(), 0.5}, {{0, 1, 3, 2, 4, 4, 4, 4}, pyramid(), 1.0 / 3},
                           {{0, 1, 3, 3, 4, 4, 4, 4}, simplex(3), 1.0 / 6}}) {
        RawMesh raw = collapsed(of.node);
        simplify_cells(raw);
        REQUIRE(raw.notes.size() == 1);
        CHECK(has(raw.notes[0], "1 cell with a node at two vertices read as the one with fewer vertices that it is"));
        CHECK(&raw.elements[0].cell() == &of.cell);
        std::vector<std::string> notes;
        const Mesh mesh = build_mesh(raw, notes);
        CHECK(volume(mesh, mesh.x) == doctest::Approx(of.volume).epsilon(1e-14));
        for (const std::string& note : notes) CHECK(!has(note, "negative orientation"));
    }
    RawMesh flat = collapsed({0, 1, 3, 3}, quadrilateral());
    simplify_cells(flat);
    CHECK(&flat.elements[0].cell() == &simplex(2));
}

TEST_CASE("a cell with a node at two of its vertices that is no simpler one is refused") {
    for (const std::vector<int>& node : {std::vector{0, 1, 3, 2, 4, 5, 7, 7}, {0, 1, 3, 2, 4, 5, 7, 0}}) {
        RawMesh raw = collapsed(node);
        CHECK_THROWS_WITH_AS(simplify_cells(raw), Contains("and is no linear prism, pyramid or tetrahedron: write it"),
                             InputError);
    }
    Mesh mesh = raise_degree(solid_mesh(1, "h"), 2);
    mesh.elements[3] = mesh.elements[2];
    CHECK_THROWS_WITH_AS(parse_mesh(msh_of(mesh), "a.msh"), Contains("hexahedron 1 has node 4 at two of its vertices"),
                         InputError);
}

TEST_CASE("triangles and quadrilaterals of a marker stay in their order") {
    RawMesh raw = solid_block(1, "hdp");
    for (RawElement& element : raw.elements)
        if (element.dim == 2) element.physical = 1;
    std::vector<std::string> notes;
    const std::string text = su2_text(build_mesh(raw, notes)), head = "MARKER_ELEMS= 15\n";
    REQUIRE(has(text, head));
    const std::string rows = text.substr(text.find(head) + head.size());
    std::string types;
    for (const std::string_view row : split(rows, '\n'))
        if (!row.empty()) types += row[0];
    CHECK(types == "999999999559999");
    CHECK(written(text) == text);
}
