#include "base/parallel.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using namespace almesh;

TEST_CASE("parallel_invoke() does both, and passes on what the first one throws, or else the second") {
    const int before = max_threads();
    for (int threads : {1, 2, 3}) {
        set_threads(threads);
        int first = 0, second = 0;
        parallel_invoke([&] { first = 1; }, [&] { second = 2; });
        CHECK(first == 1);
        CHECK(second == 2);
        const auto fails = [](const char* why) { return [why] { throw std::runtime_error(why); }; };
        CHECK_THROWS_WITH(parallel_invoke(fails("one"), [&] { second = 3; }), "one");
        CHECK(second == 3);
        CHECK_THROWS_WITH(parallel_invoke([&] { first = 4; }, fails("two")), "two");
        CHECK(first == 4);
        CHECK_THROWS_WITH(parallel_invoke(fails("one"), fails("two")), "one");
    }
    set_threads(before);
}

TEST_CASE("parallel_for_throwing() does all, and passes on what the first iteration to throw throws") {
    const int before = max_threads();
    for (int threads : {1, 2, 3}) {
        set_threads(threads);
        std::atomic<int> done = 0;
        const auto body = [&](int i) {
            if (i == 700 || i == 41 || i == 42) throw std::runtime_error(std::to_string(i));
            ++done;
        };
        CHECK_THROWS_WITH(parallel_for_throwing(1000, body, 1000), "41");
        CHECK(done == 997);
        parallel_for_throwing(41, body, 1e6);
        CHECK(done == 997 + 41);
    }
    set_threads(before);
}

#ifdef _OPENMP
TEST_CASE("a team of threads is started only for several iterations of enough work in all") {
    const int before = max_threads();
    set_threads(2);
    int several = 1;  // as many as OpenMP gives, by its limits
#pragma omp parallel
#pragma omp master
    several = omp_get_num_threads();
    int team = 0;
    const auto look = [&](int i) {
        if (i == 0) team = omp_get_num_threads();
    };
    parallel_for(1, look, 1e9);
    CHECK(team == 1);
    parallel_for_uneven(1, look, 1e9);
    CHECK(team == 1);
    parallel_for(2, look, 1e9);
    CHECK(team == several);
    parallel_for_uneven(2, look, 1e9);
    CHECK(team == several);
    parallel_invoke([&] { look(0); }, [] {}, 1000);
    CHECK(team == 1);
    parallel_invoke([&] { look(0); }, [] {});
    CHECK(team == several);
    parallel_tasks(2, false, look);
    CHECK(team == 1);
    parallel_tasks(2, true, look);
    CHECK(team == several);
    in_team(true, [&] {
#pragma omp single
        team = omp_get_num_threads();
    });
    CHECK(team == several);
    set_threads(before);
}

TEST_CASE("where no team helps there is none, not even one of a single thread") {
    const int before = max_threads();
    set_threads(2);
    int level = -1, calls = 0;
    const auto look = [&](int) { level = omp_get_level(); };
    const auto no_team = [&] { return std::exchange(level, -1) == 0; };
    parallel_for(2, look, 1);
    CHECK(no_team());
    parallel_for_uneven(2, look, 1);
    CHECK(no_team());
    parallel_tasks(2, false, look);
    CHECK(no_team());
    parallel_tasks(1, true, look);
    CHECK(no_team());
    in_team(false, [&] {
        look(0);
        ++calls;
    });
    CHECK(no_team());
    CHECK(calls == 1);
    set_threads(1);
    parallel_tasks(2, true, look);
    CHECK(no_team());
    set_threads(before);
}

TEST_CASE("in_team() inside a team: each of its threads does all that is in it") {
    const int before = max_threads();
    set_threads(2);
    std::atomic<int> threads = 0, rounds = 0;
#pragma omp parallel
    {
        ++threads;
        in_team(false, [&] {
#pragma omp for
            for (int i = 0; i < 10; ++i) ++rounds;
        });
    }
    CHECK(rounds == 10 * threads);
    set_threads(before);
}
#endif
