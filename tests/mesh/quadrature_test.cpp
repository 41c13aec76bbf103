#include "mesh/quadrature.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace almesh;

namespace {

double factorial(int k) { return k <= 1 ? 1 : k * factorial(k - 1); }

}  // namespace

// The integral of x^a y^b z^c over the simplex is a! b! c! / (a + b + c + dim)!.
TEST_CASE("monomials up to the stated degree are integrated exactly") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int exactness = 0; exactness <= 20; ++exactness) {
            const Quadrature rule = simplex_quadrature(dim, exactness);
            for (int a = 0; a <= exactness; ++a)
                for (int b = 0; b <= (dim > 1 ? exactness - a : 0); ++b)
                    for (int c = 0; c <= (dim > 2 ? exactness - a - b : 0); ++c) {
                        double sum = 0;
                        for (int q = 0; q < rule.count; ++q) {
                            double term = rule.weight[q] * std::pow(rule.xi[q * dim], a);
                            if (dim > 1) term *= std::pow(rule.xi[q * dim + 1], b);
                            if (dim > 2) term *= std::pow(rule.xi[q * dim + 2], c);
                            sum += term;
                        }
                        const double exact = factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + dim);
                        CHECK(sum == doctest::Approx(exact).epsilon(1e-12));
                    }
        }
}

TEST_CASE("the next degree is not integrated exactly by the one-point rule") {
    const Quadrature rule = simplex_quadrature(2, 1);
    CHECK(rule.count == 1);
    CHECK(rule.weight[0] * rule.xi[0] * rule.xi[0] != doctest::Approx(1.0 / 12));
}

TEST_CASE("weights are positive and points inside") {
    for (int dim = 1; dim <= 3; ++dim)
        for (int exactness : {1, 4, 9, 15}) {
            const Quadrature rule = simplex_quadrature(dim, exactness);
            for (int q = 0; q < rule.count; ++q) {
                CHECK(rule.weight[q] > 0);
                double rest = 1;
                for (int k = 0; k < dim; ++k) {
                    CHECK(rule.xi[q * dim + k] > 0);
                    rest -= rule.xi[q * dim + k];
                }
                CHECK(rest > 0);
            }
        }
}
