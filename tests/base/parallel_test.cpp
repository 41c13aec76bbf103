#include "base/parallel.hpp"

#include <doctest/doctest.h>

#include <stdexcept>

using namespace almesh;

TEST_CASE("at_once() does both, and passes on what the first one throws, or else the second") {
    const int before = max_threads();
    for (int threads : {1, 2, 3}) {
        set_threads(threads);
        int first = 0, second = 0;
        at_once([&] { first = 1; }, [&] { second = 2; });
        CHECK(first == 1);
        CHECK(second == 2);
        const auto fails = [](const char* why) { return [why] { throw std::runtime_error(why); }; };
        CHECK_THROWS_WITH(at_once(fails("one"), [&] { second = 3; }), "one");
        CHECK(second == 3);
        CHECK_THROWS_WITH(at_once([&] { first = 4; }, fails("two")), "two");
        CHECK(first == 4);
        CHECK_THROWS_WITH(at_once(fails("one"), fails("two")), "one");
    }
    set_threads(before);
}
