#include "io/vtk.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "io/foreign_cells.hpp"
#include "mesh/lagrange.hpp"

using namespace almesh;

namespace {

// One simplex of its own nodes, no data.
std::string one_cell(int dim, int degree) {
    std::vector<int> cell(simplex_node_count(dim, degree));
    std::iota(cell.begin(), cell.end(), 0);
    return vtk_text({"", 3, degree, std::vector<double>(3 * cell.size(), 0.0), cell, dim, {}, {}, {}});
}

std::string with_data(const std::vector<VtkArray>& point_data, const std::vector<VtkArray>& cell_data) {
    return vtk_text({"t", 2, 1, {0, 0, 1, 0, 0, 1}, {0, 1, 2}, 2, point_data, cell_data, {}});
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

// As VTK 9.1 evaluates its own cells.
TEST_CASE("node orders of VTK's tetrahedra") {
    CHECK(vtk_node_order(simplex(3), 1) == std::vector<int>{0, 1, 2, 3});
    CHECK(vtk_node_order(simplex(3), 2) == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 9, 8});
    CHECK(vtk_node_order(simplex(3), 3) ==
          std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 10, 15, 14, 13, 12, 17, 19, 18, 16});
    CHECK(vtk_node_order(simplex(3), 4) == std::vector<int>{0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11,
                                                   12, 15, 14, 13, 21, 20, 19, 18, 17, 16, 25, 26,
                                                   27, 33, 31, 32, 28, 29, 30, 22, 23, 24, 34});
}

TEST_CASE("node orders of VTK's quadrilaterals") {
    CHECK(vtk_node_order(quadrilateral(), 1) == std::vector<int>{0, 1, 2, 3});
    CHECK(vtk_node_order(quadrilateral(), 2) == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8});
    CHECK(vtk_node_order(quadrilateral(), 3) ==
          std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 9, 8, 11, 10, 12, 13, 15, 14});
    CHECK(vtk_node_order(quadrilateral(), 4) ==
          std::vector<int>{0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  12, 11, 10,
                           15, 14, 13, 16, 20, 17, 23, 24, 21, 19, 22, 18});
}

// VTK's points by their reference coordinates times the degree: of degree 3 on as vtkLagrangeHexahedron and
// vtkLagrangeWedge number them (PointIndexFromIJK), but for two edges of hexahedra, which VTK 9 swaps where it reads
// legacy files; others as VTK evaluates its cells.
TEST_CASE("node orders of VTK's hexahedra, prisms and pyramids") {
    const auto order = [](const CellType& cell, int degree, bool is_lagrange) {
        const LagrangeBasis gmsh(cell, degree);
        std::string text;
        for (const int node : vtk_node_order(cell, degree, is_lagrange)) {
            text += text.empty() ? "" : " ";
            for (const double coordinate : gmsh.point(node)) text += concat(std::lround(degree * coordinate));
        }
        return text;
    };
    CHECK(order(hexahedron(), 1, false) == "000 100 110 010 001 101 111 011");
    CHECK(order(hexahedron(), 2, false) == "000 200 220 020 002 202 222 022 100 210 120 010 102 212 122 012 001 201 "
                                           "221 021 011 211 101 121 110 112 111");
    CHECK(order(hexahedron(), 3, true) ==
          "000 300 330 030 003 303 333 033 100 200 310 320 130 230 010 020 103 203 313 323 133 233 013 023 001 002 301 "
          "302 031 032 331 332 011 021 012 022 311 321 312 322 101 201 102 202 131 231 132 232 110 210 120 220 113 213 "
          "123 223 111 211 121 221 112 212 122 222");
    CHECK(order(prism(), 3, true) ==
          "000 300 030 003 303 033 100 200 210 120 020 010 103 203 213 123 023 013 001 002 301 302 031 032 110 113 101 "
          "201 102 202 211 121 212 122 021 011 022 012 111 112");
    CHECK(order(prism(), 4, true) ==
          "000 400 040 004 404 044 100 200 300 310 220 130 030 020 010 104 204 304 314 224 134 034 024 014 001 002 003 "
          "401 402 403 041 042 043 110 210 120 114 214 124 101 201 301 102 202 302 103 203 303 311 221 131 312 222 132 "
          "313 223 133 031 021 011 032 022 012 033 023 013 111 211 121 112 212 122 113 213 123");
    CHECK(order(hexahedron(), 2, true) == "000 200 220 020 002 202 222 022 100 210 120 010 102 212 122 012 001 201 021 "
                                          "221 011 211 101 121 110 112 111");
    CHECK(order(prism(), 2, true) == "000 200 020 002 202 022 100 110 010 102 112 012 001 201 021 101 111 011");
    // vtkWedge and vtkBiQuadraticQuadraticWedge, whose faces VTK orients outward for the mirror image.
    CHECK(order(prism(), 1, false) == "000 010 100 001 011 101");
    CHECK(order(prism(), 2, false) == "000 020 200 002 022 202 010 110 100 012 112 102 001 021 201 011 111 101");
    CHECK(order(pyramid(), 1, false) == "000 100 110 010 001");
    CHECK(order(pyramid(), 2, false) == "000 200 220 020 002 100 210 120 010 001 201 221 021 110");
}

