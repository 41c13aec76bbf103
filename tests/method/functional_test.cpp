#include "method/functional.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the scale of the damping is known from the energy without a look at the elements") {
    const Minimisation problem(ring_mesh(8, 2, 3), {{"inner", "translate 0.1 0"}}, Objective::squared);
    AugmentedFunctional E = problem.functional(1e4);
    E.lambda.assign(E.lambda.size(), 0.3);
    std::vector<double> x = problem.ideal;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 0.01 * std::sin(1.0 + static_cast<double>(i));
    const auto mean_slope = [&](double energy) { return E.distortion.mean_slope(E.distortion_energy(x, energy)); };
    const double mean = std::sqrt(E.distortion.energy(x) / E.distortion.domain_volume());
    CHECK(mean_slope(E.energy(x)) == doctest::Approx(mean).epsilon(1e-9));

    // Nothing is left of a distortion below the rounding of the energy.
    CHECK(mean_slope(E.constraint.value(x, E.lambda, E.penalty) - 1e-12) == 0);
}

TEST_CASE("the rounding error of the energy: what the last digits of the positions make of large multipliers") {
    const Minimisation problem(ring_mesh(8, 2, 3), {{"inner", "translate 0.1 0"}}, Objective::squared);
    AugmentedFunctional E = problem.functional(1e-3);
    E.lambda.assign(E.lambda.size(), 1e6);
    for (const double size : {1.0, 100.0}) {
        CAPTURE(size);
        std::vector<double> x = problem.ideal;
        for (double& coordinate : x) coordinate *= size;
        std::vector<double> force(x.size(), 1.0), g(x.size(), 0.0), nudged = x;
        const double error = E.rounding_error(x, force);
        E.constraint.add_gradient(x, E.lambda, E.penalty, g);
        for (std::size_t i = 0; i < x.size(); ++i) nudged[i] = std::nextafter(x[i], g[i] > 0 ? 1e9 : -1e9);
        const double change =
            E.constraint.value(nudged, E.lambda, E.penalty) - E.constraint.value(x, E.lambda, E.penalty);
        CHECK(change > 0.3 * error);  // a last digit is between half and all of epsilon
        CHECK(change < 1.5 * error);
        CHECK(error > 1e-10);
    }
}
