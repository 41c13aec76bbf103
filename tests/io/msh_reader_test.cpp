#include <doctest/doctest.h>

#include <random>

#include "base/error.hpp"
#include "io/msh_samples.hpp"

using namespace almesh;
using namespace almesh::test;
using doctest::Contains;

namespace {

void check_refused(const std::string& text, const std::string& message) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(parse_msh(text, "a.msh"), Contains(message.c_str()), InputError);
}

}  // namespace

TEST_CASE("MSH 2.2, 4.0 and 4.1 hold the same mesh") {
    const RawMesh old = parse_msh(in_2_2, "a.msh"), mesh = parse_msh(in_4_1, "a.msh");
    CHECK(old.format == FileFormat{.msh_version = 22});
    CHECK(mesh.format == FileFormat{.msh_version = 41});
    check_is_the_triangle(old);
    check_is_the_triangle(mesh);
    CHECK(old.nodes[2].line == 13);
    CHECK(old.elements[4].line == 21);
    CHECK(mesh.nodes[2].line == 25);
    CHECK(mesh.elements[4].line == 37);
    REQUIRE(find_entity(mesh.entities, 1, 12) != nullptr);
    CHECK(find_entity(mesh.entities, 1, 12)->physical == std::vector<int>{4, 6});
    CHECK(find_entity(mesh.entities, 2, 12) == nullptr);
}

TEST_CASE("MSH 4 files list the entities with their groups") {
    CHECK(parse_msh(in_4_0, "a.msh").format == FileFormat{.msh_version = 40});
    for (const std::string& text : {in_4_0, in_4_1}) {
        const RawMesh mesh = parse_msh(text, "a.msh");
        check_is_the_triangle(mesh);
        REQUIRE(mesh.entities.size() == 4);
        CHECK(mesh.entities[0].key == EntityKey{0, 1});
        CHECK(mesh.entities[2].physical == std::vector<int>{4, 6});
    }
}

TEST_CASE("nodes with parameters are read without them") {
    std::string text = in_2_2;
    for (const char* section : {"$Nodes", "$EndNodes"})
        text = replaced(text, section, section == std::string("$Nodes") ? "$ParametricNodes" : "$EndParametricNodes");
    text = replaced(text, "1 0 0 0\n", "1 0 0 0 0 1\n");
    text = replaced(text, "2 1 0 0\n", "2 1 0 0 1 11 0.5\n");
    check_is_the_triangle(parse_msh(replaced(text, "1e-300\n", "1e-300 2 1 0.5 0.25\n"), "a.msh"));
    check_refused(replaced(text, "1 11 0.5", "x"), "a.msh:12: expected the dimension of the entity, got `x`");
    check_refused(replaced(in_4_1, "$Nodes", "$ParametricNodes"), "a.msh:16: parametric nodes of MSH 4 are in $Nodes");
}

TEST_CASE("blank lines, CR LF, blanks at line ends and unknown sections change nothing") {
    for (const std::string& text : {in_2_2, in_4_0, in_4_1}) {
        std::string wild = "\n";
        for (const char c : text) wild += c == '\n' ? std::string(" \t\r\n\n") : std::string(1, c);
        check_is_the_triangle(parse_msh(wild, "a.msh"));
        const std::string extra = "$Periodic\n1\n0 2 1\n$EndPeriodic\n$Nodes";
        check_is_the_triangle(
            parse_msh("$Comments\nwhatever $Nodes\n$EndComments\n" + replaced(text, "$Nodes", extra), "a.msh"));
        check_is_the_triangle(parse_msh(text.substr(0, text.size() - 1), "a.msh"));  // no line end at the end
    }
}

TEST_CASE("ids may be sparse and in any order") {
    std::string text = replaced(in_2_2, "5 0 1 1e-300", "9000000000000000000 0 1 0");
    for (const char* element : {"2 5\n", "12 5 1\n", "1 2 5\n"}) {
        const std::string line = element;
        text = replaced(text, line,
                        line.substr(0, line.find('5')) + "9000000000000000000" + line.substr(line.find('5') + 1));
    }
    const RawMesh mesh = parse_msh(text, "a.msh");
    CHECK(mesh.element_nodes == parse_msh(in_2_2, "a.msh").element_nodes);
    check_refused(replaced(text, "8 2 2 9 1 1", "8 2 2 9 1 3"),
                  "a.msh:21: the element has node 3, which is not in $Nodes");
}

