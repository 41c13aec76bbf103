#include "base/parallel.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <vector>
#include <string>

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

TEST_CASE("parallel_in_order() adds results in order, for any number of threads") {
    for (const int n : {0, 1, 100}) {
        std::vector<int> order;
        parallel_in_order(
            n, [](int i) { return 3 * i; },
            [&](int i, int result) {
                CHECK(result == 3 * i);
                order.push_back(i);
            },
            1e6);
        REQUIRE(order.size() == static_cast<std::size_t>(n));
        for (int i = 0; i < n; ++i) CHECK(order[i] == i);
    }
}
