#include "energy/refined_rule.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "mesh/lagrange.hpp"

using namespace almesh;

// The gradients of the basis have the mean of those of the whole rule, since both integrate them exactly but for the
// thousandth of weight at the nodes. In a pyramid, refined at its apex too.
TEST_CASE("a refined rule has the volume of the element, positive weights, and integrates derivatives of the basis") {
    for (const CellType& cell : cell_types()) {
        if (cell.dim < 2) continue;
        const int dim = cell.dim;
        const Quadrature quadrature = element_quadrature(cell, 2, 0), rule = RefinedRule::of_pieces(cell, 2, 0);
        const ReferenceElement whole = reference_element(cell, 2, quadrature);
        RefinedRule refined(cell);
        const auto is_of = [&cell](int m) { return cell.factors[0] == m; };
        for (const CellPoint& at : {is_of(1)   ? CellPoint{0.7, 0.3, 0.1, 0.9, 0.2, 0.8}
                                    : is_of(2) ? CellPoint{0.7, 0.1, 0.2, 0.3, 0.7}
                                               : CellPoint{0.7, 0.1, 0.2, 0},
                                    is_of(1)   ? CellPoint{0.72, 0.28, 0.1, 0.9, 0.2, 0.8}
                                    : is_of(2) ? CellPoint{0.72, 0.08, 0.2, 0.3, 0.7}
                                               : CellPoint{0.72, 0.08, 0.2, 0},
                                    is_of(1) ? CellPoint{0, 1, 1, 0, 0, 1} : CellPoint{0, 1, 0, 0, is_of(2) ? 1.0 : 0}})
            REQUIRE(refined.refine(at, 0));
        const auto [element, volume] = refined.element(2, rule);
        CHECK(element.points == (1 + 3 * dim) * rule.count);
        REQUIRE(volume.size() == element.weight.size());
        CHECK(std::accumulate(volume.begin(), volume.end(), 0.0) == doctest::Approx(cell.volume()).epsilon(1e-3));
        for (const double v : volume) CHECK(v > 0);
        const int stride = whole.nodes * dim;
        for (int k = 0; k < stride; ++k) {
            double of_whole = 0, of_refined = 0;
            for (int q = 0; q < whole.points; ++q) of_whole += quadrature.weight[q] * whole.gradients[q * stride + k];
            for (int q = 0; q < element.points; ++q) of_refined += volume[q] * element.gradients[q * stride + k];
            CHECK(std::abs(of_refined - of_whole) < 2e-3 * cell.volume());
        }
    }
}

// dN_0/dxi_0 of degree 2 is 1 - 4 lambda_0: a point's lambda_0 can be read from it.
TEST_CASE("points gather where an element folded, and refinement ends") {
    const Quadrature rule = element_quadrature(2, 2, 0);
    RefinedRule refined(simplex(2));
    const auto nearest = [&](double lambda) {
        const ReferenceElement element = refined.element(2, rule).reference;
        double least = 1;
        for (int q = 0; q < element.points; ++q)
            least = std::min(least, std::abs(0.25 * (1 - element.gradients[q * element.nodes * 2]) - lambda));
        return least;
    };
    const CellPoint at = {0.9137, 0.0511, 0.0352, 0};
    int times = 0;
    double before = nearest(at[0]);
    while (times < 1000 && refined.refine(at, 0)) ++times;
    CHECK(times == 63);  // two more pieces each time, at most 128
    CHECK(nearest(at[0]) < 1e-3 * before);
    CHECK(refined.element(2, rule).reference.points == 127 * rule.count);
}

TEST_CASE("a size that is asked for is reached at once, and not beyond") {
    RefinedRule refined(simplex(3));
    const Quadrature rule = element_quadrature(3, 2, 0);
    const CellPoint corner = {0, 0, 0, 1};
    CHECK(!refined.refine(corner, 1));
    CHECK(refined.refine(corner, 0.3));
    CHECK(refined.element(2, rule).reference.points == 7 * rule.count);
    CHECK(!refined.refine(corner, 0.25));
    CHECK(refined.refine(corner, 0.2));
    CHECK(refined.element(2, rule).reference.points == 10 * rule.count);
}

// The volume of the smallest pieces falls by 8 with their size in 3D, their weight in the functional by 2^(4/3).
TEST_CASE("in 3D small pieces weigh more than their volume, so that folding at a point is dear; in 2D their area") {
    for (const int dim : {2, 3}) {
        const Quadrature rule = element_quadrature(dim, 2, 0);
        RefinedRule refined(simplex(dim));
        for (int times = 1; times <= 5; ++times) {
            CellPoint corner{};
            corner[dim] = 1;
            REQUIRE(refined.refine(corner, 0));
            const auto [element, volume] = refined.element(2, rule);
            double smallest = 1;
            for (std::size_t q = 0; q < volume.size(); ++q) {
                const double part = volume[q] / rule.weight[q % rule.weight.size()];
                smallest = std::min(smallest, element.weight[q] / rule.weight[q % rule.weight.size()]);
                const double of_barrier = dim == 3 ? std::pow(part, 4.0 / 9) : part;
                CHECK(element.weight[q] == doctest::Approx(of_barrier * rule.weight[q % rule.weight.size()]));
            }
            CHECK(smallest == doctest::Approx(std::pow(2.0, -times * (dim == 3 ? 4.0 / 3 : 2))));
        }
    }
}
