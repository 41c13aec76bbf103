#include "energy/vertex_interpolation.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("nodes are interpolated from the vertices of an element: those of an affine one are where they belong") {
    for (const Mesh& linear : {ring_mesh(8, 2, 3), cube_mesh(2)})
        for (int degree = 2; degree <= 5; ++degree) {
            const Mesh mesh = raise_degree(linear, degree);
            const std::vector<double> x = straight_sided(mesh);
            const Interpolation P = vertex_interpolation(mesh);
            REQUIRE(P.rows() == mesh.nodes());
            CHECK(P.columns == linear.nodes());
            std::vector<int> vertex(P.columns, -1);  // that a column belongs to
            for (int i = 0; i < mesh.nodes(); ++i)
                if (P.row[i + 1] - P.row[i] == 1) {
                    CHECK(P.weight[P.row[i]] == 1);
                    CHECK(vertex[P.col[P.row[i]]] == -1);
                    vertex[P.col[P.row[i]]] = i;
                }
            for (int i = 0; i < mesh.nodes(); ++i) {
                double sum = 0;
                std::vector<double> at(mesh.dim, 0.0);
                for (int k = P.row[i]; k < P.row[i + 1]; ++k) {
                    CHECK(P.weight[k] > 0);
                    sum += P.weight[k];
                    for (int a = 0; a < mesh.dim; ++a) at[a] += P.weight[k] * point(x, vertex[P.col[k]], mesh.dim)[a];
                }
                CHECK(sum == doctest::Approx(1).epsilon(1e-15));
                for (int a = 0; a < mesh.dim; ++a) CHECK(std::abs(at[a] - point(x, i, mesh.dim)[a]) < 1e-14);
            }
        }
}

TEST_CASE("degree 1 has no lower degree") { CHECK(vertex_interpolation(cube_mesh(1)).columns == 0); }

TEST_CASE("in quadrilaterals a bilinear field is that of its vertices, next to triangles too") {
    for (int degree = 2; degree <= 4; ++degree) {
        const Mesh linear = mixed_mesh(4, 0.2), mesh = raise_degree(linear, degree);
        const Interpolation P = vertex_interpolation(mesh);
        REQUIRE(P.columns == linear.nodes());
        REQUIRE(P.rows() == mesh.nodes());
        for (int i = 0; i < mesh.nodes(); ++i)  // vertices come first: column v is node v
            for (int a = 0; a < 2; ++a) {
                double x = 0;
                for (int k = P.row[i]; k < P.row[i + 1]; ++k) x += P.weight[k] * linear.x[2 * P.col[k] + a];
                CHECK(x == doctest::Approx(mesh.x[2 * i + a]).epsilon(1e-14).scale(1));
            }
    }
}
