#include "method/rounding_floor.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("below rounding the iteration goes on while a step halves the gradient, and until it is small enough") {
    constexpr double omega = 1e-8;
    CHECK(at_rounding_floor(true, 1e-3, 0.6e-3, omega));
    CHECK(at_rounding_floor(true, 1e-3, 2e-3, omega));
    CHECK_FALSE(at_rounding_floor(true, 1e-3, 0.4e-3, omega));
    CHECK_FALSE(at_rounding_floor(true, 1e-3, 1e-5, omega));
    CHECK_FALSE(at_rounding_floor(false, 1e-3, 2e-3, omega));
    CHECK_FALSE(at_rounding_floor(true, 1e-8, 0.9e-8, omega));
}
