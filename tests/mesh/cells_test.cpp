#include "mesh/cells.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "mesh/mesh.hpp"

using namespace almesh;

namespace {

// Positions of the vertices of the reference cell and of the midpoints of `bisected`, n coordinates each.
std::vector<double> positions(const CellType& cell) {
    std::vector<double> x(offset(cell.dim + 1, cell.dim), 0.0);
    for (int v = 1; v <= cell.dim; ++v) x[offset(v, cell.dim, v - 1)] = 1;
    for (const auto& [a, b] : cell.bisected)
        for (int k = 0; k < cell.dim; ++k) x.push_back((x[offset(a, cell.dim, k)] + x[offset(b, cell.dim, k)]) / 2);
    return x;
}

template <int n>
double volume(const int* vertex, const std::vector<double>& x) {
    return determinant(straight_jacobian<n>(vertex, x)) * simplex(n).volume();
}

}  // namespace

TEST_CASE("face k has all vertices but k, and looks outward") {
    for (int dim : {2, 3}) {
        const CellType& cell = simplex(dim);
        REQUIRE(static_cast<int>(cell.faces.size()) == dim + 1);
        const std::vector<double> x = positions(cell);
        for (int k = 0; k <= dim; ++k) {
            std::array<int, 4> joined = {k, cell.faces[k][0], cell.faces[k][1], cell.faces[k][2]};
            CHECK(std::set<int>(joined.begin(), joined.begin() + dim + 1).size() == cell.faces.size());
            // Vertex k and the face are the cell, positively oriented where the normal of the face points away from k.
            with_dimension(dim, [&](auto n) { CHECK(volume<n>(joined.data(), x) == cell.volume()); });
        }
    }
}

TEST_CASE("the children fill the cell and are positively oriented, whichever diagonal cuts the octahedron") {
    const auto check = [](auto n) {
        const CellType& cell = simplex(n);
        const std::vector<double> x = positions(cell);
        const double child_volume = cell.volume() / (1 << n);
        for (const CellChild& child : cell.children) CHECK(volume<n>(child.data(), x) == child_volume);
        for (const CellOctahedron& o : cell.octahedra)
            for (int k = 0; k < 4; ++k) {
                const int child[] = {o[0], o[1], o[2 + k], o[2 + (k + 1) % 4]};
                CHECK(volume<n>(child, x) == child_volume);
            }
        CHECK(cell.children.size() + (cell.octahedra.empty() ? 0 : 4) == 1u << n);
    };
    with_dimension(2, check);
    with_dimension(3, check);
}

TEST_CASE("interior faces are the faces, seen the same way, from another vertex at most") {
    const CellType& cell = simplex(3);
    REQUIRE(cell.interior_faces.size() == 4);
    for (CellFace face : cell.interior_faces) {
        int found = 0;
        for (int turn = 0; turn < 3; ++turn) {
            found += static_cast<int>(std::count(cell.faces.begin(), cell.faces.end(), face));
            std::rotate(face.begin(), face.begin() + 1, face.begin() + 3);
        }
        CHECK(found == 1);
    }
}

TEST_CASE("no two cells share an element type") {
    std::set<int> types = {0};
    for (const CellType& cell : cell_types())
        for (int type : cell.msh_types)
            if (cell.dim > 0) CHECK(types.insert(type).second);
}

TEST_CASE("the columns of the Jacobian are the edges from the first vertex") {
    const std::vector<double> plane = {9, 9, 1, 2, 4, 2, 2, 7}, space = {1, 1, 1, 3, 1, 1, 1, 4, 1, 1, 1, 5};
    const int triangle[] = {1, 2, 3}, tetrahedron[] = {0, 1, 2, 3};
    CHECK(straight_jacobian<2>(triangle, plane) == Mat<2>{{{3, 1}, {0, 5}}});
    CHECK(straight_jacobian<3>(tetrahedron, space) == Mat<3>{{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}});
}
