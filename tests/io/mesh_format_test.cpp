#include "io/mesh_format.hpp"

#include <doctest/doctest.h>

#include "base/error.hpp"
#include "support/temporary_folder.hpp"

using namespace almesh;
using doctest::Contains;

namespace {

const std::string triangle =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
    "$Elements\n1\n1 2 0 1 2 3\n$EndElements\n";

// A format of the test: a mesh of as many nodes as the digit behind "points".
RawMesh parse_points(std::string_view text, const std::string& path) {
    RawMesh mesh;
    mesh.path = path;
    mesh.nodes.resize(text.back() - '0');
    return mesh;
}

const MeshFormat with_points[] = {
    mesh_formats[0],
    {"Points", ".pts", [](std::string_view text) { return text.starts_with("points"); }, parse_points}};

}  // namespace

TEST_CASE("the text tells the format, whatever the name of the file") {
    for (const char* path : {"a.msh", "a.pts", "a"}) {
        CHECK(parse_mesh(triangle, path).nodes.size() == 3);
        CHECK(parse_mesh("\n $Comments\n$EndComments\n" + triangle, path).nodes.size() == 3);
        CHECK(find_format(with_points, triangle, path).ending == ".msh");
        CHECK(find_format(with_points, "points 5", path).parse("points 5", path).nodes.size() == 5);
    }
}

TEST_CASE("text of no known format is read by the ending of the name, so that the reader says what is wrong") {
    CHECK_THROWS_WITH_AS(parse_mesh("solid cube\n", "a.msh"), Contains("a.msh:1: not a Gmsh mesh file"), InputError);
    CHECK(find_format(with_points, "5", "a.pts").name == "Points");
}

TEST_CASE("where neither tells, the formats are listed") {
    CHECK_THROWS_WITH_AS(parse_mesh("solid cube\n", "cube.stl"),
                         "cube.stl: not a mesh file of a known format, by its first lines or its name; readable are: "
                         "Gmsh MSH 1, 2 to 2.2, 4.0 and 4.1, ASCII or binary (*.msh); SU2 (*.su2); legacy VTK (*.vtk); "
                         "Abaqus and CalculiX (*.inp); VTU (*.vtu)",
                         InputError);
    CHECK_THROWS_WITH_AS(find_format(with_points, "solid", "a"), Contains("binary (*.msh); Points (*.pts)"),
                         InputError);
}

TEST_CASE("formats that are not read are told by their contents, with what converts them") {
    const std::string hdf5 = "\x89HDF\r\n\x1a\n....", triangles(84 + 2 * 50, '\2');
    std::string binary_stl = triangles;
    binary_stl.replace(80, 4, std::string("\2\0\0\0", 4));
    std::string nastran = "$ a bracket\nSOL 101\nCEND\nBEGIN BULK\nGRID    1,,0.,0.,0.\n";
    const std::string iges = std::string(72, ' ') + "S      1\n";
    const std::string what = "what makes a mesh of it that is: ";
    struct Sample {
        std::string text, expected;
    };
    for (const auto& [text, expected] : {
             Sample{hdf5 + "CGNSLibraryVersion", "a: CGNS, which is not read; " + what + "gmsh -0 IN"},
             {"....@(#)ADF Database Version F02017>", "a: CGNS, which"},
             {hdf5 + "ENS_MAA", "a: MED, which is not read; " + what + "meshio convert -o gmsh22 IN"},
             {hdf5 + "VTKHDF", "a: VTKHDF, which is not read; " + what + "ParaView"},
             {hdf5 + "eb_prop1", "a: Exodus, which is not read; " + what + "plot/to_msh.py IN"},
             {"CDF\1....", "a: Exodus"}, {hdf5, "a: HDF5"},
             {"(0 \"Fluent\")\n(2 3)\n", "a: Fluent, which is not read; " + what + "meshio"},
             {"FORMAT\ntype: ensight gold\n", "a: EnSight"},
             {"C Binary", "a: EnSight"},
             {"ISO-10303-21;\nHEADER;", "a: STEP, which is not read; " + what + "gmsh -3 IN"},
             {iges, "a: IGES"}, {"DBRep_DrawableShape\n\nCASCADE Topology V3", "a: BREP"},
             {"SetFactory(\"OpenCASCADE\");\nBox(1) = {0,0,0,1,1,1};", "a: a script of Gmsh"},
             {"solid cube\n facet normal 0 0 1\n", "a: STL, a surface without inside"},
             {binary_stl, "a: STL, a surface"},
             {"ply\nformat ascii 1.0\nelement vertex 3\n", "a: PLY, a surface"},
             {"# a cube\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a: OBJ, a surface"},
             {nastran, "a: Nastran, which is not read; " + what + "meshio convert -o gmsh22 IN"},
             {"$\nGRID*   1       0       0.      0.      1.\n", "a: Nastran"},
             {"\x1f\x8b....", "a: compressed by gzip, which is not read; " + what + "gunzip"},
             {std::string("\xff\xfe$\0M\0", 6), "a: text in UTF-16"}})
        CHECK_THROWS_WITH_AS(parse_mesh(text, "a"), Contains(expected.c_str()), InputError);
    CHECK_THROWS_WITH_AS(parse_mesh("(0 \"Fluent\")\n", "a.msh"), Contains("a.msh: Fluent, which"), InputError);
    CHECK_THROWS_WITH_AS(parse_mesh(triangles, "a.xyz"), Contains("readable are"), InputError);
    CHECK(parse_mesh("\xEF\xBB\xBF" + triangle, "a").nodes.size() == 3);
}

TEST_CASE("formats have names, and a text format no zero bytes") {
    CHECK(to_string(parse_mesh(triangle, "a.msh").format) == "MSH 2.2, ASCII");
    CHECK(to_string(FileFormat{.msh_version = 41, .binary = true}) == "MSH 4.1, binary");
    CHECK(to_string(FileFormat{".su2"}) == "SU2");
    CHECK_THROWS_WITH_AS(parse_mesh(std::string("NDIME= 2\n\0", 10), "a.su2"),
                         "cannot read a.su2: it is binary; save it as text (ASCII)", InputError);
}

TEST_CASE("a mesh file is read, a missing one is refused by its name") {
    CHECK_THROWS_WITH_AS(read_mesh("/no/such/file.msh"), "cannot read /no/such/file.msh: No such file or directory",
                         InputError);
}
