#include <doctest/doctest.h>

#include "base/error.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"
#include "mesh/inner_boundary.hpp"
#include "support/temporary_folder.hpp"

using namespace almesh;
using doctest::Contains;

namespace {

Mesh mesh_of(const std::string& text, std::vector<std::string>* told = nullptr) {
    std::vector<std::string> notes;
    Mesh mesh = build_mesh(parse_mesh(text, "a.inp"), notes);
    if (told) *told = notes;
    return mesh;
}

std::vector<std::string> groups_of(const Mesh& mesh) {
    std::vector<std::string> names;
    for (const GroupCells& group : volume_groups(mesh)) names.push_back(concat(group.name, " ", group.cells.size()));
    return names;
}

// The nodes of each boundary face by the name of its boundary.
std::vector<std::string> faces_of(const Mesh& mesh) {
    std::vector<std::string> faces;
    for (int f = 0; f < mesh.face_count(); ++f) {
        std::vector<long long> ids;
        for (int k = 0; k < mesh.face_cell(f).vertices; ++k) ids.push_back(mesh.file.node_id[mesh.face(f)[k]]);
        std::sort(ids.begin(), ids.end());
        std::string text = mesh.boundaries[mesh.face_boundary[f]];
        for (const long long id : ids) text += concat(" ", id);
        faces.push_back(text);
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

const std::string tetrahedron = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=Eall\n7,1,2,3,4\n";

}  // namespace

TEST_CASE("Abaqus in any case, with comments, continued lines, Fortran's exponents and a byte-order mark") {
    const std::string text =
        "\xEF\xBB\xBF** a comment\r\n*Heading\r\n a title, not data\r\n*node , nset = \"All Nodes\"\r\n"
        " 1 ,\t0.0 , 0. , 0.D+00 ,\r\n2,1.0d0,.0,0,\r\n** among data\r\n3,0,+1.,0\r\n4,0,0,1.E0\r\n"
        "5,5e-1,0,0\r\n6,.5,.5,0\r\n"
        "7,0,.5,0\r\n8,0,0,.5\r\n9,.5,0,.5\r\n10,0,.5,.5\r\n"
        "*Element, type=c3d10M,\r\n elset=Solid\r\n 4, 1,2,3,4,\r\n 5,6,7,\r\n 8,9,10,\r\n"
        "*STEP\r\n*NODE PRINT,NSET=NALL\r\nU\r\n*END STEP\r\n";
    const RawMesh raw = parse_mesh(text, "a.inp");
    REQUIRE(raw.nodes.size() == 10);
    CHECK(raw.nodes[1].x[0] == 1);
    CHECK(raw.nodes[3].x[2] == 1);
    CHECK(raw.nodes[1].line == 6);
    REQUIRE(raw.coordinates.first.size() == 30);
    CHECK(text.substr(raw.coordinates.first[2], 7) == "0.D+00 ");
    CHECK(text.substr(raw.coordinates.first[8], 3) == "0\r\n");
    const Mesh mesh = mesh_of(text);
    CHECK(mesh.degree == 2);
    CHECK(straight_sided(mesh) == mesh.x);  // the nodes of edges are where they belong
    CHECK(groups_of(mesh) == std::vector<std::string>{"Solid 1"});
    CHECK(to_string(mesh.file.format) == "Abaqus and CalculiX");
}

TEST_CASE("Abaqus: nodes of all second-order cells are in the order of their edges") {
    struct Case {
        const char* type;
        std::vector<std::array<double, 3>> vertices;
        std::vector<std::array<int, 2>> edges;
    };
    const std::vector<std::array<double, 3>> cube = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const std::vector<Case> cases = {
        {"C3D20R", cube,
         {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}},
        {"C3D15", {cube[0], cube[1], cube[3], cube[4], cube[5], cube[7]},
         {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}},
        {"C3D10", {cube[0], cube[1], cube[3], cube[4]}, {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}},
        {"CPE8R", {cube[0], cube[1], cube[2], cube[3]}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
        {"CAX6", {cube[0], cube[1], cube[3]}, {{0, 1}, {1, 2}, {2, 0}}}};
    for (const Case& c : cases) {
        CAPTURE(c.type);
        std::string text = "*NODE\n", row = "*ELEMENT, TYPE=" + std::string(c.type) + "\n1";
        std::vector<std::array<double, 3>> points = c.vertices;
        for (const auto [a, b] : c.edges) {
            std::array<double, 3> middle;
            for (int k = 0; k < 3; ++k) middle[k] = (c.vertices[a][k] + c.vertices[b][k]) / 2;
            points.push_back(middle);
        }
        for (std::size_t k = 0; k < points.size(); ++k) {
            text += concat(k + 1, ",", points[k][0], ",", points[k][1], ",", points[k][2], "\n");
            row += concat(k == 9 ? ",\n" : ",", k + 1);
        }
        const Mesh mesh = mesh_of(text + row + "\n");
        CHECK(mesh.degree == 2);
        CHECK(straight_sided(mesh) == mesh.x);
    }
}

TEST_CASE("Abaqus: surfaces of element sides are boundaries, by the numbers of the sides") {
    const std::string sides =
        "*SURFACE, NAME=A, TYPE=ELEMENT\nEall, S1\n*SURFACE,NAME=b\n7,S2\n"
        "*SURFACE, NAME=c\n7, S3\n*SURFACE,NAME=d\n7,S4\n";
    CHECK(faces_of(mesh_of(tetrahedron + sides)) ==
          std::vector<std::string>{"A 1 2 3", "b 1 2 4", "c 2 3 4", "d 1 3 4"});
    CHECK(faces_of(mesh_of(tetrahedron + "*SURFACE,NAME=whole\nEALL,\n*SURFACE,NAME=more\n7,s1\n")) ==
          std::vector<std::string>{"whole + more 1 2 3", "whole 1 2 4", "whole 1 3 4", "whole 2 3 4"});
    const std::string nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n";
    std::string cube = nodes + "*ELEMENT, TYPE=C3D8I\n1,1,2,3,4,5,6,7,8\n";
    for (int s = 1; s <= 6; ++s) cube += concat("*SURFACE,NAME=s", s, "\n1,S", s, "\n");
    CHECK(faces_of(mesh_of(cube)) == std::vector<std::string>{"s1 1 2 3 4", "s2 5 6 7 8", "s3 1 2 5 6", "s4 2 3 6 7",
                                                              "s5 3 4 7 8", "s6 1 4 5 8"});
    std::string prism = nodes + "*ELEMENT, TYPE=C3D6\n1,1,2,4,5,6,8\n";
    for (int s = 1; s <= 5; ++s) prism += concat("*SURFACE,NAME=s", s, "\n1,S", s, "\n");
    CHECK(faces_of(mesh_of(prism)) == std::vector<std::string>{"s1 1 2 4", "s2 5 6 8", "s3 1 2 5 6", "s4 2 4 6 8",
                                                               "s5 1 4 5 8"});
    std::string square = nodes + "*ELEMENT, TYPE=CPS4\n1,1,2,3,4\n";
    for (int s = 1; s <= 4; ++s) square += concat("*SURFACE,NAME=s", s, "\n1,S", s, "\n");
    CHECK(faces_of(mesh_of(square)) == std::vector<std::string>{"s1 1 2", "s2 2 3", "s3 3 4", "s4 1 4"});
    std::string shell = nodes + "*ELEMENT, TYPE=S4R\n1,1,2,3,4\n*SURFACE,NAME=top\n1,SPOS\n*SURFACE,NAME=s\n1,S3\n";
    CHECK(faces_of(mesh_of(shell + "*SURFACE,NAME=e\n1,E4\n")) ==
          std::vector<std::string>{"e 1 4", "s 1 2", "untagged 2 3", "untagged 3 4"});
    CHECK_THROWS_WITH_AS(mesh_of(tetrahedron + "*SURFACE,NAME=a\n7,S5\n"),
                         "a.inp:9: a tetrahedron has no side `S5`", InputError);
    CHECK_THROWS_WITH_AS(mesh_of(tetrahedron + "*SURFACE,NAME=a\nnone,S1\n"), "a.inp:9: there is no set `none` before",
                         InputError);
}

TEST_CASE("Abaqus: shells on solids, and node sets where there is nothing else, are boundaries") {
    CHECK(faces_of(mesh_of(tetrahedron + "*ELEMENT,TYPE=S3,ELSET=skin\n8,1,2,3\n")) ==
          std::vector<std::string>{"skin 1 2 3", "untagged 1 2 4", "untagged 1 3 4", "untagged 2 3 4"});
    const std::string sets = "*NSET,NSET=three\n1,2,\n3\n*NSET,NSET=range,GENERATE\n2,4\n*NSET,NSET=all\nthree, 4\n"
                             "*NSET,NSET=all2,GENERATE\n0,2000000000,1\n*NSET,NSET=two\n1,2,99\n";
    CHECK(faces_of(mesh_of(tetrahedron + sets)) ==
          std::vector<std::string>{"range 2 3 4", "three 1 2 3", "untagged 1 2 4", "untagged 1 3 4"});
    CHECK(faces_of(mesh_of(tetrahedron + sets + "*SURFACE,NAME=s\n7,S4\n"))[0] == "s 1 3 4");
    CHECK(faces_of(mesh_of(tetrahedron + "*SURFACE,TYPE=NODE,NAME=n\n1,\n2,\n4,\n"))[0] == "n 1 2 4");
}

TEST_CASE("Abaqus: element sets are groups of volumes, one in several sets of each of them") {
    const Mesh mesh = mesh_of(
        "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n6,5,5,5\n*ELEMENT,TYPE=C3D4,ELSET=a\n1,1,2,3,4\n"
        "*ELEMENT,TYPE=C3D4,ELSET=b\n2,2,3,4,5\n*ELEMENT,TYPE=MASS,ELSET=m\n3,6\n*ELEMENT,TYPE=B31\n4,5,6\n"
        "*ELSET,ELSET=Both\nA,b,3\n*ELSET,ELSET=gen,GENERATE\n2,10,2\n");
    CHECK(groups_of(mesh) == std::vector<std::string>{"a 1", "Both 2", "b 1", "gen 1"});
}

TEST_CASE("Abaqus: one part and its instance are read, with the names of sets of the assembly") {
    const std::string part = "*PART,NAME=p\n" + tetrahedron + "*END PART\n*ASSEMBLY,NAME=a\n*INSTANCE,NAME=i,PART=p\n"
                             "1.,2.,3.\n*END INSTANCE\n*NODE\n1,9,9,9\n*NSET,NSET=ref\n1,\n"
                             "*ELSET,ELSET=s_S1,INSTANCE=i\n7\n*SURFACE,NAME=s\ns_S1,S1\n*SURFACE,NAME=t\ni.Eall,S2\n"
                             "*END ASSEMBLY\n";
    CHECK(faces_of(mesh_of(part)) ==
          std::vector<std::string>{"s 1 2 3", "t 1 2 4", "untagged 1 3 4", "untagged 2 3 4"});
    CHECK_THROWS_WITH_AS(mesh_of("*PART\n*END PART\n*PART\n"),
                         "a.inp:3: a second *PART: only a file with one part is read", InputError);
    CHECK_THROWS_WITH_AS(mesh_of("*INSTANCE\n*END INSTANCE\n*INSTANCE\n"), Contains("a second *INSTANCE"), InputError);
}

TEST_CASE("Abaqus: included files are read from the folder of the file, and their coordinates cannot be patched") {
    const test::TemporaryFolder folder;
    folder.write("mesh.inc", tetrahedron);
    const std::string path = folder.write("main.inp", "*INCLUDE, INPUT=mesh.inc\n*NSET,NSET=n\n1,2,3\n");
    const RawMesh raw = read_mesh(path);
    CHECK(raw.nodes.size() == 4);
    CHECK(raw.coordinates.first.empty());
    REQUIRE(raw.notes.size() == 1);
    CHECK(raw.notes[0] ==
          "its nodes are in included files, which are not written again: give the file of the nodes itself");
    CHECK_THROWS_WITH_AS(read_mesh(folder.write("a.inp", "*NODE\n*INCLUDE,INPUT=a.inp\n")),
                         Contains("a.inp:2: the file includes itself"), InputError);
    CHECK_THROWS_WITH_AS(read_mesh(folder.write("b.inp", "*INCLUDE,INPUT=none.inc\n")),
                         Contains("none.inc: No such file or directory"), InputError);
}

TEST_CASE("Abaqus: what is not read is refused with a sentence") {
    const auto refused = [](const std::string& text, const char* message) {
        CHECK_THROWS_WITH_AS(mesh_of(text), Contains(message), InputError);
    };
    refused("*NODE\n1,0,0,0\n*NGEN\n1,5\n", "a.inp:3: *NGEN: nodes and elements have to be listed");
    refused("*NODE, SYSTEM=C\n1,0,0,0\n", "a.inp:1: nodes in the coordinates SYSTEM=C");
    refused("*NODE\n1,0,x,0\n", "a.inp:2: expected a coordinate, got `x`");
    refused("*NODE\nx,0,0,0\n", "a.inp:2: expected the number of a node, got `x`");
    refused("*ELEMENT, TYPE=C3D4\n1,1,2,3\n*STEP\n", "a.inp:3: expected 1 more nodes of the element before");
    refused("*ELEMENT, TYPE=C3D4\n1,1,2,3\n", "a.inp:2: the file ends within the nodes of an element");
    refused(tetrahedron + "8,1,2,3,9\n", "a.inp:8: element 8 has node 9, which is not there");
    refused(tetrahedron + "7,1,2,3,4\n", "a.inp:8: element 7 is there twice");
    refused(tetrahedron + "*NSET,NSET=a\nnone\n", "a.inp:9: there is no set `none` before");
    refused(tetrahedron + "*NSET,NSET=a,GENERATE\n1,2,0\n", "a.inp:9: expected FIRST, LAST, STEP");
    refused("*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D27\n1,1\n*ELEMENT, TYPE=C3D15V\n",
            "elements of type C3D15V, C3D27: only");
    refused("*NODE\n1,0,0,0\n*ELEMENT, TYPE=B31\n1,1,1\n", "only elements of type B31");
    refused("*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,1\n*ELEMENT, TYPE=S3\n1,1,2,3\n", "the elements form a surface in space");
}

TEST_CASE("a surface may name lines of a mesh in the plane") {
    const std::string plane = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT,TYPE=CPS3\n1,1,2,3\n*ELEMENT,TYPE=T3D2\n2,1,2\n";
    CHECK(faces_of(mesh_of(plane + "*SURFACE,NAME=S\n2,\n")) ==
          std::vector<std::string>{"S 1 2", "untagged 1 3", "untagged 2 3"});
}

TEST_CASE("Abaqus and VTK: what the file has besides the mesh is named, for a mesh that is written anew") {
    const std::string more = "*MATERIAL,NAME=S\n*ELASTIC\n1,0.3\n*STEP\n*STATIC\n*END STEP\n*STEP\n*END STEP\n";
    const std::vector<std::string> names = {"*MATERIAL", "*ELASTIC", "*STEP", "*STATIC"};
    CHECK(parse_mesh(tetrahedron + more, "a.inp").sections == names);
    CHECK(parse_mesh(tetrahedron, "a.inp").sections.empty());
    const std::string vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n0 0 0 1 0 0 "
                            "0 1 0\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n";
    CHECK(parse_mesh(vtk, "a.vtk").sections.empty());
    CHECK(parse_mesh(vtk + "POINT_DATA 3\nSCALARS p double\n", "a.vtk").sections ==
          std::vector<std::string>{"POINT_DATA"});
}
