#include "mesh/quadrature.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/lagrange.hpp"
#include "mesh/quadrature_table.hpp"

using namespace almesh;

namespace {

double factorial(int k) { return k <= 1 ? 1 : k * factorial(k - 1); }

using Exponents = std::array<int, 3>;

double integral(const Quadrature& rule, const Exponents& power) {
    double sum = 0;
    for (int q = 0; q < rule.count; ++q) {
        double term = rule.weight[q];
        for (int k = 0; k < rule.dim; ++k) term *= std::pow(rule.xi[q * rule.dim + k], power[k]);
        sum += term;
    }
    return sum;
}

// a! b! c! / (a + b + c + dim)!
double exact_integral(int dim, const Exponents& power) {
    return factorial(power[0]) * factorial(power[1]) * factorial(power[2]) /
           factorial(power[0] + power[1] + power[2] + dim);
}

// Largest relative error over all monomials of one degree.
double error_of_degree(const Quadrature& rule, int degree) {
    double error = 0;
    for (int b = 0; b <= (rule.dim > 1 ? degree : 0); ++b)
        for (int c = 0; b + c <= degree && c <= (rule.dim > 2 ? degree : 0); ++c) {
            const Exponents power = {degree - b - c, b, c};
            error = std::max(error, std::abs(integral(rule, power) / exact_integral(rule.dim, power) - 1));
        }
    return error;
}

// Barycentric coordinates and the weight of all points.
std::vector<std::array<double, 5>> points_of(const Quadrature& rule) {
    std::vector<std::array<double, 5>> points(rule.count);
    for (int q = 0; q < rule.count; ++q) {
        points[q] = {1, 0, 0, 0, rule.weight[q]};
        for (int k = 0; k < rule.dim; ++k) {
            points[q][k + 1] = rule.xi[q * rule.dim + k];
            points[q][0] -= points[q][k + 1];
        }
    }
    return points;
}

bool contains(const std::vector<std::array<double, 5>>& points, const std::array<double, 5>& wanted) {
    return std::any_of(points.begin(), points.end(), [&](const std::array<double, 5>& point) {
        return std::equal(point.begin(), point.end(), wanted.begin(),
                          [](double x, double y) { return std::abs(x - y) < 1e-14; });
    });
}

}  // namespace

TEST_CASE("monomials up to the stated degree are integrated exactly") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int exactness = 0; exactness <= 20; ++exactness) {
            CAPTURE(dim);
            CAPTURE(exactness);
            const Quadrature rule = simplex_quadrature(dim, exactness);
            for (int degree = 0; degree <= exactness; ++degree)
                CHECK(error_of_degree(rule, degree) < (symmetric_rule(dim, exactness).empty() ? 5e-13 : 1e-14));
        }
}

TEST_CASE("a symmetric rule is exact to its degree and no further, and its points are permuted among themselves") {
    for (int dim : {2, 3})
        for (int exactness = 1; !symmetric_rule(dim, exactness).empty();) {
            const int exact_to = symmetric_rule(dim, exactness)[0].exactness;
            CAPTURE(dim);
            CAPTURE(exactness);
            CHECK(exact_to >= exactness);
            const Quadrature rule = simplex_quadrature(dim, exactness);
            CHECK(error_of_degree(rule, exact_to + 1) > 1e-8);
            const auto points = points_of(rule);
            for (const auto& point : points)
                for (int k = 0; k < dim; ++k) {  // swaps of neighbours make all permutations
                    auto swapped = point;
                    std::swap(swapped[k], swapped[k + 1]);
                    CHECK(contains(points, swapped));
                }
            exactness = exact_to + 1;
        }
}

TEST_CASE("symmetric rules take few points") {
    const std::array<int, 14> triangle = {1, 1, 3, 6, 6, 7, 12, 15, 16, 19, 25, 33, 33, 37};
    for (int exactness = 0; exactness < 14; ++exactness)
        CHECK(simplex_quadrature(2, exactness).count == triangle[exactness]);
    const std::array<int, 9> tetrahedron = {1, 1, 4, 8, 14, 14, 24, 35, 46};
    for (int exactness = 0; exactness < 9; ++exactness)
        CHECK(simplex_quadrature(3, exactness).count == tetrahedron[exactness]);
}

TEST_CASE("one point is the centroid") {
    for (int dim = 1; dim <= 3; ++dim) {
        const Quadrature rule = simplex_quadrature(dim, 1);
        REQUIRE(rule.count == 1);
        CHECK(rule.weight[0] == 1 / factorial(dim));
        for (double x : rule.xi) CHECK(x == 1.0 / (dim + 1));
    }
}

