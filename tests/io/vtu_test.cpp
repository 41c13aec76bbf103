#include "io/foreign_formats.hpp"

#include <doctest/doctest.h>

#include "base/bytes.hpp"
#include "base/error.hpp"
#include "io/foreign_cells.hpp"
#include "io/mesh_format.hpp"
#include "io/patch.hpp"
#include "mesh/build.hpp"
#include "mesh/inner_boundary.hpp"

using namespace almesh;
using doctest::Contains;

namespace {

// Points, connectivity, offsets, types and materials of two triangles and a line, each as the text of its array.
using Arrays = std::array<std::string, 5>;
const Arrays as_text = {"0 0 0 1 0 0\n 1 1.0e0 0 0 1 0", "0 1 2 0 2 3 0 1", "3 6 8", "5 5 3", "5 6 7"};
const Arrays base64 = {
    "YAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAPA/AAAAAAAAAAAAAAAAAAAAAAAAAAAAAPA/AAAAAAAA8D8AAAAAAAAA"
    "AAAAAAAAAAAAAAAAAAAA8D8AAAAAAAAAAA==",
    "QAAAAAAAAAAAAAAAAQAAAAAAAAACAAAAAAAAAAAAAAAAAAAAAgAAAAAAAAADAAAAAAAAAAAAAAAAAAAAAQAAAAAAAAA=",
    "GAAAAAMAAAAAAAAABgAAAAAAAAAIAAAAAAAAAA==",
    "AwAAAAUFAw==",
    "DAAAAAUAAAAGAAAABwAAAA=="};
// The points in blocks of 40 bytes.
const Arrays compressed = {
    "AwAAACgAAAAQAAAADwAAABEAAAAQAAAAeJxjYMAHPtjDWAALvwEweJxjYEAGH+xRaQQAADO+Al94nGNgAIEP9gxQAAALpwEw",
    "AQAAAEAAAAAAAAAAGAAAAA==eJxjYIAARijNxIAKYHxmNHGYegABaAAK",
    "AQAAABgAAAAAAAAAEAAAAA==eJxjZoAANijNAaUBAQAAEg==",
    "AQAAAAMAAAAAAAAACwAAAA==eJxjZWUGAAAfAA4=",
    "AQAAAAwAAAAAAAAAEQAAAA==eJxjZWBgYANidiAGAACUABM="};

// format: of the arrays. reals: the type of the points. head: attributes of the file.
std::string file_of(const Arrays& arrays, const std::string& format, const std::string& head,
                    const std::string& reals = "Float64") {
    const auto array = [&](int k, const std::string& type, const std::string& more) {
        const std::string begin = concat("<DataArray type=\"", type, "\" ", more, " format=\"", format, "\"");
        if (format == "appended") return concat(begin, " offset=\"", arrays[k], "\"/>\n");
        return concat(begin, ">\n  ", arrays[k], "\n<InformationKey name=\"x\"> 7 </InformationKey></DataArray>\n");
    };
    return concat("<?xml version=\"1.0\"?>\n<!-- a > b -->\n<VTKFile type='UnstructuredGrid' version=\"2.2\" ", head,
                  ">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"4\" NumberOfCells=\"3\">\n<PointData>\n",
                  "<DataArray type=\"Int32\" Name=\"p\" format=\"ascii\">1 2 3 4</DataArray></PointData>\n<CellData>",
                  array(4, "Int32", "Name=\"material\""), "</CellData>\n<Points>",
                  array(0, reals, "NumberOfComponents=\"3\""), "</Points><Cells>",
                  array(1, "Int64", "Name=\"connectivity\""), array(2, "Int64", "Name=\"offsets\""),
                  array(3, "UInt8", "Name=\"types\""), "</Cells></Piece></UnstructuredGrid>");
}

// Read, and written again with other coordinates.
void check_triangles(const std::string& text) {
    const RawMesh raw = parse_mesh(text, "a.vtu");
    REQUIRE(raw.coordinates.first.size() == 12);
    CHECK(raw.sections == std::vector<std::string>{"PointData p"});
    std::vector<double> x;
    for (const RawNode& node : raw.nodes) x.insert(x.end(), node.x, node.x + 3);
    CHECK(patched(text, raw.coordinates, x) == text);
    x[3] = 1.5;
    const std::string moved = patched(text, raw.coordinates, x);
    CHECK(moved != text);
    const RawMesh again = parse_mesh(moved, "b.vtu");
    REQUIRE(again.nodes.size() == 4);
    for (int k = 0; k < 12; ++k) CHECK(again.nodes[k / 3].x[k % 3] == x[k]);
    CHECK(again.element_nodes == raw.element_nodes);
    CHECK(patched(moved, again.coordinates, x) == moved);
    for (const RawMesh& each : {raw, again}) {
        CHECK(each.groups.size() == 3);
        CHECK(each.elements.back().physical == raw.elements.back().physical);
    }
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(mesh.x == std::vector<double>{0, 0, 1, 0, 1, 1, 0, 1});
    CHECK(mesh.elements == std::vector<int>{0, 1, 2, 0, 2, 3});
    CHECK(mesh.boundaries == std::vector<std::string>{"material 7", "untagged"});
    REQUIRE(volume_groups(mesh).size() == 2);
    CHECK(volume_groups(mesh)[1].name == "material 6");
    CHECK(to_string(mesh.file.format) == "VTU");
}

// The arrays one after the other behind the underscore, as bytes of this order, with headers of this type.
template <class Header, class Real>
std::string appended(std::endian order, const std::string& head, const std::string& reals) {
    std::string data;
    Arrays offsets;
    const auto add = [&]<class Number>(int k, std::initializer_list<Number> numbers) {
        offsets[k] = std::to_string(data.size());
        append_bytes(data, static_cast<Header>(numbers.size() * sizeof(Number)), order);
        for (const Number number : numbers) append_bytes(data, number, order);
    };
    add(0, std::initializer_list<Real>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    add(1, std::initializer_list<std::int64_t>{0, 1, 2, 0, 2, 3, 0, 1});
    add(2, std::initializer_list<std::int64_t>{3, 6, 8});
    add(3, std::initializer_list<std::uint8_t>{5, 5, 3});
    add(4, std::initializer_list<std::int32_t>{5, 6, 7});
    return file_of(offsets, "appended", head, reals) + "<AppendedData encoding=\"raw\">\n _" + data +
           "\n</AppendedData>";
}

}  // namespace

TEST_CASE("VTU: numbers as text, in base64, compressed and appended are the same mesh") {
    const std::string zlib = " compressor=\"vtkZLibDataCompressor\"";
    check_triangles(file_of(as_text, "ascii", ""));
    check_triangles(file_of(base64, "binary", "byte_order=\"LittleEndian\""));
    check_triangles(file_of(compressed, "binary", "header_type=\"UInt32\"" + zlib));
    check_triangles(appended<std::uint32_t, double>(std::endian::little, "", "Float64"));
    check_triangles(appended<std::uint64_t, double>(std::endian::little, "header_type=\"UInt64\"", "Float64"));
    check_triangles(appended<std::uint32_t, float>(std::endian::big, "byte_order=\"BigEndian\"", "Float32"));
    for (const bool is_compressed : {false, true}) {  // appended in base64
        Arrays offsets;
        std::string data;
        for (int k = 0; k < 5; ++k) {
            offsets[k] = std::to_string(data.size());
            data += (is_compressed ? compressed : base64)[k];
        }
        check_triangles(file_of(offsets, "appended", is_compressed ? zlib : "") + "<AppendedData encoding=\"base64\">_" +
                            data + "</AppendedData></VTKFile>");
    }
}

TEST_CASE("VTU: Lagrange hexahedra have two edges in another order before version 2.1") {
    std::string points, numbers;
    const std::vector<int> order = vtk_node_order(hexahedron(), 2, false);
    for (int k = 0; k < 27; ++k) points += concat(order[k], " 0 0 "), numbers += concat(k, " ");
    const auto node = [&](const std::string& version, int k) {
        const std::string text =
            "<VTKFile type=\"UnstructuredGrid\" version=\"" + version + "\"><Piece NumberOfPoints=\"27\">"
            "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" + points +
            "</DataArray></Points><Cells><DataArray Name=\"connectivity\" format=\"ascii\">" + numbers + "</DataArray>"
            "<DataArray Name=\"offsets\" format=\"ascii\">27</DataArray><DataArray Name=\"types\" format=\"ascii\">72"
            "</DataArray></Cells>";
        const RawMesh raw = parse_vtu(text, "a.vtu");
        return static_cast<int>(raw.nodes[raw.element_nodes[k]].x[0]);
    };
    for (int k = 0; k < 27; ++k) CHECK(node("2.2", k) == k);
    CHECK(node("1.0", order[18]) == order[19]);
    CHECK(node("2.0", order[19]) == order[18]);
}

TEST_CASE("VTU: pieces without points are passed over, before and after the one that has some") {
    const std::string one = file_of(as_text, "ascii", "");
    const std::string none = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><CellData><DataArray type=\"Int32\" "
                             "Name=\"material\" format=\"ascii\"/></CellData><Points><DataArray type=\"Float64\" "
                             "NumberOfComponents=\"3\" format=\"ascii\"></DataArray></Points></Piece>";
    for (const std::string at : {"<Piece", "</UnstructuredGrid>"}) {
        std::string text = one;
        text.insert(text.find(at), none);
        check_triangles(text);
    }
}

TEST_CASE("VTU: other files are refused with a sentence") {
    const std::string good = file_of(as_text, "ascii", "");
    const auto refused = [](std::string text, const std::string& from, const std::string& to, const char* message) {
        text.replace(text.find(from), from.size(), to);
        CHECK_THROWS_WITH_AS(parse_mesh(text, "a.vtu"), Contains(message), InputError);
    };
    refused(good, "UnstructuredGrid", "PolyData", "a.vtu:3: only type=\"UnstructuredGrid\" is read, got `PolyData`");
    refused(good, "<Points>", "</Piece><Piece><Points>", "a second Piece: only one is read");
    refused(good, "\"2.2\" ", "\"2.2\" compressor=\"vtkLZ4DataCompressor\"", "data compressed by vtkLZ4DataCompressor");
    refused(good, "0 0 0 1", "0 0 x 1", "expected a number, got `x`");
    refused(good, "0 0 0 1", "0 0 1", "expected three coordinates of each point");
    refused(good, "5 5 3", "5 42 3", "cells of other kinds, 1 of type 42 with 3 nodes: only triangles");
    refused(good, "3 6 8", "3 6 9", "the list of cells ends before cell 2");
    refused(good, "3 6 8", "3 6", "there are 3 types and 2 offsets of cells");
    refused(good, "0 2 3", "0 2 4", "cell 1 has the point 4, of 4");
    refused(good, "\"types\"", "\"kinds\"", "there is no array types of Cells");
    const std::string coded = file_of(base64, "binary", "");
    refused(coded, base64[4], "!AAAAAAAAAAA", "the data of an array are no base64");
    refused(coded, base64[0], base64[0].substr(0, 60), "the data of an array are cut off");
    const std::string squeezed = file_of(compressed, "binary", "compressor=\"vtkZLibDataCompressor\"");
    std::string damaged = compressed[0];
    damaged[70] = damaged[70] == 'A' ? 'B' : 'A';
    refused(squeezed, compressed[0], damaged, "the compressed data of an array are damaged");
    const std::string raw = appended<std::uint32_t, double>(std::endian::little, "", "Float64");
    for (std::size_t size = 400; size < raw.find("</AppendedData>") - 1; size += 13)
        CHECK_THROWS_AS(parse_vtu(raw.substr(0, size), "a.vtu"), InputError);
}
