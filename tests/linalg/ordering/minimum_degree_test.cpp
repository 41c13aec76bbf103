#include "linalg/ordering/minimum_degree.hpp"

#include <doctest/doctest.h>

#include "linalg/direct/assembly_tree.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

SmallGraph small(int n, const Edges& edges) { return {n, n, std::vector<int>(n, 1), edges}; }

long long fill(int n, const Edges& edges, const std::vector<int>& order) {
    const AssemblyTree tree = build_assembly_tree(graph_of(random_spd(n, 1, edges)), order, 1);
    long long entries = 0;
    for (int count : tree.column_count) entries += count;
    return entries;
}

}  // namespace

TEST_CASE("minimum degree orders trees without fill") {
    Edges tree;
    for (int v = 1; v < 200; ++v) tree.push_back({v, (v - 1) / 3});
    for (const Edges& edges : {path(200), star(200), tree}) {
        const std::vector<int> order = minimum_degree(small(200, edges));
        CHECK(is_permutation(order));
        CHECK(fill(200, edges, order) == 200 + 199);
    }
}

TEST_CASE("minimum degree beats the natural order on a grid") {
    const Edges edges = grid(14, 14);
    const std::vector<int> order = minimum_degree(small(196, edges));
    std::vector<int> natural(196);
    for (int i = 0; i < 196; ++i) natural[i] = i;
    CHECK(is_permutation(order));
    CHECK(fill(196, edges, order) < 0.75 * fill(196, edges, natural));
}

TEST_CASE("heavy neighbours and the halo count, but the halo is not ordered") {
    // A path 0 - 1 - 2 - 3: both ends have one neighbour; weights or a halo next to 0 make the other end the first.
    SmallGraph line = small(4, path(4));
    CHECK(minimum_degree(line).front() == 0);
    line.weight[1] = 5;
    CHECK(minimum_degree(line) == std::vector<int>{3, 1, 0, 2});  // then the neighbours of 0, 1, 2 weigh 5, 2, 5
    line = small(4, path(4));
    line.size = 6;
    line.weight.resize(6, 1);
    line.edges.insert(line.edges.end(), {{4, 0}, {5, 0}});
    const std::vector<int> order = minimum_degree(line);
    CHECK(order.front() == 3);
    CHECK(is_permutation(order));
    CHECK(order.size() == 4);
}

TEST_CASE("no vertices, no edges") {
    CHECK(minimum_degree(small(0, {})).empty());
    CHECK(minimum_degree(small(70, {})).size() == 70);
}
