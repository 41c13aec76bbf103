#include "geometry/element_jacobian.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "mesh/lagrange.hpp"

using namespace almesh;

namespace {

// The nodes of the reference element, moved at random: x and x'.
template <int n>
std::array<std::vector<Vec<n>>, 2> random_positions(const JacobianBasis& basis, double amplitude,
                                                    std::mt19937& random) {
    const LagrangeBasis lagrange(basis.cell, basis.degree);
    std::uniform_real_distribution<double> moved(-amplitude, amplitude);
    std::array<std::vector<Vec<n>>, 2> x;
    for (auto& of_end : x)
        for (int i = 0; i < lagrange.count; ++i) {
            std::array<double, 3> xi = lagrange.point(i);
            for (int k = 0; k < 2 && basis.cell.is_collapsed; ++k) xi[k] *= 1 - xi[2];
            Vec<n> p;
            for (int k = 0; k < n; ++k) p[k] = xi[k] + moved(random);
            of_end.push_back(p);
        }
    return x;
}

template <int n>
double determinant_at(const LagrangeBasis& basis, const std::array<std::vector<Vec<n>>, 2>& x, double s,
                      const double* xi) {
    std::vector<double> dN(basis.count * n);
    basis.gradients(xi, dN.data());
    Mat<n> J{};
    for (int i = 0; i < basis.count; ++i)
        for (int a = 0; a < n; ++a)
            for (int k = 0; k < n; ++k) J[a][k] += ((1 - s) * x[0][i][a] + s * x[1][i][a]) * dN[i * n + k];
    return determinant(J);
}

// sum_k B_k(s) sum_a b_ka B_a(lambda).
template <int n>
double value(const JacobianBasis& basis, const ElementJacobian<n, double>& element, double s, const double* xi) {
    double l[6] = {}, sum = 0;
    for (int f = 0, first = 0; f < 3 && basis.cell.factors[f] > 0; first += basis.cell.factors[f++] + 1) {
        l[first] = 1;
        for (int k = 1; k <= basis.cell.factors[f]; ++k) {
            l[first + k] = *xi++;
            l[first] -= l[first + k];
        }
    }
    const double binomial[4] = {1, n == 2 ? 2.0 : 3.0, n == 2 ? 1.0 : 3.0, 1};
    for (int k = 0; k <= n; ++k)
        for (int a = 0; a < basis.jacobian.count; ++a) {
            double term = binomial[k] * std::pow(s, k) * std::pow(1 - s, n - k) * basis.jacobian.multinomial[a];
            for (int v = 0; v < 6; ++v) term *= std::pow(l[v], basis.jacobian.index[a][v]);
            sum += element.coefficients(k)[a] * term;
        }
    return sum;
}

template <int n>
void check_against_points(const CellType& cell, int degree) {
    const JacobianBasis basis(cell, degree);
    const LagrangeBasis lagrange(cell, degree);
    std::mt19937 random(degree);
    std::uniform_real_distribution<double> anywhere(0, 1);
    for (int trial = 0; trial < 5; ++trial) {
        const auto x = random_positions<n>(basis, 0.1 / degree, random);
        ElementJacobian<n, double> element(basis);
        for (int end = 0; end < 2; ++end) std::copy(x[end].begin(), x[end].end(), element.position(end));
        element.compute(2);
        REQUIRE(element.has_frame());
        CHECK(element.rounding() < (degree < 4 ? 1e-5 : 1e-2));
        for (const double s : {0.0, 0.3, 0.5, 1.0})
            for (int point = 0; point < 8; ++point) {
                double xi[3] = {anywhere(random), anywhere(random), anywhere(random)};
                for (int k = 0; k < cell.factors[0]; ++k) xi[k] /= cell.factors[0];
                if (point == 0) xi[0] = xi[1] = 0, xi[2] = 1;
                const double expected = determinant_at<n>(lagrange, x, s, xi);
                CHECK(std::abs(element.unit() * value<n>(basis, element, s, xi) - expected) < 1e-12);
            }
    }
}

template <int n>
double deviation(const JacobianBasis& basis, const std::array<std::vector<Vec<n>>, 2>& x, int ends) {
    ElementJacobian<n, double> element(basis);
    for (int end = 0; end < ends; ++end) std::copy(x[end].begin(), x[end].end(), element.position(end));
    return element.deviation(ends);
}

template <int n>
void check_deviation(const CellType& cell, int degree) {
    const JacobianBasis basis(cell, degree);
    std::mt19937 random(degree);
    auto straight = random_positions<n>(basis, 0, random);
    for (Vec<n>& p : straight[0])
        for (int a = n - 1; a > 0; --a) p[a] = 0.1 * p[a] + a + 5 * p[a - 1];
    CHECK(deviation<n>(basis, straight, 1) < 1e-8);
    int told = 0;
    for (int trial = 0; trial < 20; ++trial) {
        const auto x = random_positions<n>(basis, 0.004 * trial / (degree * degree), random);
        const double d = deviation<n>(basis, x, 2);
        CHECK(deviation<n>(basis, x, 1) <= d);
        if (d >= 1) continue;
        ++told;
        ElementJacobian<n, double> element(basis);
        for (int end = 0; end < 2; ++end) std::copy(x[end].begin(), x[end].end(), element.position(end));
        element.compute(2);
        for (int k = 0; k <= n; ++k)
            for (int a = 0; a < basis.jacobian.count; ++a)
                CHECK(element.coefficients(k)[a] >= std::pow(1 - d, n) - 1e-9);
    }
    CHECK(told >= 5);
}

}  // namespace

