#include <doctest/doctest.h>

#include <cmath>

#include "energy/simd_energy.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Pair {
    Mesh coarse, fine;
};

std::vector<Pair> pairs() {
    std::vector<Pair> all;
    for (const Mesh& linear : {ring_mesh(8, 2, 4), cube_mesh(2)}) {
        all.push_back({linear, refine(linear, 1)});
        all.push_back({linear, refine(linear, 2)});
        all.push_back({linear, raise_degree(linear, 3)});
        all.push_back({raise_degree(linear, 2), raise_degree(refine(linear, 1), 2)});
        all.push_back({raise_degree(linear, 2), raise_degree(linear, 4)});
    }
    return all;
}

// (a polynomial of the given degree in all coordinates) x dim at the nodes.
std::vector<double> polynomial(const std::vector<double>& x, int dim, int degree) {
    std::vector<double> values(x.size());
    for (std::size_t i = 0; i < x.size() / dim; ++i)
        for (int a = 0; a < dim; ++a) {
            double sum = 0;
            for (int b = 0; b < dim; ++b) sum += (1 + a + 2 * b) * x[i * dim + b];
            values[i * dim + a] = 0.25 + std::pow(sum, degree);
        }
    return values;
}

std::vector<double> carried(const Pair& pair, const std::vector<double>& field) {
    return prolong(pair.coarse, straight_sided(pair.coarse), pair.fine, straight_sided(pair.fine), field);
}

}  // namespace

TEST_CASE("polynomials of the degree of the coarse elements are reproduced") {
    for (const Pair& pair : pairs())
        for (int degree = 1; degree <= pair.coarse.degree; ++degree) {
            const std::vector<double> fine =
                carried(pair, polynomial(straight_sided(pair.coarse), pair.coarse.dim, degree));
            const std::vector<double> expected = polynomial(straight_sided(pair.fine), pair.fine.dim, degree);
            REQUIRE(fine.size() == expected.size());
            double largest = 0, size = 0;
            for (std::size_t i = 0; i < fine.size(); ++i) {
                largest = std::max(largest, std::abs(fine[i] - expected[i]));
                size = std::max(size, std::abs(expected[i]));
            }
            CHECK(largest <= 1e-14 * size);
        }
}

TEST_CASE("a valid map stays valid and keeps its distortion energy") {
    for (const Pair& pair : pairs()) {
        if (pair.coarse.degree > 1) continue;  // the quadrature of curved elements is not exact
        const std::vector<double> ideal = straight_sided(pair.coarse), fine_ideal = straight_sided(pair.fine);
        const std::vector<double> moved = wavy(ideal, pair.coarse.dim, 0.1);
        std::vector<double> displacement = moved;
        for (std::size_t i = 0; i < moved.size(); ++i) displacement[i] -= ideal[i];
        std::vector<double> x = carried(pair, displacement);
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += fine_ideal[i];
        const double before = SimdEnergy(pair.coarse, ideal, {}).energy(moved);
        REQUIRE(before > 0);
        REQUIRE(std::isfinite(before));
        CHECK(SimdEnergy(pair.fine, fine_ideal, {}).energy(x) == doctest::Approx(before).epsilon(1e-11));
    }
}

TEST_CASE("on the boundary the values on the boundary decide") {
    for (const Pair& pair : pairs()) {
        std::vector<double> field(pair.coarse.x.size(), 1.0);
        for (int node : pair.coarse.faces)
            for (int a = 0; a < pair.coarse.dim; ++a) field[static_cast<std::size_t>(node) * pair.coarse.dim + a] = 3;
        const std::vector<double> fine = carried(pair, field);
        for (int node : pair.fine.faces)
            CHECK(fine[static_cast<std::size_t>(node) * pair.fine.dim] == doctest::Approx(3).epsilon(1e-14));
    }
}

TEST_CASE("elements stretched 1 : 1e6 are found all the same") {
    Mesh coarse = square_mesh(4);
    for (std::size_t i = 0; i < coarse.x.size(); i += 2) coarse.x[i] = 1 + 1e-6 * coarse.x[i];
    const Mesh fine = raise_degree(refine(coarse, 1), 3);
    const Pair pair = {raise_degree(coarse, 3), fine};
    const std::vector<double> field = polynomial(straight_sided(pair.coarse), 2, 1), there = carried(pair, field);
    const std::vector<double> expected = polynomial(straight_sided(fine), 2, 1);
    for (std::size_t i = 0; i < there.size(); ++i) CHECK(there[i] == doctest::Approx(expected[i]).epsilon(1e-14));
}

TEST_CASE("the same bits for any number of threads") {
    const Mesh coarse = ring_mesh(32, 8, 6);
    const Pair pair = {coarse, refine(coarse, 3)};
    const std::vector<double> field = wavy(coarse.x, 2, 0.1);
    const auto results = for_threads([&] { return carried(pair, field); });
    for (const auto& result : results) CHECK(result == results[0]);
}
