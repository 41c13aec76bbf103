#include "energy/gradient_products.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "mesh/cells.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/quadrature.hpp"

using namespace almesh;

namespace {

// K_ij for a single number C(q), the same for all pairs of directions of a symmetric matrix: sum_q C(q) dN_i . G dN_j.
struct Example {
    int n;
    ReferenceElement of;
    std::array<std::array<double, 3>, 3> G{};
    std::vector<double> C;

    Example(int n_, int degree) : n(n_), of(reference_element(degree, element_quadrature(n_, degree, 0))) {
        std::mt19937 random(5 + degree);
        std::uniform_real_distribution<double> number(-1, 1);
        for (int k = 0; k < n; ++k)
            for (int l = 0; l <= k; ++l) G[k][l] = G[l][k] = number(random);
        for (int q = 0; q < of.points; ++q) C.push_back(number(random));
    }

    // Point by point.
    double direct(int i, int j) const {
        double sum = 0;
        for (int q = 0; q < of.points; ++q)
            for (int k = 0; k < n; ++k)
                for (int l = 0; l < n; ++l)
                    sum += of.gradients[offset(q, of.nodes * n, i * n + k)] * C[q] * G[k][l] *
                           of.gradients[offset(q, of.nodes * n, j * n + l)];
        return sum;
    }

    // grad l_v . G grad l_w
    double form(int v, int w) const {
        double sum = 0;
        for (int k = 0; k < n; ++k)
            for (int l = 0; l < n; ++l)
                sum += (v == 0 ? -1 : v == k + 1) * G[k][l] * (w == 0 ? -1 : w == l + 1);
        return sum;
    }

    double by_moments(const GradientProducts& products, int i, int j) const {
        const auto moment = [&](int c) {
            double sum = 0;
            for (int q = 0; q < of.points; ++q) sum += C[q] * of.monomials[offset(q, products.moments, c)];
            return sum;
        };
        std::vector<double> D(products.moments * products.pairs);
        for (int c = 0; c < products.moments; ++c)
            for (int v = 0; v <= n; ++v)
                for (int w = v; w <= n; ++w)
                    D[c * products.pairs + upper_place(n + 1, v, w)] = moment(c) * form(v, w);
        const auto in_powers = [&](int a, int b) {
            if (b > a) std::swap(a, b);
            double sum = 0;
            const int k = a * (a + 1) / 2 + b;
            for (int t = products.term_start[k]; t < products.term_start[k + 1]; ++t)
                sum += products.term[t].factor * D[products.term[t].moment * products.pairs + products.term[t].pair];
            return sum;
        };
        double sum = 0;
        for (int s = products.entry_start[i]; s < products.entry_start[i + 1]; ++s)
            for (int t = products.entry_start[j]; t < products.entry_start[j + 1]; ++t)
                sum += products.entry[s].value * products.entry[t].value *
                       in_powers(products.entry[s].row, products.entry[t].row);
        return sum;
    }
};

}  // namespace

TEST_CASE("the basis in powers of the barycentric coordinates has the values of the basis") {
    for (int n = 2; n <= 3; ++n)
        for (int degree = 1; degree <= 6; ++degree) {
            const GradientProducts products(n, degree);
            const LagrangeBasis basis(n, degree);
            const std::array<double, 3> xi = {0.3, 0.21, 0.17};
            std::vector<double> N(basis.count);
            basis.values(xi.data(), N.data());
            const std::array<double, 4> l = {n == 3 ? 0.32 : 0.49, xi[0], xi[1], xi[2]};
            for (int i = 0; i < basis.count; ++i) {
                double sum = 0;
                for (int t = products.entry_start[i]; t < products.entry_start[i + 1]; ++t) {
                    double power = products.entry[t].value;
                    for (int k = 0; k <= n; ++k) power *= std::pow(l[k], basis.nodes[products.entry[t].row][k]);
                    sum += power;
                }
                CHECK(sum == doctest::Approx(N[i]).epsilon(1e-11));
            }
        }
}

TEST_CASE("sums of products of gradients by moments are those point by point") {
    for (int n = 2; n <= 3; ++n)
        for (int degree = 1; degree <= (n == 2 ? 6 : 4); ++degree) {
            const Example example(n, degree);
            const GradientProducts products(n, degree);
            REQUIRE(products.nodes == example.of.nodes);
            REQUIRE(products.moments * example.of.points == static_cast<int>(example.of.monomials.size()));
            double largest = 0;
            for (int i = 0; i < products.nodes; ++i) largest = std::max(largest, std::abs(example.direct(i, i)));
            for (int i = 0; i < products.nodes; ++i)
                for (int j = 0; j < products.nodes; j += 3)
                    CHECK(std::abs(example.by_moments(products, i, j) - example.direct(i, j)) <= 1e-12 * largest);
        }
}

TEST_CASE("of linear elements each block is one moment, transposed below the diagonal") {
    const GradientProducts products(3, 1);
    CHECK(products.moments == 1);
    for (int i = 0, k = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j, ++k) {
            REQUIRE(products.term_start[k + 1] - products.term_start[k] == 1);
            const GradientProducts::Term& term = products.term[products.term_start[k]];
            CHECK(term.moment == 0);
            CHECK(term.pair == upper_place(4, j, i));
            CHECK(term.transposed == (i > j));
            CHECK(term.factor == 1);
        }
}

TEST_CASE("places in the upper triangle are counted row by row") {
    int place = 0;
    for (int v = 0; v < 4; ++v)
        for (int w = v; w < 4; ++w) CHECK(upper_place(4, v, w) == place++);
}
