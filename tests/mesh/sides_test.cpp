#include "mesh/sides.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("a side sorts its vertices and knows whether that was an even permutation") {
    const int cyclic[] = {9, 4, 7}, swapped[] = {4, 9, 7}, quadrilateral[] = {8, 2, 6, 4}, edge[] = {3, 1};
    CHECK(Side(cyclic, 0).vertex == Side(swapped, 0).vertex);
    CHECK(Side(cyclic, 0).even);
    CHECK_FALSE(Side(swapped, 0).even);
    CHECK(Side(quadrilateral, 0).vertex == std::array{2, 4, 6, 8});
    CHECK_FALSE(Side(edge, 0).even);
    CHECK(Side(edge, 0).vertex[1] == 3);
    CHECK(Side(edge, 0) < Side(cyclic, 0));
    const int turned[] = {6, 4, 8, 2}, from_behind[] = {8, 4, 6, 2}, crossed[] = {8, 6, 2, 4};
    CHECK(Side(turned, 0).even == Side(quadrilateral, 0).even);
    CHECK(Side(from_behind, 0).even != Side(quadrilateral, 0).even);
    CHECK(Side(quadrilateral, 0).opposite == 1);
    CHECK(Side(from_behind, 0).opposite == 1);
    CHECK(Side(crossed, 0).opposite == 3);
    CHECK(Side(cyclic, 0).opposite == 0);
}

TEST_CASE("two tetrahedra share one side, seen from opposite sides; each has its number by its vertices") {
    Mesh mesh;
    mesh.dim = 3;
    mesh.x.assign(15, 0.0);
    mesh.elements = {0, 1, 2, 3, 1, 2, 3, 4};
    std::vector<Side> sides;
    for (int e = 0; e < 2; ++e)
        for (int k = 0; k < 4; ++k) sides.push_back(side_of_cell(simplex(3), mesh.element(e), k, 4 * e + k));
    std::vector<int> shared, alone;
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        for (const Side& side : equal) (equal.size() == 2 ? shared : alone).push_back(side.number);
        if (equal.size() == 2) CHECK(equal[0].even != equal[1].even);
    });
    CHECK(shared == std::vector{0, 7});
    CHECK(alone == std::vector{3, 2, 1, 6, 5, 4});
    const int face[] = {3, 1, 2}, none[] = {0, 1, 4};
    CHECK(side_number(mesh, 0, face) == 0);
    CHECK(side_number(mesh, 1, face) == 3);
    CHECK(side_number(mesh, 0, none) == -1);
}
