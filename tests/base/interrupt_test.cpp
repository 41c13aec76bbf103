#include "base/interrupt.hpp"

#include <doctest/doctest.h>

#include <csignal>

#include "check/certificate.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("a signal ends a run after the Newton step at hand, with a valid mesh") {
    const Minimisation problem(ring_mesh(12, 3, 6), {{"inner", "translate 2 0"}}, Objective::squared);
    catch_interrupts();
    AlObserver observer;
    int steps = 0;
    observer.newton_step = [&](int, const NewtonStep&) {
        if (++steps == 3) std::raise(SIGINT);
    };
    std::vector<double> x;
    const AlResult result = problem.solve({}, x, observer);
    CHECK(interrupted());
    clear_interrupt();
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    CHECK(result.status == AlStatus::interrupted);
    CHECK(steps == 3);
    CHECK(x != problem.ideal);
    CHECK(certify(problem.mesh, x).valid);
    CHECK(!interrupted());
}