TEST_CASE("weights are positive and points inside") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int exactness = 0; exactness <= 16; ++exactness) {
            const Quadrature rule = simplex_quadrature(dim, exactness);
            for (double weight : rule.weight) CHECK(weight > 0);
            for (const auto& point : points_of(rule))
                for (int k = 0; k <= dim; ++k) CHECK(point[k] > 0);
        }
}

TEST_CASE("of curved elements a thousandth of the weight is at the nodes, whatever else there is") {
    for (int dim = 2; dim <= 3; ++dim)
        for (int degree = 2; degree <= 4; ++degree) {
            const LagrangeBasis basis(dim, degree);
            const Quadrature plain = simplex_quadrature(dim, 2 * degree);
            const Quadrature rule = element_quadrature(dim, degree, 2 * degree);
            REQUIRE(rule.count == plain.count + basis.count);
            double all = 0, at_nodes = 0;
            for (const double weight : rule.weight) all += weight;
            for (int q = 0; q < rule.count; ++q) {
                std::vector<double> values(basis.count);
                basis.values(&rule.xi[q * dim], values.data());
                if (std::any_of(values.begin(), values.end(), [](double v) { return std::abs(v - 1) < 1e-12; }))
                    at_nodes += rule.weight[q];
                CHECK(rule.weight[q] > 0);
            }
            CHECK(all == doctest::Approx(1 / factorial(dim)).epsilon(1e-13));
            CHECK(at_nodes == doctest::Approx(0.001 / factorial(dim)).epsilon(1e-9));
        }
}

TEST_CASE("on quadrilaterals the rule is exact in each coordinate, and the usual one has points at the nodes") {
    for (int exactness = 0; exactness <= 12; ++exactness) {
        const Quadrature rule = cell_quadrature(quadrilateral(), exactness);
        for (int a = 0; a <= exactness; ++a)
            for (int b = 0; b <= exactness; ++b) {
                double sum = 0;
                for (int q = 0; q < rule.count; ++q)
                    sum += rule.weight[q] * std::pow(rule.xi[2 * q], a) * std::pow(rule.xi[2 * q + 1], b);
                CHECK(sum == doctest::Approx(1.0 / ((a + 1) * (b + 1))).epsilon(1e-13));
            }
    }
    for (int degree = 1; degree <= 4; ++degree) {
        const Quadrature usual = element_quadrature(quadrilateral(), degree, 0);
        CHECK(usual.count == (degree + 2) * (degree + 2) + (degree + 1) * (degree + 1));
        double sum = 0, at_nodes = 0;
        for (int q = 0; q < usual.count; ++q) {
            sum += usual.weight[q];
            const double x = degree * usual.xi[2 * q], y = degree * usual.xi[2 * q + 1];
            if (std::abs(x - std::round(x)) + std::abs(y - std::round(y)) < 1e-14) at_nodes += usual.weight[q];
        }
        CHECK(sum == doctest::Approx(1).epsilon(1e-14));
        CHECK(at_nodes >= 0.001 * 0.999);  // a Gauss point may be at a node in the middle
    }
}

TEST_CASE("on hexahedra, prisms and pyramids the rule is exact in each factor, and the usual one has points at the nodes") {
    struct Exact {
        const CellType& cell;
        double integral;  // of x^3 y^2 z^4 over the reference cell; of a pyramid over (a, b, c) with (1 - c)^2
    };
    for (const Exact& of : {Exact{hexahedron(), 1.0 / 4 / 3 / 5}, {prism(), exact_integral(2, {3, 2, 0}) / 5},
                            {pyramid(), 1.0 / 4 / 3 * factorial(4) * factorial(2) / factorial(7)}}) {
        const Quadrature exact = cell_quadrature(of.cell, of.cell.factors[0] == 2 ? 5 : 4);
        CHECK(integral(exact, {3, 2, 4}) == doctest::Approx(of.integral).epsilon(1e-13));
        for (int degree = 1; degree <= 3; ++degree) {
            const Quadrature rule = element_quadrature(of.cell, degree, 0);
            const LagrangeBasis basis(of.cell, degree);
            double at_nodes = 0;
            for (int q = 0; q < rule.count; ++q) {
                std::vector<double> N(basis.count);
                basis.values(&rule.xi[3 * q], N.data());
                if (std::any_of(N.begin(), N.end(), [](double v) { return std::abs(v - 1) < 1e-11; }))
                    at_nodes += rule.weight[q];
            }
            CHECK(integral(rule, {0, 0, 0}) == doctest::Approx(of.cell.volume()).epsilon(1e-13));
            CHECK(at_nodes >= 0.000999 * of.cell.volume());  // a Gauss point may be at a node in the middle
        }
    }
}
