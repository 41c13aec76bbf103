// One triangle of degree 1 with its three edges and a point as an MSH file of each version, and the check that it is
// read.
#pragma once
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "io/msh.hpp"

namespace almesh::test {

// The messages of the tests count these lines.
inline const std::string in_2_2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 4 "the wall"
2 9 "inside"
$EndPhysicalNames
$Nodes
3
1 0 0 0
2 1 0 0
5 0 1 1e-300
$EndNodes
$Elements
5
1 15 2 0 1 1
2 1 2 4 11 1 2
3 1 4 4 11 1 7 2 5
4 1 2 4 12 5 1
8 2 2 9 1 1 2 5
$EndElements
)";

inline const std::string in_4_0 = R"($MeshFormat
4 0 8
$EndMeshFormat
$PhysicalNames
2
1 4 "the wall"
2 9 "inside"
$EndPhysicalNames
$Entities
1 2 1 0
1 0 0 0 0 0 0 0
12 0 0 0 0 1 0 2 4 6 2 1 -1
11 0 0 0 1 1 0 1 -4 2 1 -1
1 0 0 0 1 1 0 1 9 2 11 12
$EndEntities
$Nodes
2 3
11 1 1 2
1 0 0 0 0.25
5 0 1 1e-300 0.5
1 2 0 1
2 1 0 0
$EndNodes
$Elements
4 5
1 0 15 1
1 1
11 1 1 2
2 1 2
3 2 5
12 1 1 1
4 5 1
1 2 2 1
8 1 2 5
$EndElements
)";

inline const std::string in_4_1 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 4 "the wall"
2 9 "inside"
$EndPhysicalNames
$Entities
1 2 1 0
1 0 0 0 0
12 0 0 0 0 1 0 2 4 6 2 1 -1
11 0 0 0 1 1 0 1 -4 2 1 -1
1 0 0 0 1 1 0 1 9 2 11 12
$EndEntities
$Nodes
2 3 1 5
1 11 1 2
1
5
0 0 0 0.25
0 1 1e-300 0.5
2 1 0 1
2
1 0 0
$EndNodes
$Elements
4 5 1 8
0 1 15 1
1 1
1 11 1 2
2 1 2
3 2 5
1 12 1 1
4 5 1
2 1 2 1
8 1 2 5
$EndElements
)";

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

inline void check_is_the_triangle(const RawMesh& mesh) {
    REQUIRE(mesh.nodes.size() == 3);
    REQUIRE(mesh.elements.size() == 5);
    REQUIRE(mesh.groups.size() == 2);
    CHECK(mesh.groups[0].name == "the wall");
    CHECK(mesh.groups[1].dim == 2);
    CHECK(mesh.groups[1].tag == 9);
    const long long ids[] = {1, 2, 3, 4, 8};
    const int dims[] = {0, 1, 1, 1, 2}, physical[] = {0, 4, 4, 4, 9}, entity[] = {1, 11, 11, 12, 1};
    const std::vector<long long> nodes[] = {{1}, {1, 2}, {2, 5}, {5, 1}, {1, 2, 5}};
    for (int i = 0; i < 5; ++i) {
        const RawElement& element = mesh.elements[i];
        CHECK(element.id == ids[i]);
        CHECK(element.dim == dims[i]);
        CHECK(element.degree == 1);
        CHECK(element.physical == physical[i]);
        CHECK(element.entity == entity[i]);
        for (std::size_t k = 0; k < nodes[i].size(); ++k)
            CHECK(mesh.nodes[mesh.element_nodes[element.first + k]].id == nodes[i][k]);
    }
    for (const RawNode& node : mesh.nodes) {
        CHECK(node.x[0] == (node.id == 2));
        CHECK(node.x[1] == (node.id == 5));
        CHECK(node.x[2] == (node.id == 5 ? 1e-300 : 0));
    }
}

}  // namespace almesh::test
