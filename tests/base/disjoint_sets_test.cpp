#include "base/disjoint_sets.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("disjoint sets are known by their least number, in whatever order they are joined") {
    DisjointSets sets(7);
    sets.join(6, 4);
    sets.join(2, 5);
    sets.join(5, 6);
    sets.join(3, 1);
    const int least[] = {0, 1, 2, 1, 2, 2, 2};
    for (int i = 0; i < 7; ++i) CHECK(sets.find(i) == least[i]);
    sets.join(6, 3);
    for (const int i : {2, 3, 4, 5, 6}) CHECK(sets.find(i) == 1);
    CHECK(sets.find(0) == 0);
}
