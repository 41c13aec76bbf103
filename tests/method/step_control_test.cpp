#include "method/step_control.hpp"

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

namespace {

// Full steps until the full Hessian is tried; 100 where it never is.
int steps_until_full(Damping damping, double step_length = 1) {
    for (int steps = 1; steps < 100; ++steps)
        if (damping.after_step(step_length) == HessianKind::full) return steps;
    return 100;
}

Damping cut(Damping damping, int times) {
    for (; times > 0; --times) CHECK(damping.after_step(0.9) == HessianKind::projected);
    return damping;
}

}  // namespace

TEST_CASE("the damping: from the identity two full steps lead to the full Hessian, steps that are cut delay it") {
    Damping damping;
    CHECK(steps_until_full(damping) == 1);
    CHECK(steps_until_full(damping, 2) == 1);  // a lengthened step is a full one
    damping.reset();
    CHECK(steps_until_full(damping) == 2);
    damping.after_step(1);
    damping.after_step(1);
    CHECK(steps_until_full(damping) == 1);
    CHECK(steps_until_full(cut(damping, 1)) == 1);
    CHECK(steps_until_full(cut(damping, 2)) == 2);
    CHECK(steps_until_full(cut(damping, 50)) == 2);  // no more than at the identity
    CHECK(steps_until_full(damping, 0.9) == 100);
    CHECK(cut(damping, 50).factor == 1);
}

TEST_CASE("as much of the negative eigenvalues is kept as the Hessian bears") {
    EigenvalueFiltering part = EigenvalueFiltering::of_few_nodes();
    CHECK(part.kept == 1);
    part.after_step(1);
    CHECK(part.kept == 1);  // no more than all
    for (const double expected : {0.5, 0.25, 0.125, 0.1, 0.1}) {
        part.after_step(0.9);
        CHECK(part.kept == expected);
    }
    for (const double expected : {0.2, 0.4}) {
        part.after_step(2);  // a lengthened step is a full one
        CHECK(part.kept == expected);
    }
}

TEST_CASE("of the whole mesh none are kept until a step had to be lengthened, and never all") {
    EigenvalueFiltering part = EigenvalueFiltering::of_mesh();
    for (const double step_length : {1.0, 0.5, 1e-3}) {
        part.after_step(step_length);
        CHECK(part.kept == 0);
    }
    for (const double expected : {0.2, 0.4, 0.8, 0.9, 0.9}) {
        part.after_step(2);
        CHECK(part.kept == expected);
        part.after_step(1);
        CHECK(part.kept == expected);
    }
    for (const double expected : {0.45, 0.225, 0.1125, 0.0}) {
        EigenvalueFiltering weaker = part;
        weaker.filter_more();
        CHECK(weaker.kept == expected);
        part.after_step(0.9);
        CHECK(part.kept == expected);
    }
}

TEST_CASE("a Hessian that gives no step is tried with less and less of them, at last with none") {
    EigenvalueFiltering part = EigenvalueFiltering::of_few_nodes();
    for (const double expected : {0.5, 0.25, 0.125, 0.0}) {
        part.filter_more();
        CHECK(part.kept == expected);
    }
    for (const double step_length : {0.5, 1.0}) {  // not for long
        EigenvalueFiltering after = part;
        after.after_step(step_length);
        CHECK(after.kept == 0.1);
    }
}

TEST_CASE("systems are solved more exactly after steps of which hardly anything is valid, and stay so") {
    ForcingTerm forcing{Forcing::automatic, 1e-9};
    forcing.start();
    CHECK(forcing.value == 1e-4);
    forcing.after_step(0.5, 1, 1, 1e-8);
    CHECK(forcing.value == 1e-4);
    forcing.after_step(0.01, 1, 1, 1e-8);
    CHECK(forcing.value == doctest::Approx(1e-6));
    forcing.after_step(1, 1, 0.5, 1e-8);
    CHECK(forcing.value == doctest::Approx(1e-6));
    forcing.start();
    forcing.after_step(0.001, 1, 1, 1e-8);
    CHECK(forcing.value == doctest::Approx(1e-8));
}
