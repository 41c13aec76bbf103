#include "geometry/bezier.hpp"

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

double evaluate(const Bernstein& basis, const std::vector<double>& c, const double* l) {
    double sum = 0;
    for (int i = 0; i < basis.count; ++i) {
        double term = c[i] * basis.multinomial[i];
        for (int k = 0; k <= basis.dim; ++k) term *= std::pow(l[k], basis.index[i][k]);
        sum += term;
    }
    return sum;
}

std::vector<double> nodal_to_bezier(const std::vector<double>& M, const std::vector<double>& v) {
    std::vector<double> c(v.size(), 0.0);
    for (std::size_t a = 0; a < v.size(); ++a)
        for (std::size_t i = 0; i < v.size(); ++i) c[a] += M[a * v.size() + i] * v[i];
    return c;
}

}  // namespace

TEST_CASE("the Bezier form of an interpolating polynomial has its values") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= 7; ++degree) {
            const LagrangeBasis lagrange(dim, degree);
            const Bernstein basis(dim, degree);
            const std::vector<double> v = some_values(basis.count);
            const std::vector<double> c = nodal_to_bezier(bezier_of_lagrange(lagrange), v);
            const double xi[3] = {0.31, 0.22, 0.13};
            double l[4] = {1, 0, 0, 0};
            for (int k = 0; k < dim; ++k) {
                l[k + 1] = xi[k];
                l[0] -= xi[k];
            }
            std::vector<double> N(basis.count);
            lagrange.values(xi, N.data());
            const double expected = std::inner_product(N.begin(), N.end(), v.begin(), 0.0);
            CHECK(std::abs(evaluate(basis, c, l) - expected) < 1e-12);
            for (int k = 0; k <= dim; ++k) CHECK(c[k] == doctest::Approx(v[k]).epsilon(1e-14));
        }
}

TEST_CASE("bisection keeps the polynomial on both halves") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree : {1, 2, 5, 9}) {
            const Bernstein basis(dim, degree);
            const std::vector<double> c = some_values(basis.count);
            std::vector<double> half[2] = {c, c};
            for (int a = 0; a <= dim; ++a)
                for (int b = a + 1; b <= dim; ++b) {
                    basis.bisect(a, b, c.data(), half[0].data(), half[1].data());
                    for (int side = 0; side < 2; ++side) {
                        double local[4] = {0.4, 0.3, 0.2, 0.1}, l[4];
                        if (dim < 3) local[0] += local[3];
                        if (dim < 2) local[0] += local[2];
                        std::copy(local, local + 4, l);
                        const int lost = side == 0 ? b : a, kept = side == 0 ? a : b;
                        l[kept] += 0.5 * local[lost];
                        l[lost] = 0.5 * local[lost];
                        CHECK(std::abs(evaluate(basis, half[side], local) - evaluate(basis, c, l)) < 1e-13);
                    }
                }
        }
}

TEST_CASE("the product of two polynomials has the product of their values") {
    const Bernstein a(3, 4), b(3, 5), product(3, 9);
    const std::vector<double> u = some_values(a.count), v = some_values(b.count);
    const std::vector<double> w = BezierProduct(a, b, product).multiply(u, v, std::multiplies<>());
    const double l[4] = {0.1, 0.5, 0.15, 0.25};
    CHECK(evaluate(product, w, l) == doctest::Approx(evaluate(a, u, l) * evaluate(b, v, l)).epsilon(1e-13));
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

TEST_CASE("bounds of polynomials in two and three variables enclose sampled values") {
    for (int dim = 2; dim <= 3; ++dim) {
        const Bernstein basis(dim, dim == 2 ? 8 : 6);
        const std::vector<double> c = some_values(basis.count);
        const PolynomialMinimum m = polynomial_minimum(basis, c.data(), 0.01, 5000);
        CHECK(m.tight);
        double sampled = 1e9;
        const int steps = 24;
        for (const MultiIndex& a : gmsh_node_order(dim, steps)) {
            double l[4];
            for (int k = 0; k < 4; ++k) l[k] = static_cast<double>(a[k]) / steps;
            sampled = std::min(sampled, evaluate(basis, c, l));
        }
        CHECK(m.lower <= sampled);
        CHECK(m.lower > sampled - 0.05);
    }
}
