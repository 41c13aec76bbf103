#include "io/id_index.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace almesh;

namespace {

struct Item {
    long long id;
};

void check_finds(const std::vector<Item>& items, const std::vector<long long>& others) {
    const IdIndex index(sorted_ids(items));
    for (std::size_t i = 0; i < items.size(); ++i) CHECK(index.find(items[i].id) == static_cast<int>(i));
    for (long long id : others) CHECK(index.find(id) == -1);
}

}  // namespace

TEST_CASE("ids are found, dense or sparse, in any order, and no others") {
    constexpr long long low = std::numeric_limits<long long>::min(), high = std::numeric_limits<long long>::max();
    check_finds({}, {0, 1, low, high});
    check_finds({{5}}, {4, 6, low, high});
    check_finds({{1}, {2}, {3}, {7}}, {0, 4, 8, -1, high});
    check_finds({{3}, {1}, {2}}, {0, 4});
    check_finds({{high}, {low}, {0}}, {1, -1, high - 1});
    check_finds({{1000000}, {1}}, {2, 999999, 0});
}

TEST_CASE("ids ascend, equal ones by index") {
    const std::vector<IdAndIndex> sorted = sorted_ids(std::vector<Item>{{7}, {2}, {7}});
    CHECK(sorted == std::vector<IdAndIndex>{{2, 1}, {7, 0}, {7, 2}});
}
