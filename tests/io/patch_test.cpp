// Files with other coordinates in them, and nothing else changed.
#include "io/patch.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/bytes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<double> positions_of(const RawMesh& raw) {
    std::vector<double> x;
    for (std::size_t k = 0; k < raw.coordinates.first.size(); ++k)
        x.push_back(raw.nodes[k / raw.coordinates.dim].x[k % raw.coordinates.dim]);
    return x;
}

bool is_read(const std::string& name) try {
    const std::vector<RawNode> nodes = read_mesh(name).nodes;
    return std::all_of(nodes.begin(), nodes.end(), [](const RawNode& node) { return std::isfinite(node.x[0]); });
} catch (const InputError&) {
    return false;  // a seed of a bad file
}

// The file as it is where nothing moves; where every second number does, it is read back so, and the file read back
// with the old numbers is the same again in binary, and in text but for how these are written.
void check_file(const std::string& text, const std::string& name) {
    CAPTURE(name);
    const RawMesh raw = parse_mesh(text, name);
    const CoordinateFields& fields = raw.coordinates;
    REQUIRE(!fields.first.empty());
    std::vector<double> x = positions_of(raw);
    CHECK(patched(text, fields, x) == text);
    for (std::size_t k = 0; k < x.size(); k += 2) x[k] += 0.1 + 1e-3 * static_cast<double>(k);
    x = rounded_as(fields, x);
    const std::string moved = patched(text, fields, x);
    const RawMesh back = parse_mesh(moved, name);
    CHECK(positions_of(back) == x);
    CHECK(back.element_nodes == raw.element_nodes);
    CHECK(patched(moved, back.coordinates, x) == moved);
    const std::string again = patched(moved, back.coordinates, positions_of(raw));
    CHECK(patched(again, parse_mesh(again, name).coordinates, x) == moved);
    if (fields.form != CoordinateFields::Form::text) CHECK(again == text);
}

template <class Number>
std::string vtk(const std::string& type) {
    std::string text = "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 " + type + "\n";
    for (const double x : {0.0, 0.0, 0.0, 1.1, 0.0, 0.0, 0.0, 1.3, 0.0, 0.1, 0.2, 1.7})
        append_bytes(text, static_cast<Number>(x), std::endian::big);
    text += "\nCELLS 1 5\n";
    for (const int i : {4, 0, 1, 2, 3}) append_bytes(text, i, std::endian::big);
    text += "\nCELL_TYPES 1\n";
    append_bytes(text, 10, std::endian::big);
    return text + "\nPOINT_DATA 4\nSCALARS p double\nLOOKUP_TABLE default\nand so on";
}

}  // namespace

TEST_CASE("patch: every format, read and written again") {
    int files = 0;
    for (const char* folder : {"tests/io/data", "tests/fuzz/seeds/msh", "tests/fuzz/seeds/su2", "tests/fuzz/seeds/vtk"})
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            const std::string name = entry.path().string();
            const bool is_mesh = name.ends_with(".msh") || name.ends_with(".su2") || name.ends_with(".vtk");
            if (!is_mesh || !is_read(name)) continue;
            ++files;
            const std::string text = read_file(name);
            check_file(text, name);
            if (parse_mesh(text, name).coordinates.form != CoordinateFields::Form::text || has(text, "\r")) continue;
            check_file("\xEF\xBB\xBF" + with_crlf(text), name + " by another editor");
        }
    CHECK(files > 20);
    check_file(vtk<double>("double"), "double.vtk");
    check_file(vtk<float>("float"), "float.vtk");
}

TEST_CASE("patch: only characters of coordinates change") {
    const std::string text =
        "NZONE= 2 % two\r\nIZONE= 1\r\nNDIME= 2\r\nNELEM= 1\r\n5 0 1 2\r\nNPOIN= 3\n\t+0.50 0e0 0\n 1.000 % one\n"
        " 0 1\n0 1 2 % the last\nNMARK= 0\nIZONE= 2\nNDIME= 2\nNELEM= 1\n5 0 1 2\nNPOIN= 4\n5 0\n6 0\n5 1\n7 7 3\n"
        "NMARK= 0\nFFD_NBOX= 1\n";
    RawMesh raw = parse_mesh(text, "a.su2");
    std::vector<double> x = positions_of(raw);
    REQUIRE(x.size() == 14);
    CHECK(patched(text, raw.coordinates, x) == text);
    x[2] = 1.125;
    x[12] = 1.0 / 3;
    std::string expected = text;
    expected.replace(expected.find("1.000"), 5, "1.125");
    expected.replace(expected.find("7 7"), 1, "0.3333333333333333");
    CHECK(patched(text, raw.coordinates, x) == expected);
}

