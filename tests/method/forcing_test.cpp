#include "method/forcing.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("forcing terms against values by hand") {
    constexpr double order = 1.6180339887498949, largest = 1e-3;
    CHECK(forcing_term(1, 1e-4, 0, 1e-10) == doctest::Approx(0.9 * std::pow(1e-4, order)).epsilon(1e-14));
    CHECK(forcing_term(100, 1e-2, 0, 1e-10) == forcing_term(1, 1e-4, 0, 1e-10));  // only the ratio counts
    CHECK(forcing_term(2, 2, 0, 1e-10) == largest);        // no progress: the largest one
    CHECK(forcing_term(1, 1e-8, 0, 1e-10) == 1e-10);               // the floor
    CHECK(forcing_term(1, 1e-8, 1e-12, 1e-10) == doctest::Approx(0.5e-4).epsilon(1e-14));  // omega ends the iteration
    CHECK(forcing_term(1, 1e-8, 1e-8, 1e-10) == largest);  // already there
    CHECK(forcing_term(1, 1e-4, 0, 0.3) == 0.3);                   // a deck that asks for less than the largest
}

TEST_CASE("the first system of a subproblem is solved to 1e-4, and so is one after a step that was cut") {
    ForcingTerm forcing{Forcing::automatic, 1e-10};
    forcing.start();
    CHECK(forcing.value == 1e-4);
    forcing.after_step(1, 1, 1e-3, 0);
    CHECK(forcing.value == forcing_term(1, 1e-3, 0, 1e-10));
    forcing.after_step(0.5, 1, 1e-3, 0);
    CHECK(forcing.value == 1e-4);
    forcing.after_step(2, 1, 1e-3, 0);  // a lengthened step is a full one
    CHECK(forcing.value == forcing_term(1, 1e-3, 0, 1e-10));
    ForcingTerm fixed{Forcing::fixed, 1e-6};
    fixed.start();
    fixed.after_step(1, 1, 1e-3, 0);
    CHECK(fixed.value == 1e-6);
}