TEST_CASE("node orders are Gmsh's for lines and triangles, and permutations for all") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= 7; ++degree) {
            std::vector<int> order = vtk_node_order(simplex(dim), degree);
            CHECK(order.size() == static_cast<std::size_t>(simplex_node_count(dim, degree)));
            if (dim < 3) CHECK(std::is_sorted(order.begin(), order.end()));
            std::sort(order.begin(), order.end());
            for (std::size_t i = 0; i < order.size(); ++i) CHECK(order[i] == static_cast<int>(i));
        }
}

TEST_CASE("node orders are permutations for all cells and degrees") {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= max_degree && cell.dim > 0; ++degree)
            for (std::vector<int> order : {vtk_node_order(cell, degree), su2_node_order(cell, degree)}) {
                std::sort(order.begin(), order.end());
                REQUIRE(static_cast<int>(order.size()) == cell.node_count(degree));
                for (std::size_t i = 0; i < order.size(); ++i) CHECK(order[i] == static_cast<int>(i));
            }
}

TEST_CASE("pyramids of degree 2 have no node in the middle of their base in VTK, others have their vertices") {
    const int nodes[] = {5, 13, 5, 5}, types[] = {14, 27, 14, 14};
    for (int degree = 1; degree <= 4; ++degree) {
        std::vector<int> cells(2 * pyramid().node_count(degree));
        std::iota(cells.begin(), cells.end(), 0);
        const int second = pyramid().node_count(degree);
        const std::string text =
            vtk_text({"", 3, degree, std::vector<double>(3 * cells.size(), 0.0), cells, 3, {}, {}, {},
                      {{&pyramid(), 0, 2, 0}}});
        CHECK(contains(text, concat("\nCELLS 2 ", 2 * nodes[degree - 1] + 2, "\n", nodes[degree - 1], " 0 1 2 3 4")));
        CHECK(contains(text, concat("\n", nodes[degree - 1], " ", second, " ", second + 1, " ")));
        CHECK(contains(text, concat("\nCELL_TYPES 2\n", types[degree - 1], "\n", types[degree - 1], "\n")));
    }
}

TEST_CASE("cell types by dimension and degree") {
    const int types[3][4] = {{3, 21, 68, 68}, {5, 22, 69, 69}, {10, 24, 71, 71}};
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= 4; ++degree)
            CHECK(contains(one_cell(dim, degree),
                           "\nCELL_TYPES 1\n" + std::to_string(types[dim - 1][degree - 1]) + "\n"));
    CHECK(contains(one_cell(3, 2), "\nCELLS 1 11\n10 0 1 2 3 4 5 6 7 9 8\n"));
}

