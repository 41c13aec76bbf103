#include "mesh/sub_simplices.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "mesh/lagrange.hpp"

using namespace almesh;

namespace {

// A field with all powers that a quadrilateral of this degree has, at its nodes.
std::vector<double> field_at_nodes(const LagrangeBasis& basis) {
    std::vector<double> value;
    for (int i = 0; i < basis.count; ++i) {
        const std::array<double, 3> xi = basis.point(i);
        double x = 1, y = 1;
        for (int k = 0; k < basis.degree; ++k) {
            x *= xi[0] - 0.3 * k;
            y *= xi[1] + 0.2 * k;
        }
        value.push_back(x * y);
    }
    return value;
}

}  // namespace

TEST_CASE("the two triangles of a quadrilateral have its map") {
    for (int degree = 1; degree <= 4; ++degree) {
        const LagrangeBasis of_cell(quadrilateral(), degree), of_triangle(2, 2 * degree);
        const SubSimplices parts(quadrilateral(), degree, 2 * degree);
        REQUIRE(parts.count() == 2);
        CHECK(parts.degree == 2 * degree);
        const std::vector<double> u = field_at_nodes(of_cell);
        for (int k = 0; k < 2; ++k) {
            std::vector<double> at_nodes(parts.nodes), N(of_cell.count), M(parts.nodes);
            for (int i = 0; i < parts.nodes; ++i)
                at_nodes[i] = std::inner_product(u.begin(), u.end(), &parts.map[k][i * parts.cell_nodes], 0.0);
            for (const std::array<double, 4>& l : {std::array{0.2, 0.3, 0.5, 0.0}, std::array{0.7, 0.1, 0.2, 0.0}}) {
                of_cell.values(parts.point(k, l).data(), N.data());
                of_triangle.values(&l[1], M.data());
                CHECK(std::inner_product(M.begin(), M.end(), at_nodes.begin(), 0.0) ==
                      doctest::Approx(std::inner_product(N.begin(), N.end(), u.begin(), 0.0)).epsilon(1e-12));
            }
        }
    }
}

TEST_CASE("vertices of the parts are those of the cell to the last bit, the simplex is its own part") {
    for (int degree = 1; degree <= 4; ++degree)
        for (const CellType* cell : {&quadrilateral(), &simplex(2), &simplex(3)}) {
            const SubSimplices parts(*cell, degree, cell->is_simplex() ? degree : 2 * degree);
            for (int k = 0; k < parts.count(); ++k)
                for (int v = 0; v <= cell->dim; ++v)
                    for (int j = 0; j < parts.cell_nodes; ++j)
                        CHECK(parts.map[k][v * parts.cell_nodes + j] == (j == parts.vertices[k][v]));
            if (!cell->is_simplex()) continue;
            REQUIRE(parts.count() == 1);
            CHECK(parts.degree == degree);
            for (int i = 0; i < parts.nodes; ++i)
                for (int j = 0; j < parts.nodes; ++j) CHECK(parts.map[0][i * parts.nodes + j] == (i == j));
        }
}
