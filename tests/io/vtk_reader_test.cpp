#include <doctest/doctest.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "io/foreign_cells.hpp"
#include "io/mesh_format.hpp"
#include "io/vtk.hpp"
#include "mesh/build.hpp"
#include "support/sample_mesh.hpp"

using namespace almesh;
using doctest::Contains;

namespace {

std::string text_of(const Mesh& mesh, VtkFormat format) {
    return vtk_text({"a title", mesh.dim, mesh.degree, mesh.x, mesh.elements, mesh.dim, {},
                     {{"distortion", 1, std::vector<double>(mesh.element_count(), 1.5)}},
                     {{"program", "almesh of today"}, {"long", std::string(100, 'a')}}},
                    format);
}

}  // namespace

TEST_CASE("what is written as VTK is read again") {
    for (const int dim : {2, 3})
        for (int degree = 1; degree <= 5; ++degree)
            for (const VtkFormat format : {VtkFormat::ascii, VtkFormat::binary}) {
                CAPTURE(dim);
                CAPTURE(degree);
                std::vector<std::string> notes;
                const Mesh mesh = build_mesh(SampleMesh(dim, degree, 2).raw, notes);
                const std::string text = text_of(mesh, format);
                CHECK(looks_like_vtk(text));
                const Mesh read = build_mesh(parse_mesh(text, "final.vtk"), notes);
                CHECK(read.elements == mesh.elements);
                CHECK(read.x == mesh.x);
                CHECK(read.boundaries == std::vector<std::string>{"boundary"});
                CHECK(to_string(read.file.format) == "legacy VTK");
            }
}

TEST_CASE("Lagrange cells are read in every degree") {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= 3 && cell.dim > 1 && cell.vtk_types[2]; ++degree) {
            CAPTURE(cell.name);
            const std::vector<int> order = vtk_node_order(cell, degree, true);
            std::string points, numbers;
            for (std::size_t k = 0; k < order.size(); ++k) {
                points += concat(order[k], " 0 0\n");
                numbers += concat(" ", k);
            }
            const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS ";
            const RawMesh raw = parse_vtk(concat(head, order.size(), " double\n", points, "CELLS 1 ", order.size() + 1, "\n",
                                                 order.size(), numbers, "\nCELL_TYPES 1\n", cell.vtk_types[2], "\n"),
                                          "a.vtk");
            CHECK(&raw.elements[0].cell() == &cell);
            CHECK(raw.elements[0].degree == degree);
            for (std::size_t i = 0; i < order.size(); ++i) CHECK(raw.nodes[raw.element_nodes[i]].x[0] == i);
        }
}

TEST_CASE("VTK's empty cell is no pyramid, of which VTK has no Lagrange cells") {
    CHECK_THROWS_WITH_AS(parse_vtk("# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
                                   "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1\nCELLS 1 6\n5 0 1 2 3 4\nCELL_TYPES 1\n0\n", "a.vtk"),
                         Contains("other kinds, 1 of type 0 with 5 nodes"), InputError);
}

TEST_CASE("other VTK files are refused with a sentence") {
    std::vector<std::string> notes;
    const std::string good = text_of(build_mesh(SampleMesh(2, 1, 1).raw, notes), VtkFormat::ascii);
    const auto refused = [&](const std::string& from, const std::string& to, const char* message) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        CHECK_THROWS_WITH_AS(parse_vtk(text, "a.vtk"), Contains(message), InputError);
    };
    refused("UNSTRUCTURED_GRID", "POLYDATA", "a.vtk:4: only DATASET UNSTRUCTURED_GRID is read");
    refused("ASCII", "TEXT", "a.vtk:3: expected ASCII or BINARY");
    refused("POINTS 4 double", "POINTS 4 int", "points of type int");
    refused("POINTS 4", "POINTS 9", "expected a coordinate");
    refused("CELL_TYPES 2", "CELL_TYPES 3", "not as many types as cells");
    refused("CELL_TYPES 2\n5", "CELL_TYPES 2\n9",
            "cells of other kinds, 1 of type 9 with 3 nodes: only triangles, quadrilaterals, tetra");
    refused("CELLS 2 8\n3", "CELLS 2 8\n9", "the list of cells ends before cell 0");
    refused("CELLS 2 8\n3 ", "CELLS 2 8\n3 7", "cell 0 has the point 7");
    refused("CELLS 2 8\n", "CELLS 2 8\nOFFSETS vtktypeint64\n", "got `OFFSETS`");
    CHECK_THROWS_WITH_AS(parse_vtk(good.substr(0, good.find("CELLS")), "a.vtk"), Contains("no CELLS"), InputError);
    const std::string binary = text_of(build_mesh(SampleMesh(2, 1, 1).raw, notes), VtkFormat::binary);
    for (std::size_t size = 30; size < binary.find("CELL_DATA"); size += 7)
        CHECK_THROWS_AS(parse_vtk(binary.substr(0, size), "a.vtk"), InputError);
}
