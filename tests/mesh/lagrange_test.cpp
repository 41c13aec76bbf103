#include "mesh/lagrange.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace almesh;

namespace {

std::vector<double> node_point(const LagrangeBasis& basis, int i) {
    std::vector<double> xi;
    for (int k = 1; k <= basis.dim; ++k) xi.push_back(static_cast<double>(basis.nodes[i][k]) / basis.degree);
    return xi;
}

}  // namespace

TEST_CASE("basis functions are one at their node and zero at the others") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= 7; ++degree) {
            const LagrangeBasis basis(dim, degree);
            std::vector<double> N(basis.count);
            for (int i = 0; i < basis.count; ++i) {
                basis.values(node_point(basis, i).data(), N.data());
                for (int j = 0; j < basis.count; ++j) CHECK(N[j] == doctest::Approx(i == j).epsilon(1e-12).scale(1));
            }
        }
}

TEST_CASE("basis functions sum to one, their gradients to zero, and gradients have slope 2") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= 6; ++degree) {
            const LagrangeBasis basis(dim, degree);
            std::vector<double> N(basis.count), plus(basis.count), minus(basis.count), dN(basis.count * dim);
            const double xi[3] = {0.21, 0.33, 0.17};
            basis.values(xi, N.data());
            basis.gradients(xi, dN.data());
            CHECK(std::accumulate(N.begin(), N.end(), 0.0) == doctest::Approx(1));
            for (int k = 0; k < dim; ++k) {
                double sum = 0, error[2] = {0, 0};
                for (int i = 0; i < basis.count; ++i) sum += dN[i * dim + k];
                CHECK(std::abs(sum) < 1e-11);
                for (int level = 0; level < 2; ++level) {
                    const double t = 1e-2 / (1 + level);
                    double up[3] = {xi[0], xi[1], xi[2]}, down[3] = {xi[0], xi[1], xi[2]};
                    up[k] += t;
                    down[k] -= t;
                    basis.values(up, plus.data());
                    basis.values(down, minus.data());
                    for (int i = 0; i < basis.count; ++i)
                        error[level] =
                            std::max(error[level], std::abs((plus[i] - minus[i]) / (2 * t) - dN[i * dim + k]));
                }
                if (degree >= 3) CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.05));
                else CHECK(error[0] < 1e-12);  // central differences are exact for quadratics
            }
        }
}

TEST_CASE("node order is Gmsh's") {
    // From the figures of the Gmsh manual, "Node ordering": triangle10 and tetrahedron10.
    const std::vector<MultiIndex> triangle = {{3, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 3, 0}, {2, 1, 0, 0}, {1, 2, 0, 0},
                                              {0, 2, 1, 0}, {0, 1, 2, 0}, {1, 0, 2, 0}, {2, 0, 1, 0}, {1, 1, 1, 0}};
    CHECK(gmsh_node_order(2, 3) == triangle);
    const std::vector<MultiIndex> tetrahedron = {{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 2}, {1, 1, 0, 0},
                                                 {0, 1, 1, 0}, {1, 0, 1, 0}, {1, 0, 0, 1}, {0, 0, 1, 1}, {0, 1, 0, 1}};
    CHECK(gmsh_node_order(3, 2) == tetrahedron);
}

TEST_CASE("every lattice point stands exactly once in the order") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= 7; ++degree) {
            auto nodes = gmsh_node_order(dim, degree);
            CHECK(static_cast<int>(nodes.size()) == simplex_node_count(dim, degree));
            for (const MultiIndex& a : nodes) CHECK(std::accumulate(a.begin(), a.end(), 0) == degree);
            std::sort(nodes.begin(), nodes.end());
            CHECK(std::adjacent_find(nodes.begin(), nodes.end()) == nodes.end());
        }
}

