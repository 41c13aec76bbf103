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
    const CatchInterrupts catching;
    AlObserver observer;
    int steps = 0;
    observer.newton_step = [&](int, const NewtonStep&) {
        if (++steps == 3) std::raise(SIGINT);
    };
    std::vector<double> x;
    const AlResult result = problem.solve({}, x, observer);
    CHECK(interrupted());
    clear_interrupt();
    CHECK(result.status == Status::interrupted);
    CHECK(steps == 3);
    CHECK(x != problem.ideal);
    CHECK(certify(problem.mesh, x).valid);
    CHECK(!interrupted());
}

TEST_CASE("signals are caught while somebody polls the flag, and do what they did before and after") {
    const auto handler_of = [](int signal) {
        const auto handler = std::signal(signal, SIG_DFL);
        std::signal(signal, handler);
        return handler;
    };
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const auto outside = std::signal(signal, SIG_DFL);  // ignored where the tests run under nohup
        {
            const CatchInterrupts catching;
            CHECK(!interrupted());
            std::raise(signal);
            CHECK(interrupted());
            clear_interrupt();
            CHECK((handler_of(signal) == SIG_DFL));  // a second one ends the program
        }
        CHECK((handler_of(signal) == SIG_DFL));
        std::signal(signal, outside);
    }
    const auto before = std::signal(SIGHUP, SIG_IGN);  // as nohup has it
    {
        const CatchInterrupts catching;
        std::raise(SIGHUP);
        CHECK(!interrupted());
    }
    CHECK((handler_of(SIGHUP) == SIG_IGN));
    std::signal(SIGHUP, before);
}

TEST_CASE("a time limit ends while it lives") {
    CHECK(!interrupted());
    {
        const TimeLimit none(0);
        CHECK(!interrupted());
    }
    {
        const TimeLimit short_one(1e-9);
        while (Clock::now() < deadline) {}
        CHECK(out_of_time());
        CHECK(interrupted());
    }
    {
        const TimeLimit long_one(1e9);
        CHECK(!interrupted());
    }
    CHECK(!interrupted());
}