TEST_CASE("all degrees of all simplices") {
    const int types[4][7] = {{}, {1, 8, 26, 27, 28, 62, 63}, {2, 9, 21, 23, 25, 42, 43}, {4, 11, 29, 30, 31, 71, 72}};
    const int nodes[4][7] = {{}, {2, 3, 4, 5, 6, 7, 8}, {3, 6, 10, 15, 21, 28, 36}, {4, 10, 20, 35, 56, 84, 120}};
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= 7; ++degree) {
            std::string element = "1 " + std::to_string(types[dim][degree - 1]) + " 0";
            for (int k = 0; k < nodes[dim][degree - 1]; ++k) element += " 1";
            const RawMesh mesh = parse_msh("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n"
                                           "$Elements\n1\n" + element + "\n$EndElements\n", "a.msh");
            CHECK(mesh.elements[0].dim == dim);
            CHECK(mesh.elements[0].degree == degree);
            CHECK(mesh.elements[0].physical == 0);
            CHECK(mesh.element_nodes.size() == static_cast<std::size_t>(nodes[dim][degree - 1]));
        }
}

TEST_CASE("other element types are refused together, by number and line") {
    const std::string text = replaced(replaced(in_2_2, "2 1 2 4 11 1 2", "2 97 2 4 11 1 2 5 1 1"), "4 1 2 4 12 5 1",
                                      "4 97 2 4 12 5 1 2 2 1");
    check_refused(text, "a.msh:18: 2 elements of type 97, the first in line 18: only triangles, quadrilaterals, tetrahedra, "
                        "hexahedra, prisms and pyramids of degree 1 to 7 with all their nodes are read (mesh with "
                        "Mesh.SecondOrderIncomplete = 0 and a Mesh.ElementOrder of at most 7)");
    check_refused(replaced(text, "8 2 2 9 1", "8 20 2 9 1 1 2 5 1 2 5"), "; 1 element of type 20");
    check_refused(replaced(in_4_1, "1 12 1 1\n4 5 1", "3 12 99 1\n4 5 1 1 1 1 1 1 1"),
                  "a.msh:34: 1 element of type 99");
    check_refused(replaced(in_2_2, "8 2 2", "8 999 2"), "a.msh:21: 1 element of type 999");
}

