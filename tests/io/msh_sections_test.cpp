#include <doctest/doctest.h>

#include "base/error.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"

using namespace almesh;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Mesh built(const std::string& text) {
    std::vector<std::string> notes;
    return build_mesh(parse_msh(text, "a.msh"), notes);
}

const std::string data = "$NodeData\n1\n\"T\"\n1\n0\n3\n0\n1\n2\n1 0.5\n3 0.25\n$EndNodeData\n";
const std::string periodic = "$Periodic\n1\n0 2 1\n1\n2 1\n$EndPeriodic\n";

std::string square(const std::string& before_nodes, const std::string& after) {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + before_nodes +
           "$Nodes\n4\n1 0 0 0.2\n2 1 0 0.2\n3 1 1 0.2\n4 0 1 0.2\n$EndNodes\n"
           "$Elements\n2\n1 2 2 9 1 1 2 3\n2 2 2 9 1 1 3 4\n$EndElements\n" + after;
}

}  // namespace

TEST_CASE("sections that say nothing of the mesh are named, and not in a mesh that is written anew") {
    const Mesh mesh = built(square("$Something\n1 2 3\n$EndSomething\n", periodic + data));
    CHECK(mesh.file.sections == std::vector<std::string>{"$Something", "$Periodic", "$NodeData"});
    CHECK(msh_text(mesh, mesh.x) == msh_text(built(square("", "")), mesh.x));
}

TEST_CASE("a mesh in a plane z = constant comes back in it") {
    const Mesh mesh = built(square("", ""));
    CHECK(has(msh_text(mesh, mesh.x), "\n3 1 1 0.2\n"));
}

TEST_CASE("a partitioned mesh is read, with the groups of its pieces, which are entities like others written anew") {
    const std::string head =
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 7 \"wall\"\n2 9 \"inside\"\n$EndPhysicalNames\n"
        "$Entities\n0 1 1 0\n1 0 0 0 1 1 0 1 7 0\n1 0 0 0 1 1 0 1 9 1 1\n$EndEntities\n";
    const std::string pieces =
        "$PartitionedEntities\n2\n0\n0 1 2 0\n2 1 1 1 1 0 0 0 1 1 0 1 7 0\n2 2 1 1 1 0 0 0 1 1 0 1 9 1 2\n"
        "3 2 1 1 2 0 0 0 1 1 0 1 9 0\n$EndPartitionedEntities\n";
    const std::string rest =
        "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
        "$Elements\n3 6 1 6\n1 2 1 4\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n2 2 2 1\n5 1 2 3\n2 3 2 1\n6 1 3 4\n$EndElements\n";
    const Mesh mesh = built(head + pieces + rest);
    CHECK(mesh.boundaries == std::vector<std::string>{"wall"});
    CHECK(mesh.file.element_physical == std::vector<int>{9, 9});
    const Mesh other = built(msh_text(mesh, mesh.x));
    CHECK(other.boundaries == mesh.boundaries);
    CHECK(other.file.element_entity == mesh.file.element_entity);
    CHECK(other.file.element_physical == std::vector<int>{9, 9});
}

TEST_CASE("MSH 2, 2.0 and 2.1 are read as 2.2, also with names that have no dimension") {
    const std::string rest =
        "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n6\n1 1 2 7 1 1 2\n2 1 2 7 1 2 3\n"
        "3 1 2 8 2 3 4\n4 1 2 8 2 4 1\n5 2 2 7 3 1 2 3\n6 2 2 7 3 1 3 4\n$EndElements\n";
    for (const std::string version : {"2", "2.0", "2.1", "2.2"})
        for (const std::string names : {"3\n1 7 \"wall\"\n1 8 \"lid\"\n2 7 \"wall\"\n", "2\n7 \"wall\"\n8 \"lid\"\n"}) {
            const Mesh mesh = built("$MeshFormat\n" + version + " 0 8\n$EndMeshFormat\n$PhysicalNames\n" + names +
                                    "$EndPhysicalNames\n" + rest);
            CHECK(mesh.boundaries == std::vector<std::string>{"wall", "lid"});
            CHECK(group_name(mesh.file.groups, 2, 7) == "wall");
            CHECK(to_string(mesh.file.format) == "MSH 2.2, ASCII");
            CHECK(mesh.file.groups.size() == 3);
        }
    CHECK_THROWS_WITH_AS(built("$MeshFormat\n2.3 0 8\n$EndMeshFormat\n" + rest), doctest::Contains("format version `2.3`"),
                         InputError);
}

TEST_CASE("MSH 1 is read, and written anew as MSH 2.2") {
    const std::string text =
        "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n40 0 1 0\n$ENDNOD\n"
        "$ELM\n4\n1 1 7 1 2 1 2\n2 1 7 1 2 2 3\n3 2 9 5 3 1 2 3\n4 2 9 5 3 1 3 40\n$ENDELM\n";
    CHECK(looks_like_msh(text));
    const Mesh mesh = built(text);
    CHECK(mesh.boundaries == std::vector<std::string>{"tag 7", "untagged"});
    CHECK(mesh.file.element_entity == std::vector<int>{5, 5});
    CHECK(to_string(mesh.file.format) == "MSH 1.0, ASCII");
    CHECK(has(msh_text(mesh, mesh.x), "$MeshFormat\n2.2 0 8\n"));
    CHECK_THROWS_WITH_AS(built(text.substr(0, 60)), doctest::Contains("a.msh:10: expected a tag"), InputError);
    std::string wrong = text;
    wrong.replace(wrong.find("3 2 9 5 3"), 9, "3 2 9 5 4");
    CHECK_THROWS_WITH_AS(built(wrong), doctest::Contains("a.msh:12: an element of this type has 3 nodes"), InputError);
}