TEST_CASE("where the Jacobian deviates little all coefficients are as large as it tells, whatever the shape") {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= 3 && !cell.is_simplex(); ++degree)
            if (cell.dim == 2) check_deviation<2>(cell, degree);
            else check_deviation<3>(cell, degree);
}

TEST_CASE("the coefficients are those of the determinant at every place of the element and of the step") {
    for (const CellType& cell : cell_types())
        for (int degree = cell.is_simplex() ? 2 : 1; degree <= (cell.dim == 2 ? 6 : 4); ++degree)
            if (cell.dim == 2) check_against_points<2>(cell, degree);
            else if (cell.dim == 3) check_against_points<3>(cell, degree);
}

TEST_CASE("lanes give what single elements give, and one end alone what both give for it") {
    const JacobianBasis basis(3, 2);
    std::mt19937 random(1);
    std::vector<std::array<std::vector<Vec<3>>, 2>> x;
    for (int l = 0; l < lanes; ++l) x.push_back(random_positions<3>(basis, 0.1, random));
    ElementJacobian<3, Lanes> batch(basis);
    for (int end = 0; end < 2; ++end)
        for (int i = 0; i < basis.position.bernstein.count; ++i)
            for (int a = 0; a < 3; ++a)
                for (int l = 0; l < lanes; ++l) batch.position(end)[i][a][l] = x[l][end][i][a];
    batch.compute(2);
    for (int l = 0; l < lanes; ++l)
        for (const int ends : {1, 2}) {
            ElementJacobian<3, double> single(basis);
            for (int end = 0; end < 2; ++end) std::copy(x[l][end].begin(), x[l][end].end(), single.position(end));
            single.compute(ends);
            for (int k = 0; k < (ends == 1 ? 1 : 4); ++k)
                for (int a = 0; a < basis.jacobian.count; ++a)
                    CHECK(single.coefficients(k)[a] == doctest::Approx(batch.coefficients(k)[a][l]).epsilon(1e-12));
        }
}

// All vertices on a line: the straight-sided element has no volume, the curved one has.
TEST_CASE("an element bent until its vertices are on a line has a frame") {
    const JacobianBasis basis(2, 2);
    const Vec<2> nodes[6] = {{0, 0}, {1, 0}, {2, 0}, {0.5, -0.5}, {1.5, -0.5}, {1, 0.8}};
    ElementJacobian<2, double> element(basis);
    std::copy(nodes, nodes + 6, element.position(0));
    element.compute(1);
    CHECK(element.has_frame());
    std::fill(element.position(0), element.position(0) + 6, Vec<2>{1, 1});
    element.compute(1);
    CHECK(!element.has_frame());
}