TEST_CASE("what is no mesh of version 1, 2.2, 4.0 or 4.1 is refused") {
    check_refused("solid cube\n", "a.msh:1: not a Gmsh mesh file");
    check_refused("\n\n", "not a Gmsh mesh file: there is no $MeshFormat section");
    check_refused(replaced(in_2_2, "2.2 0", "2.2 1"), "a.msh: $MeshFormat, byte 20: expected the number 1 in four");
    check_refused(replaced(in_2_2, "2.2 0", "3 0"), "a.msh:2: format version `3`: only 1, 2 to 2.2, 4.0 and 4.1 are read");
    check_refused(replaced(in_2_2, "2.2 0", "2.2 x"), "a.msh:2: expected 0 (ASCII) or 1 (binary), got `x`");
    check_refused(replaced(in_2_2, "$Nodes", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes"), "a second $MeshFormat");
    check_refused("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "there is no $Nodes section");
    check_refused(in_2_2.substr(0, in_2_2.find("$Elements")), "there is no $Elements section");
    check_refused(replaced(in_4_1, "$Nodes", "$PartitionedEntities\n1\n$EndPartitionedEntities\n$Nodes"),
                  "a.msh:18: `$EndPartitionedEntities` comes too early: $PartitionedEntities announces 1 ghost entities");
    check_refused(replaced(in_2_2, "$Nodes", "$PartitionedEntities\n1\n$EndPartitionedEntities\n$Nodes"),
                  "a.msh:9: it belongs into MSH 4");
    check_refused(replaced(in_2_2, "$Nodes\n3", "3"), "a.msh:9: expected a section such as $Nodes, got `3`");
}

TEST_CASE("ids that repeat or are not there are refused") {
    check_refused(replaced(in_2_2, "2 1 0 0", "1 1 0 0"), "a.msh:12: node id 1 is there twice, first in line 11");
    check_refused(replaced(in_2_2, "3 1 4", "8 1 4"), "a.msh:21: element id 8 is there twice, first in line 19");
    check_refused(replaced(in_2_2, "8 2 2 9 1 1", "8 2 2 9 1 4"),
                  "a.msh:21: the element has node 4, which is not in $Nodes");
    check_refused(replaced(in_2_2, "8 2 2 9 1 1", "8 2 2 9 1 0"), "a.msh:21: a node id `0` is out of range");
    check_refused(replaced(in_2_2, "2 1 0 0", "-2 1 0 0"), "a.msh:12: a node id `-2` is out of range");
    check_refused(replaced(in_4_1, "2\n1 0 0", "5\n1 0 0"), "node id 5 is there twice");
    check_refused(replaced(in_4_1, "8 1 2 5", "8 1 2 6"), "the element has node 6");
}

TEST_CASE("garbage, missing and too many numbers are refused where they stand") {
    check_refused(replaced(in_2_2, "2 1 0 0", "2 1 0"), "a.msh:12: expected a coordinate, got the end of the line");
    check_refused(replaced(in_2_2, "2 1 0 0", "2 1 0 0 0"), "a.msh:12: expected the end of the line, got `0`");
    check_refused(replaced(in_2_2, "2 1 0 0", "2 1 nan 0"), "a.msh:12: a coordinate `nan` is not a finite number");
    check_refused(replaced(in_2_2, "1e-300", "1e999"), "a.msh:13: a coordinate `1e999` is not a finite number");
    check_refused(replaced(in_2_2, "8 2 2 9", "8 2 2 99999999999"), "a.msh:21: a tag `99999999999` is out of range");
    check_refused(replaced(in_2_2, "3 1 4 4 11 1 7 2 5", "3 1 99 4 11 1 7 2 5"),
                  "a.msh:19: expected a tag, got the end of the line");
    check_refused(replaced(in_2_2, "1 4 \"the wall\"", "1 4"), "a.msh:6: physical group 4 has an empty name");
    check_refused(replaced(in_2_2, "1 4 \"the wall\"", "1 4 \"the\033wall\""),
                  "a.msh:6: a name with control characters");
    check_refused(replaced(in_4_1, "1 11 1 2\n2", "2 11 1 2\n2"), "element type 1 in an entity of dimension 2");
}

TEST_CASE("counts that do not hold are refused without making room for them") {
    check_refused(replaced(in_2_2, "$Nodes\n3", "$Nodes\n2000000000"),
                  "a.msh:14: `$EndNodes` comes too early: $Nodes announces 2000000000 nodes, only 3 are there");
    check_refused(replaced(in_2_2, "$Nodes\n3", "$Nodes\n2"),
                  "a.msh:13: expected $EndNodes: $Nodes holds more than it announces");
    check_refused(replaced(in_2_2, "$Nodes\n3", "$Nodes\n9000000000000"),
                  "a.msh:10: the number of nodes `9000000000000` is out of range");
    check_refused(replaced(in_2_2, "$Elements\n5", "$Elements\n2000000000"), "only 5 are there");
    check_refused(replaced(in_4_1, "2 3 1 5", "2000000000 2000000000 1 5"),
                  "announces 2000000000 blocks, only 2 are there");
    check_refused(replaced(in_4_1, "2 3 1 5", "2 4 1 5"), "$Nodes announces 4 nodes, its blocks hold 3");
    check_refused(replaced(in_4_1, "1 11 1 2\n1", "1 11 1 4\n1"),
                  "the number of nodes of this block `4` is out of range");
    check_refused(replaced(in_4_1, "4 5 1 8", "4 6 1 8"), "$Elements announces 6 elements, its blocks hold 5");
    check_refused(replaced(in_4_1, "1 2 1 0\n", "2000000000 2 1 0\n"),
                  "$Entities announces 2000000000 entities of this dimension, only 4 are there");
    check_refused(replaced(in_4_1, "0 0 0 0 1 0 2 4", "0 0 0 0 1 0 2000000000 4"), "expected a physical tag");
}

TEST_CASE("sections have to come once and in order") {
    const auto nodes = in_2_2.find("$Nodes"), elements = in_2_2.find("$Elements");
    const std::string node_section = in_2_2.substr(nodes, elements - nodes), element_section = in_2_2.substr(elements);
    check_refused(in_2_2.substr(0, nodes) + element_section + node_section, "a.msh:9: $Elements before $Nodes");
    check_refused(in_2_2 + node_section, "a second $Nodes section");
    check_refused(in_2_2 + element_section, "a second $Elements section");
    check_refused(in_4_1 + "$Entities\n0 0 0 0\n$EndEntities\n", "$Entities after $Elements");
}

TEST_CASE("a file cut off anywhere, and one with a byte changed, is refused or read, never worse") {
    std::mt19937 random(1);
    for (const std::string& text : {in_2_2, in_4_0, in_4_1}) {
        for (std::size_t length = 0; length < text.size() - 14; ++length)
            CHECK_THROWS_AS(parse_msh(text.substr(0, length), "a.msh"), InputError);
        const std::string bytes = "0123456789 \n$-.e\x80";
        for (int k = 0; k < 3000; ++k) {
            std::string changed = text;
            changed[random() % text.size()] = bytes[random() % bytes.size()];
            try {
                parse_msh(changed, "a.msh");
            } catch (const InputError&) {
            }
        }
    }
}