TEST_CASE("face nodes are the nodes with a zero barycentric entry") {
    for (int dim = 2; dim <= 3; ++dim)
        for (int degree = 1; degree <= 5; ++degree) {
            const LagrangeBasis basis(dim, degree);
            for (int opposite = 0; opposite <= dim; ++opposite) {
                const std::vector<int> face = basis.face_nodes(opposite);
                CHECK(static_cast<int>(face.size()) == simplex_node_count(dim - 1, degree));
                for (int i : face) CHECK(basis.nodes[i][opposite] == 0);
            }
        }
}

TEST_CASE("swapping two vertices maps each node to its mirror image") {
    const LagrangeBasis basis(3, 4);
    for (int i = 0; i < basis.count; ++i) {
        const int j = basis.permuted_node(i, {1, 0, 2, 3});
        CHECK(basis.nodes[j][0] == basis.nodes[i][1]);
        CHECK(basis.nodes[j][2] == basis.nodes[i][2]);
        CHECK(basis.permuted_node(j, {1, 0, 2, 3}) == i);
    }
}

// Of gmsh 4.8 (getBasisFunctions, Lagrange and GradLagrange of its element types 3, 10, 36, 37, 38, 47, 48) at
// xi = (0.23, 0.61), the derivatives by the coordinates of [0, 1]^2: sums of (i + 1)^2 times those of function i.
TEST_CASE("the basis of quadrilaterals is Gmsh's, node by node") {
    struct OfGmsh {
        int degree;
        double N, along_x, along_y;
    };
    for (const OfGmsh& of : {OfGmsh{1, 9.437, -3.1, 12.7}, OfGmsh{2, 79.56013816, 42.287984, -21.895088},
                             OfGmsh{3, 231.124733958, 280.038874508, 96.3249439411},
                             OfGmsh{4, 535.861289467, 855.523351472, -687.320512088},
                             OfGmsh{5, 1021.12135722, 2425.4272798, -1418.52299589},
                             OfGmsh{6, 1780.78381983, 4368.73599854, -2381.10846912},
                             OfGmsh{7, 2830.85596728, 8366.19528047, -4972.42144163}}) {
        const LagrangeBasis basis(quadrilateral(), of.degree);
        std::vector<double> N(basis.count), dN(2 * basis.count);
        const double xi[2] = {0.23, 0.61};
        basis.values(xi, N.data());
        basis.gradients(xi, dN.data());
        double sum[3] = {};
        for (int i = 0; i < basis.count; ++i) {
            const double square = (i + 1.0) * (i + 1);
            sum[0] += square * N[i];
            sum[1] += square * dN[2 * i];
            sum[2] += square * dN[2 * i + 1];
        }
        CHECK(sum[0] == doctest::Approx(of.N).epsilon(1e-10));
        CHECK(sum[1] == doctest::Approx(of.along_x).epsilon(1e-10));
        CHECK(sum[2] == doctest::Approx(of.along_y).epsilon(1e-10));
    }
}

// Of gmsh 4.8 at (0.23, 0.61, 0.37), of prisms at (0.23, 0.31, 0.37), which it has up to degree 2.
TEST_CASE("the bases of hexahedra, prisms and pyramids are Gmsh's, node by node") {
    struct OfGmsh {
        const CellType& cell;
        int degree;
        double sum[4];
    };
    const OfGmsh all[] = {{hexahedron(), 1, {23.584024, -3.7512, 20.2184, 38.2352}},
                          {hexahedron(), 2, {625.85005476, 463.965446765, -42.2342120736, 460.077203299}},
                          {hexahedron(), 3, {3472.0721872, 3937.63501511, -360.528291379, 3246.46544888}},
                          {hexahedron(), 4, {13189.635487, 18099.8814065, -5116.66640741, 12633.0988848}},
                          {prism(), 1, {11.607, 5.22, 12.44, 20.1}},
                          {prism(), 2, {299.00932792, 185.173808, 187.1764, 330.892032}},
                          {pyramid(), 1, {15.19531, -3.1, 12.7, 15.563}},
                          {pyramid(), 2, {174.860677703, 203.3261088, 121.0566744, -49.098383184}},
                          {pyramid(), 3, {764.018566708, 1039.03544551, -34.1356827116, -439.434715093}},
                          {pyramid(), 4, {2743.43810343, 6253.48476226, -538.426601041, -330.550736934}}};
    for (const OfGmsh& of : all) {
        const LagrangeBasis basis(of.cell, of.degree);
        std::vector<double> N(basis.count), dN(3 * basis.count);
        const double xi[3] = {0.23, of.cell.factors[0] == 2 ? 0.31 : 0.61, 0.37};
        basis.values(xi, N.data());
        basis.gradients(xi, dN.data());
        double sum[4] = {};
        for (int i = 0; i < basis.count; ++i) {
            const double square = (i + 1.0) * (i + 1);
            sum[0] += square * N[i];
            for (int k = 0; k < 3; ++k) sum[k + 1] += square * dN[3 * i + k];
        }
        for (int k = 0; k < 4; ++k) CHECK(sum[k] == doctest::Approx(of.sum[k]).epsilon(1e-10));
    }
}

