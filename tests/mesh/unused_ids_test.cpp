#include "mesh/unused_ids.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("unused ids follow the largest one, and fill gaps where no number is larger") {
    UnusedIds<long long> after({7, 3, 12});
    CHECK(after.next() == 13);
    CHECK(after.next() == 14);
    CHECK(UnusedIds<int>({}).next() == 1);
    constexpr int last = std::numeric_limits<int>::max();
    UnusedIds<int> between({4, last - 1, 2, 1, 2});
    CHECK(between.next() == last);
    for (const int id : {3, 5, 6, 7}) CHECK(between.next() == id);
    UnusedIds<int> from_start({last});
    for (const int id : {1, 2}) CHECK(from_start.next() == id);
}
