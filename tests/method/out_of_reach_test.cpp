#include "method/out_of_reach.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("out of reach: a full step gains less than a thousandth, and nine tenths of the energy are penalty") {
    const OutOfReach reach{100};
    const auto found = [&](double energy, double gained, double step_length, double distortion) {
        return reach.found(energy * (1 + gained), energy, step_length, [=] { return distortion * energy; });
    };
    CHECK(found(101, 0.9e-3, 1, 0.09));
    CHECK(found(101, 0.9e-3, 2, 0.09));
    CHECK_FALSE(found(99, 0.9e-3, 1, 0.09));
    CHECK_FALSE(found(101, 1.1e-3, 1, 0.09));
    CHECK_FALSE(found(101, 0.9e-3, 0.5, 0.09));
    CHECK_FALSE(found(101, 0.9e-3, 1, 0.11));
    CHECK_FALSE(OutOfReach().found(1e300, 1e300, 1, [] { return 0.0; }));
}
