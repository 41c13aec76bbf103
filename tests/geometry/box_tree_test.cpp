#include "geometry/box_tree.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace almesh;

namespace {

std::vector<Box> some_boxes(int count, int dim) {
    std::vector<Box> boxes;
    for (int i = 0; i < count; ++i) {
        std::vector<Vec<3>> corners(2, Vec<3>{});
        for (int a = 0; a < 2 * dim; ++a)
            corners[a / dim][a % dim] = std::sin(12.9898 * i + 4.1 * (a % dim)) + 0.1 * std::sin(i + a);
        boxes.push_back(box_of(corners));
    }
    return boxes;
}

}  // namespace

TEST_CASE("the tree finds the boxes that a plain loop finds") {
    for (int dim = 2; dim <= 3; ++dim)
        for (int count : {0, 1, 2, 3, 17, 500}) {
            const std::vector<Box> boxes = some_boxes(count, dim);
            const BoxTree tree(boxes);
            const std::vector<Box> queries = some_boxes(20, dim);
            std::multiset<std::pair<int, int>> expected, found;
            for (int q = 0; q < 20; ++q)
                for (int i = 0; i < count; ++i)
                    if (overlap(boxes[i], queries[q])) expected.insert({q, i});
            tree.visit_overlapping(queries, [&](int q, int k) { found.insert({q, tree.items[k]}); });
            CHECK(found == expected);
        }
}

TEST_CASE("from each place in the tree on, every pair of overlapping boxes is found once") {
    for (int count : {2, 17, 500}) {
        const BoxTree tree(some_boxes(count, 3));
        std::multiset<std::pair<int, int>> expected, found;
        for (int i = 0; i < count; ++i)
            for (int j = i + 1; j < count; ++j)
                if (overlap(tree.boxes[i], tree.boxes[j])) expected.insert({i, j});
        for (int place = 0; place < count; ++place) {
            const int i = tree.items[place];
            tree.visit_overlapping(
                {tree.boxes[i]}, [&](int, int k) { found.insert(std::minmax(i, int(tree.items[k]))); }, place + 1);
        }
        CHECK(found == expected);
    }
}

TEST_CASE("the tree finds the nearest box without looking at most of them") {
    const std::vector<Box> boxes = some_boxes(2000, 3);
    const BoxTree tree(boxes);
    const double infinity = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 20; ++k) {
        const Vec<3> p = {2 * std::sin(k), 2 * std::cos(3.0 * k), std::sin(5.0 * k)};
        double expected = infinity;
        for (const Box& box : boxes) expected = std::min(expected, squared_distance(box, p));
        int looked_at = 0;
        const double found = tree.nearest_squared(p, [&](int i) {
            ++looked_at;
            return squared_distance(boxes[i], p);
        });
        CHECK(found == expected);
        CHECK(looked_at < 200);
    }
    CHECK(BoxTree({}).nearest_squared(boxes[0].low, [](int) { return 0.0; }) == infinity);
}

TEST_CASE("touching boxes overlap, and equal boxes do not unbalance the tree") {
    const Box a = {{0, 0, 0}, {1, 1, 0}}, b = {{1, 1, 0}, {2, 2, 0}}, c = {{1.0001, 0, 0}, {2, 2, 0}};
    CHECK(overlap(a, b));
    CHECK_FALSE(overlap(a, c));
    const BoxTree tree(std::vector<Box>(1000, a));
    int found = 0;
    tree.visit_overlapping({b}, [&](int, int) { ++found; });
    CHECK(found == 1000);
}
