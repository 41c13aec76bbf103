#include "base/interrupt.hpp"

#include <doctest/doctest.h>

#include <csignal>

#include "check/certificate.hpp"
#include "support/child.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"
#include "support/temporary_folder.hpp"

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

TEST_CASE("where nothing is computed yet a signal ends the program, with a sentence and the exit code of a run") {
    const TemporaryFolder folder;
    const std::string error = folder.path("error.txt");
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const auto body = [&] {
            std::signal(signal, SIG_DFL);
            if (!std::freopen(error.c_str(), "w", stderr)) return 1;
            const EndAtInterrupts ending;
            std::raise(signal);
            return 0;
        };
        CHECK(in_child(body, [](pid_t) {}) == 3);
        CHECK(text_of(error) == "almesh: interrupted before the first step; try the run again\n");
    }
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