TEST_CASE("a file to the letter") {
    const std::string text =
        vtk_text({"two lines\nof title", 2, 1, {0, 0, 1, 0, 0.1, 1e-17}, {0, 1, 2}, 2,
                  {{"move", 2, {1, 2, 3, 4, 5, 6}}}, {{"eta", 1, {1.0 / 3}}}, {{"the deck", "mu = 50 %\nend"}}});
    CHECK(text == R"(# vtk DataFile Version 3.0
two lines
ASCII
DATASET UNSTRUCTURED_GRID
FIELD FieldData 1
the%20deck 1 1 string
mu%20=%2050%20%25%0Aend
POINTS 3 double
0 0 0
1 0 0
0.1 1e-17 0
CELLS 1 4
3 0 1 2
CELL_TYPES 1
5
POINT_DATA 3
VECTORS move double
1 2 0
3 4 0
5 6 0
CELL_DATA 1
SCALARS eta double 1
LOOKUP_TABLE default
0.333333333
)");
}

// Bytes as VTK 9.1 reads them: big-endian, a string behind its length, a line end behind each array.
TEST_CASE("a binary file to the letter") {
    const std::string text = vtk_text({"t", 2, 1, {0, 0, 1, 0, 0, -2}, {0, 1, 2}, 2, {{"move", 2, {1, 0, 0, 0, 0, 0}}},
                                       {{"eta", 1, {0.5}}}, {{"deck", "a b"}}}, VtkFormat::binary);
    const auto zeros = [](int count) { return std::string(count, '\0'); };
    const std::string one = std::string("\x3f\xf0").append(6, '\0'),
                      two = std::string("\xc0").append(7, '\0');  // 1 and -2
    const auto small = [&](char value) { return zeros(3).append(1, value); };
    CHECK(text ==
          "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\ndeck 1 1 string\n"
          "\xc3"
          "a b\nPOINTS 3 double\n" +
              zeros(24) + one + zeros(16) + zeros(8) + two + zeros(8) + "\nCELLS 1 4\n" + small(3) + small(0) +
              small(1) + small(2) + "\nCELL_TYPES 1\n" + small(5) + "\nPOINT_DATA 3\nVECTORS move double\n" + one +
              zeros(64) + "\nCELL_DATA 1\nSCALARS eta double 1\nLOOKUP_TABLE default\n\x3f\xe0" + zeros(6) + "\n");
    const std::string length_300 =
        vtk_text({"t", 2, 1, {}, {}, 2, {}, {}, {{"deck", std::string(300, 'a')}}}, VtkFormat::binary);
    CHECK(contains(length_300, "string\n\x81\x2c" "aaa"));
}

TEST_CASE("no inf or nan, which readers would turn into 0") {
    const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    const std::string text = with_data({{"eta", 1, {inf, -inf, nan}}}, {});
    CHECK(contains(text, "LOOKUP_TABLE default\n1e+300\n-1e+300\n1e+300\n"));
    CHECK_FALSE(contains(text, "inf"));
    CHECK_FALSE(contains(text, "nan"));
}

TEST_CASE("names are encoded, 3-vectors written as they are") {
    CHECK(contains(with_data({}, {{"max eta \"e\"", 1, {2}}}), "SCALARS max%20eta%20%22e%22 double 1\n"));
    CHECK(contains(with_data({}, {{"v", 3, {1, 2, 3}}}), "VECTORS v double\n1 2 3\n"));
    CHECK_FALSE(contains(with_data({}, {}), "_DATA"));
}

TEST_CASE("the title is one line of at most 255 characters") {
    const std::string text = vtk_text({std::string(300, 'a'), 2, 1, {}, {}, 2, {}, {}, {}});
    CHECK(contains(text, "\n" + std::string(255, 'a') + "\nASCII\n"));
}

TEST_CASE("to a file, and to a place where none can be") {
    const auto path = std::filesystem::temp_directory_path() / ("almesh_vtk_test_" + std::to_string(getpid()));
    write_vtk(path.string(), {"t", 2, 1, {0, 0, 1, 0, 0, 1}, {0, 1, 2}, 2, {}, {}, {}});
    CHECK(read_text_file(path.string()) == with_data({}, {}));
    std::filesystem::remove(path);
    CHECK_THROWS_AS(write_vtk("/no/such/folder/a.vtk", {"t", 2, 1, {}, {}, 2, {}, {}, {}}), InputError);
}
