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
    const double mean = std::sqrt(E.distortion.energy(x) / E.distortion.domain_volume());
    CHECK(E.mean_slope(x, E.energy(x)) == doctest::Approx(mean).epsilon(1e-9));

    // Nothing is left of a distortion below the rounding of the energy.
    CHECK(E.mean_slope(x, E.constraint.value(x, E.lambda, E.penalty) - 1e-12) == 0);
}
