#include "linalg/ordering/multilevel.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "linalg/ordering/graph.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

struct Weights {
    int part[3] = {0, 0, 0};
};

// Checks that it is a separator, and weighs the parts.
Weights weigh(const WeightedGraph& graph, const std::vector<Part>& part) {
    Weights weights;
    REQUIRE(part.size() == static_cast<std::size_t>(graph.size()));
    for (int v = 0; v < graph.size(); ++v) {
        weights.part[part[v]] += graph.weight[v];
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
            const Part other = part[graph.adjacent[k]];
            CHECK((part[v] == separator || other == separator || part[v] == other));
        }
    }
    return weights;
}

}  // namespace

TEST_CASE("separators of grids are about as small as their shorter side") {
    const WeightedGraph square = weighted(graph_of(random_spd(60 * 60, 1, grid(60, 60))));
    const WeightedGraph strip = weighted(graph_of(random_spd(8 * 300, 1, grid(300, 8))));
    for (std::uint64_t seed : {1u, 2u, 3u}) {
        const Weights w = weigh(square, find_separator({square}, seed));
        CHECK(w.part[separator] <= 70);
        CHECK(std::max(w.part[left], w.part[right]) <= 0.62 * 3600);
        CHECK(weigh(strip, find_separator({strip}, seed)).part[separator] <= 9);
    }
}

TEST_CASE("one vertex separates a star and a path, none two equal components") {
    const WeightedGraph arrow = weighted(graph_of(random_spd(301, 1, star(301))));
    Weights w = weigh(arrow, find_separator({arrow}, 5));
    CHECK(w.part[separator] == 1);
    CHECK(std::max(w.part[left], w.part[right]) <= 181);
    const WeightedGraph line = weighted(graph_of(random_spd(300, 1, path(300))));
    CHECK(weigh(line, find_separator({line}, 5)).part[separator] == 1);
    Edges edges = grid(15, 15);
    for (const auto& [i, j] : grid(15, 15)) edges.push_back({i + 225, j + 225});
    const WeightedGraph two = weighted(graph_of(random_spd(450, 1, edges)));
    CHECK(weigh(two, find_separator({two}, 5)).part[separator] == 0);
}

TEST_CASE("vertex weights count, not vertices") {
    WeightedGraph line = weighted(graph_of(random_spd(200, 1, path(200))));
    for (int v = 0; v < 20; ++v) line.weight[v] = 10;  // the first 20 weigh 200, the rest 180
    const Weights w = weigh(line, find_separator({line}, 5));
    CHECK(w.part[separator] == 1);
    CHECK(std::max(w.part[left], w.part[right]) <= 0.62 * 380);
}

TEST_CASE("a complete graph cannot be split, an empty one neither") {
    const WeightedGraph all = weighted(graph_of(random_spd(20, 1, complete(20))));
    weigh(all, find_separator({all}, 1));
    CHECK(find_separator({}, 1).empty());
}

TEST_CASE("the same seed gives the same separator") {
    const WeightedGraph square = weighted(graph_of(random_spd(1600, 1, grid(40, 40))));
    CHECK(find_separator({square}, 4) == find_separator({square}, 4));
}
