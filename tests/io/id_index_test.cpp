#include "io/id_index.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace almesh;

namespace {

void check_finds(const std::vector<long long>& ids, const std::vector<long long>& others) {
    IdIndex index(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) CHECK(index.insert(ids[i], static_cast<int>(i)) == -1);
    for (std::size_t i = 0; i < ids.size(); ++i) CHECK(index.find(ids[i]) == static_cast<int>(i));
    for (long long id : others) CHECK(index.find(id) == -1);
}

}  // namespace

TEST_CASE("ids are found, dense or sparse, in any order, and no others") {
    constexpr long long low = std::numeric_limits<long long>::min(), high = std::numeric_limits<long long>::max();
    check_finds({}, {0, 1, low, high});
    check_finds({5}, {4, 6, low, high});
    check_finds({1, 2, 3, 7}, {0, 4, 8, -1, high});
    check_finds({3, 1, 2}, {0, 4});
    check_finds({high, low, 0}, {1, -1, high - 1});
    check_finds({1000000, 1}, {2, 999999, 0});
}

TEST_CASE("an id that is there already keeps its index, which is told") {
    IdIndex index(2);
    for (const long long id : {3LL, 3000000000LL}) {
        CHECK(index.insert(id, 7) == -1);
        CHECK(index.insert(id, 8) == 7);
        CHECK(index.find(id) == 7);
    }
}
