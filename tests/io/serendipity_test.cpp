// Cells of degree 2 without nodes in the middle of quadrilaterals and hexahedra.
#include <doctest/doctest.h>

#include <array>
#include <map>

#include "io/foreign_cells.hpp"
#include "io/mesh_format.hpp"
#include "mesh/lagrange.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

using Position = std::array<double, 3>;

// Of a node of the cell under a map of degree 2, which serendipity cells can follow.
Position curved(const LagrangeBasis& basis, int node) {
    auto [x, y, z] = basis.point(node);
    if (basis.cell.is_collapsed) x *= 1 - z, y *= 1 - z;
    return {x + 0.1 * y * y - 0.2 * x * z, y + 0.3 * x * x, z + 0.1 * x * y};
}

std::string row(const Position& x) { return concat(x[0], " ", x[1], " ", x[2], "\n"); }

RawMesh from_msh(const SerendipityCell& kind) {
    const LagrangeBasis basis(*kind.cell, 2);
    std::string nodes, ids;
    for (int i = 0; i < kind.nodes(); ++i) {
        nodes += concat(11 + i, " ", row(curved(basis, i)));
        ids += concat(" ", 11 + i);
    }
    return parse_mesh(concat("$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n1 ", kind.nodes(), "\n1 1 0 ", kind.nodes(),
                             "\n", nodes, "$EndNodes\n$Elements\n1 1\n5 ", kind.cell->dim, " ", kind.msh_type,
                             " 1\n1", ids, "\n$EndElements\n"), "a.msh");
}

RawMesh from_vtk(const SerendipityCell& kind) {
    const LagrangeBasis basis(*kind.cell, 2);
    const std::vector<int> order = vtk_node_order(*kind.cell, 2);
    std::string nodes, numbers;
    for (int k = 0; k < kind.nodes(); ++k) {
        nodes += row(curved(basis, order[k]));
        numbers += concat(" ", k);
    }
    return parse_mesh(concat("# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS ", kind.nodes(),
                             " double\n", nodes, "CELLS 1 ", kind.nodes() + 1, "\n", kind.nodes(), numbers,
                             "\nCELL_TYPES 1\n", kind.vtk_type, "\n"), "a.vtk");
}

}  // namespace

TEST_CASE("cells of degree 2 without nodes in the middle get them where their edges put them, from MSH and VTK") {
    const char* const notes[] = {"1 quadrilateral of 8 nodes: completed to 9",
                                 "1 hexahedron of 20 nodes: completed to 27",
                                 "1 prism of 15 nodes: completed to 18", "1 pyramid of 13 nodes: completed to 14"};
    for (std::size_t k = 0; k < serendipity_cells().size(); ++k)
        for (const bool is_vtk : {false, true}) {
            const SerendipityCell& kind = serendipity_cells()[k];
            CAPTURE(kind.cell->name);
            CAPTURE(is_vtk);
            const RawMesh raw = is_vtk ? from_vtk(kind) : from_msh(kind);
            const LagrangeBasis basis(*kind.cell, 2);
            REQUIRE(raw.elements.size() == 1);
            CHECK(raw.elements[0].degree == 2);
            CHECK(&raw.elements[0].cell() == kind.cell);
            REQUIRE(static_cast<int>(raw.nodes.size()) == basis.count);
            REQUIRE(static_cast<int>(raw.element_nodes.size()) == basis.count);
            for (int i = 0; i < basis.count; ++i)
                for (int a = 0; a < 3; ++a)
                    CHECK(raw.nodes[raw.element_nodes[i]].x[a] ==
                          doctest::Approx(curved(basis, i)[a]).epsilon(1e-14).scale(1));
            for (int i = kind.nodes(); i < basis.count; ++i) CHECK(raw.nodes[i].id == raw.nodes[i - 1].id + 1);
            REQUIRE(raw.notes.size() == 1);
            CHECK(raw.notes[0] == std::string(notes[k]) + " each, by nodes in the middle of faces and cells");
            CHECK(static_cast<int>(raw.coordinates.first.size()) == 3 * kind.nodes());
            CHECK(static_cast<int>(raw.implied.size()) == basis.count - kind.nodes());
        }
}

// Two hexahedra side by side, the second one complete or not, with the common side once as a face of a group.
TEST_CASE("the middle of a face is one node of its cells and of the boundary, that of a complete cell if one has it") {
    for (const bool is_complete : {false, true}) {
        std::map<Position, int> number;
        std::string nodes, elements;
        const auto append = [&](const CellType& cell, int type, int id, int entity, int count, double shift) {
            elements += concat(id, " ", type, " 2 ", entity, " ", entity);
            const LagrangeBasis of(cell, 2);
            for (int i = 0; i < count; ++i) {
                Position x = of.point(i);
                if (cell.dim == 2) x = {1, x[0], x[1]};
                else x[0] += shift;
                const auto [it, is_new] = number.try_emplace(x, static_cast<int>(number.size()) + 1);
                if (x == Position{1, 0.5, 0.5}) x[0] += 0.125;  // curved
                if (is_new) nodes += concat(it->second, " ", row(x));
                elements += concat(" ", it->second);
            }
            elements += "\n";
        };
        append(hexahedron(), 17, 1, 7, 20, 0);
        append(hexahedron(), is_complete ? 12 : 17, 2, 8, is_complete ? 27 : 20, 1);
        append(quadrilateral(), 16, 3, 9, 8, 0);
        const RawMesh raw = parse_mesh(concat("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n", number.size(), "\n",
                                              nodes, "$EndNodes\n$Elements\n3\n", elements, "$EndElements\n"), "a.msh");
        const auto node = [&](int e, int i) { return raw.element_nodes[raw.elements[e].first + i]; };
        CHECK(raw.nodes.size() == 45);
        CHECK(node(0, 23) == node(2, 8));  // its side x = 1
        CHECK(node(1, 22) == node(2, 8));  // x = 0
        CHECK(raw.nodes[node(2, 8)].x[0] == (is_complete ? 1.125 : 1));
        CHECK(raw.nodes[node(0, 26)].x[0] == 0.5);
        CHECK(raw.nodes[node(0, 26)].x[2] == 0.5);
        CHECK(raw.notes.size() == 2);
        for (const RawElement& element : raw.elements)
            for (int i = 0; i < element.node_count(); ++i)
                for (int j = 0; j < i; ++j)
                    CHECK(raw.element_nodes[element.first + i] != raw.element_nodes[element.first + j]);
    }
}
