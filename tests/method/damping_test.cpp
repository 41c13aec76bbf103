#include "method/damping.hpp"

#include <doctest/doctest.h>

using namespace almesh;

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
