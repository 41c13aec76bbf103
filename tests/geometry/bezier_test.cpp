#include "geometry/bezier.hpp"
#include "mesh/lagrange.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

using namespace almesh;

namespace {

std::vector<double> some_values(int count) {
    std::vector<double> v(count);
    for (int i = 0; i < count; ++i) v[i] = std::sin(1.7 * i * i + 0.3);
    return v;
}

using Coordinates = std::array<double, 6>;

double evaluate(const Bernstein& basis, const std::vector<double>& c, const Coordinates& l) {
    double sum = 0;
    for (int i = 0; i < basis.count; ++i) {
        double term = c[i] * basis.multinomial[i];
        for (std::size_t k = 0; k < l.size(); ++k) term *= std::pow(l[k], basis.index[i][k]);
        sum += term;
    }
    return sum;
}

// Barycentric coordinates of each factor.
Coordinates coordinates(const std::array<int, 3>& factors, const double* xi) {
    Coordinates l{};
    int first = 0;
    for (const int m : factors) {
        if (m == 0) continue;
        l[first] = 1;
        for (int k = 1; k <= m; ++k) {
            l[first + k] = *xi++;
            l[first] -= l[first + k];
        }
        first += m + 1;
    }
    return l;
}

std::vector<double> nodal_to_bezier(const std::vector<double>& M, const std::vector<double>& v) {
    std::vector<double> c(M.size() / v.size(), 0.0);
    for (std::size_t a = 0; a < c.size(); ++a)
        for (std::size_t i = 0; i < v.size(); ++i) c[a] += M[a * v.size() + i] * v[i];
    return c;
}

}  // namespace

TEST_CASE("the Bezier form of an interpolating polynomial has its values, on every cell") {
    for (const CellType& cell : cell_types())
        for (int degree = 1; cell.dim > 0 && degree <= (cell.is_simplex() ? 7 : 4); ++degree) {
            const LagrangeBasis lagrange(cell, degree);
            const Bernstein basis = position_form(cell, degree);
            const std::vector<double> v = some_values(lagrange.count);
            const std::vector<double> c = nodal_to_bezier(bezier_of_lagrange(lagrange), v);
            const double xi[3] = {0.31, 0.22, 0.13};
            std::vector<double> N(lagrange.count);
            lagrange.values(xi, N.data());
            const double expected = std::inner_product(N.begin(), N.end(), v.begin(), 0.0);
            CHECK(std::abs(evaluate(basis, c, coordinates(cell.factors, xi)) - expected) < 1e-11);
            for (const Bernstein::Corner& corner : basis.corners)
                CHECK(std::count(v.begin(), v.begin() + cell.vertices, c[corner.place]) == 1);
        }
}

TEST_CASE("bisection along an edge of a factor keeps the polynomial on both halves") {
    std::vector<Bernstein> bases = {{{1, 1, 0}, {4, 1, 0}}, {{1, 1, 1}, {2, 3, 0}}, {{2, 1, 0}, {3, 2, 0}}};
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree : {1, 2, 5, 9}) bases.emplace_back(dim, degree);
    for (const Bernstein& basis : bases) {
        const std::vector<double> c = some_values(basis.count);
        const double xi[3] = {0.3, 0.2, 0.1};
        const Coordinates local = coordinates(basis.factors, xi);
        std::vector<double> half[2] = {c, c};
        for (int f = 0, first = 0; f < 3; first += basis.entries(f++))
            for (int a = first; a < first + basis.entries(f); ++a)
                for (int b = a + 1; b < first + basis.entries(f); ++b) {
                    basis.bisect(a, b, c.data(), half[0].data(), half[1].data());
                    for (int side = 0; side < 2; ++side) {
                        Coordinates l = local;
                        const int lost = side == 0 ? b : a, kept = side == 0 ? a : b;
                        l[kept] += 0.5 * local[lost];
                        l[lost] = 0.5 * local[lost];
                        CHECK(std::abs(evaluate(basis, half[side], local) - evaluate(basis, c, l)) < 1e-13);
                    }
                }
    }
}

TEST_CASE("the product of two polynomials has the product of their values") {
    const std::array<Bernstein, 3> tetrahedron = {Bernstein(3, 4), {3, 5}, {3, 9}};
    const std::array<int, 3> factors = {2, 1, 0};
    const std::array<Bernstein, 3> prism = {{{factors, {3, 2, 0}}, {factors, {1, 4, 0}}, {factors, {4, 6, 0}}}};
    for (const auto& [a, b, product] : {tetrahedron, prism}) {
        const std::vector<double> u = some_values(a.count), v = some_values(b.count);
        const std::vector<double> w = BezierProduct(a, b, product).multiply(u, v, std::multiplies<>());
        const double xi[3] = {0.5, 0.15, 0.25};
        const Coordinates l = coordinates(a.factors, xi);
        CHECK(evaluate(product, w, l) == doctest::Approx(evaluate(a, u, l) * evaluate(b, v, l)).epsilon(1e-13));
    }
}

TEST_CASE("the minimum of a parabola is enclosed to the tolerance") {
    // 4 (t - 1/3)^2 + 0.01: value 0.01 at t = 1/3, not a point of any bisection; Bezier coefficients by blossoming.
    const Bernstein basis(1, 2);
    const auto parabola = [](double floor) {
        return std::vector<double>{4.0 / 9 + floor, 16.0 / 9 + floor, -8.0 / 9 + floor};  // ends first, then the middle
    };
    const PolynomialMinimum m = polynomial_minimum(basis, parabola(0.01).data(), 0.01, 100);
    CHECK(m.tight);
    CHECK(m.lower <= 0.01 + 1e-15);
    CHECK(m.upper >= 0.01 - 1e-15);
    CHECK(m.upper - m.lower <= 0.01 * m.upper);
    CHECK_FALSE(polynomial_minimum(basis, parabola(0.01).data(), 0.01, 1).tight);
    CHECK(polynomial_minimum(basis, parabola(-0.01).data(), 0.01, 100).upper < 0);
    CHECK(polynomial_minimum(basis, parabola(0.01).data(), 0.01, 0).lower == doctest::Approx(-8.0 / 9 + 0.01));
}

TEST_CASE("bounds in two and three variables enclose sampled values, the upper one is that at the place told") {
    const Bernstein bases[] = {{2, 8}, {3, 6}, {{1, 1, 0}, {7, 3, 0}}, {{1, 1, 1}, {3, 4, 2}}, {{2, 1, 0}, {4, 5, 0}},
                               {{1, 1, 1}, {2, 2, 0}}};
    for (const Bernstein& basis : bases) {
        const std::vector<double> c = some_values(basis.count);
        const PolynomialMinimum m = polynomial_minimum(basis, c.data(), 0.01, 5000);
        CHECK(m.tight);
        CHECK(evaluate(basis, c, m.at) == doctest::Approx(m.upper).epsilon(1e-12));
        double sampled = 1e9;
        const int steps = 24;
        for (int q = 0; q < (steps + 1) * (steps + 1) * (steps + 1); ++q) {
            const double xi[3] = {1.0 * (q % (steps + 1)) / steps, 1.0 * (q / (steps + 1) % (steps + 1)) / steps,
                                  1.0 * (q / (steps + 1) / (steps + 1)) / steps};
            const Coordinates l = coordinates(basis.factors, xi);
            if (*std::min_element(l.begin(), l.end()) >= -1e-12) sampled = std::min(sampled, evaluate(basis, c, l));
        }
        CHECK(m.lower <= sampled);
        CHECK(m.lower > sampled - 0.05);
    }
}