TEST_CASE("patch: tabs and the exponents of Fortran, in every text format") {
    const std::string nodes[] = {"1.0D+00\t0.0d0 0\n", "\t1.25D-01 0.2500E+1\t0.0\n", "0\t0\t-0.0D0\n"};
    const std::string vtk = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n" +
                            nodes[0] + nodes[1] + nodes[2] + "CELLS 1 4\n3\t0 1 2\nCELL_TYPES 1\n5\n";
    const std::string msh = "$MeshFormat\n2.2\t0 8\n$EndMeshFormat\n$Nodes\n3\n1\t" + nodes[0] + "2 " + nodes[1] +
                            "3 " + nodes[2] + "$EndNodes\n$Elements\n1\n1\t2\t0 1 2 3\n$EndElements\n";
    const std::string su2 = "% first\nNDIME=\t2\nNELEM= 1\n5\t0 1 2\nNPOIN= 3\n" + nodes[0] + nodes[1] + nodes[2] +
                            "NMARK= 0\n";
    for (const std::string& text : {vtk, msh, su2})
        for (const std::string& by_editor : {text, "\xEF\xBB\xBF" + text, with_crlf(text)}) {
            const RawMesh raw = parse_mesh(by_editor, "a.mesh");
            REQUIRE(raw.nodes.size() == 3);
            CHECK(raw.nodes[0].x[0] == 1);
            CHECK(raw.nodes[1].x[0] == 0.125);
            CHECK(raw.nodes[1].x[1] == 2.5);
            check_file(by_editor, "a.mesh");
        }
}

TEST_CASE("patch: the two zeros, and numbers below the range, keep their characters") {
    const std::string text = "NDIME= 2\nNELEM= 1\n5 0 1 2\nNPOIN= 3\n-0 0.00\n1e-400 1\n-1 0\nNMARK= 0\n";
    const RawMesh raw = parse_mesh(text, "a.su2");
    CHECK(patched(text, raw.coordinates, {0, -0.0, 0, 1, -1, 0}) == text);
}

TEST_CASE("patch: numbers in columns are as exact as their width lets them be, and have a point") {
    const std::string text = "id      1.0  2.5D+00-1.00D+00\n";
    const CoordinateFields fields{CoordinateFields::Form::text, std::endian::little, 3, 9, 0, nullptr, {2, 11, 20}};
    CHECK(patched(text, fields, {1, 2.5, -1}) == text);
    const std::vector<double> x = {-1.0 / 3, 7, 1e-7 / 3}, rounded = rounded_as(fields, x);
    CHECK(rounds(fields));
    CHECK(rounded[0] == -0.333333);
    CHECK(rounded[1] == 7);
    CHECK(rounded[2] == doctest::Approx(x[2]).epsilon(1e-3));
    const std::string moved = patched(text, fields, x);
    CHECK(moved.size() == text.size());
    CHECK(moved.starts_with("id-0.333333       7."));
    CHECK(moved == patched(text, fields, rounded));
}

TEST_CASE("patch: a number of a file for CalculiX has at most the 20 characters that it reads") {
    const std::string text = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n";
    const RawMesh raw = parse_mesh(text, "a.inp");
    std::vector<double> x(12, 0);
    x[3] = -1.2345678901234567e-05, x[4] = 1.234567890123456e-10, x[5] = 0.1;
    const std::vector<double> rounded = rounded_as(raw.coordinates, x);
    const std::string moved = patched(text, raw.coordinates, x);
    CHECK(moved.find("\n2,-1.2345678901235E-05,1.23456789012346E-10,0.1\n") != moved.npos);
    const RawMesh again = parse_mesh(moved, "a.inp");
    for (int k = 0; k < 12; ++k) CHECK(again.nodes[k / 3].x[k % 3] == rounded[k]);
    const std::string longer = text.substr(0, 8) + "0.0000000000000000000000" + text.substr(9);
    CHECK(parse_mesh(longer, "a.inp").notes.size() == 1);
}