TEST_CASE("products of simplices and pyramids have a function for each node, and the nodes of their faces") {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= 7 && cell.dim > 0; ++degree) {
            const LagrangeBasis basis(cell, degree);
            REQUIRE(static_cast<int>(basis.nodes.size()) == basis.count);
            std::vector<double> N(basis.count), dN(basis.count * cell.dim);
            const double accuracy = degree <= 4 ? 1e-12 : 1e-9;
            for (int i = 0; i < basis.count; ++i) {
                CHECK(basis.find(basis.nodes[i]) == i);
                basis.values(basis.point(i).data(), N.data());
                for (int j = 0; j < basis.count; ++j) CHECK(std::abs(N[j] - (i == j)) < accuracy);
            }
            basis.gradients(std::array{0.2, 0.3, 0.4}.data(), dN.data());
            for (int k = 0; k < cell.dim; ++k) {
                double sum = 0;
                for (int i = 0; i < basis.count; ++i) sum += dN[i * cell.dim + k];
                CHECK(std::abs(sum) < 1e3 * accuracy);
            }
            if (cell.dim < 2) continue;
            for (int k = 0; k < static_cast<int>(cell.faces.size()); ++k) {
                const std::vector<int> face = basis.face_nodes(k);
                CHECK(static_cast<int>(face.size()) == cell.face_type(k).node_count(degree));
                CHECK(std::find(face.begin(), face.end(), -1) == face.end());
                for (int v = 0; v < cell.face_type(k).vertices; ++v) CHECK(face[v] == cell.faces[k][v]);
            }
        }
}

// The reduced derivatives of a pyramid have the determinant of those by (xi, eta, zeta), up to the apex.
TEST_CASE("the map of a pyramid with the nodes of the reference pyramid has the determinant one everywhere") {
    for (int degree = 1; degree <= 4; ++degree) {
        const LagrangeBasis basis(pyramid(), degree);
        std::vector<double> dN(3 * basis.count);
        for (const double c : {0.0, 0.4, 0.999, 1.0})
            for (const double a : {0.0, 0.3, 1.0}) {
                basis.gradients(std::array{a, 0.8, c}.data(), dN.data());
                double J[3][3] = {};
                for (int i = 0; i < basis.count; ++i) {
                    const std::array<double, 3> at = basis.point(i);
                    const double x[3] = {at[0] * (1 - at[2]), at[1] * (1 - at[2]), at[2]};
                    for (int r = 0; r < 3; ++r)
                        for (int k = 0; k < 3; ++k) J[r][k] += x[r] * dN[3 * i + k];
                }
                CHECK(J[0][0] == doctest::Approx(1).epsilon(1e-12));
                CHECK(J[1][1] == doctest::Approx(1).epsilon(1e-12));
                CHECK(J[0][2] == doctest::Approx(-a).epsilon(1e-12));
                const double det = J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) -
                                   J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
                                   J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
                CHECK(det == doctest::Approx(1).epsilon(1e-12));
            }
    }
}
