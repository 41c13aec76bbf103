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
                         "Gmsh MSH 1, 2.2, 4.0 and 4.1, ASCII or binary (*.msh); SU2 (*.su2); legacy VTK (*.vtk); "
                         "Abaqus and CalculiX (*.inp); VTU (*.vtu)",
                         InputError);
    CHECK_THROWS_WITH_AS(find_format(with_points, "solid", "a"), Contains("binary (*.msh); Points (*.pts)"),
                         InputError);
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
