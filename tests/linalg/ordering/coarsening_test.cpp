#include "linalg/ordering/coarsening.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

WeightedGraph weighted(const Graph& graph) {
    return {graph.start, graph.adjacent, std::vector<int>(graph.adjacent.size(), 1), std::vector<int>(graph.size(), 1)};
}

}  // namespace

TEST_CASE("coarsening merges up to three neighbours and keeps all weights") {
    WeightedGraph fine = weighted(graph_of(random_spd(900, 1, grid(30, 30))));
    for (int level = 0; level < 3; ++level) {
        const Coarsening step = coarsen(fine, 100, 11);
        const WeightedGraph& coarse = step.graph;
        CHECK(coarse.size() < 0.5 * fine.size());
        CHECK(std::accumulate(coarse.weight.begin(), coarse.weight.end(), 0) == 900);
        std::vector<int> weight(coarse.size(), 0), members(coarse.size(), 0);
        std::map<std::pair<int, int>, int> edges, expected;
        for (int v = 0; v < fine.size(); ++v) {
            const int c = step.coarse_of[v];
            weight[c] += fine.weight[v];
            ++members[c];
            for (int k = fine.start[v]; k < fine.start[v + 1]; ++k)
                if (const int h = step.coarse_of[fine.adjacent[k]]; h != c) expected[{c, h}] += fine.edge_weight[k];
        }
        for (int c = 0; c < coarse.size(); ++c)
            for (int k = coarse.start[c]; k < coarse.start[c + 1]; ++k) {
                CHECK(edges.count({c, coarse.adjacent[k]}) == 0);
                edges[{c, coarse.adjacent[k]}] = coarse.edge_weight[k];
            }
        CHECK(weight == coarse.weight);
        CHECK(*std::max_element(members.begin(), members.end()) == 3);
        CHECK(edges == expected);
        fine = coarse;
    }
}

TEST_CASE("heavy edges are preferred, and too heavy groups are not made") {
    // A path with weights 1 9 1 9 1: the heavy edges are a perfect matching.
    const Graph line = graph_of(random_spd(6, 1, path(6)));
    WeightedGraph graph = weighted(line);
    for (int v = 0; v < 6; ++v)
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k)
            graph.edge_weight[k] = (std::min(v, graph.adjacent[k]) % 2) ? 1 : 9;
    CHECK(coarsen(graph, 2, 1).coarse_of == std::vector<int>{0, 0, 1, 1, 2, 2});
    CHECK(coarsen(graph, 1, 1).graph.size() == 6);
}

TEST_CASE("large graphs are coarsened the same way by any number of threads, however they are numbered") {
    constexpr int side = 320, n = side * side;  // in blocks, and the coarse graph too
    Edges edges = grid(side, side);
    std::vector<int> scrambled(n);
    std::iota(scrambled.begin(), scrambled.end(), 0);
    std::shuffle(scrambled.begin(), scrambled.end(), std::mt19937(1));
    const int before = max_threads();
    for (bool scramble : {false, true}) {
        if (scramble)
            for (auto& [i, j] : edges) i = scrambled[i], j = scrambled[j];
        const WeightedGraph fine = weighted(graph_of(random_spd(n, 1, edges)));
        set_threads(1);
        const Coarsening first = coarsen(fine, 100, 3);
        CHECK(first.graph.size() < 0.5 * n);
        CHECK(std::accumulate(first.graph.weight.begin(), first.graph.weight.end(), 0) == n);
        CHECK(first.graph.start.back() == static_cast<int>(first.graph.adjacent.size()));
        long long inner = 0, weight = 0;
        for (int v = 0; v < n; ++v)
            for (int k = fine.start[v]; k < fine.start[v + 1]; ++k)
                inner += first.coarse_of[v] == first.coarse_of[fine.adjacent[k]];
        for (int w : first.graph.edge_weight) weight += w;
        CHECK(weight == static_cast<long long>(fine.adjacent.size()) - inner);
        for (int threads : {2, 3, 8}) {
            set_threads(threads);
            const Coarsening next = coarsen(fine, 100, 3);
            CHECK(next.coarse_of == first.coarse_of);
            CHECK(next.graph.adjacent == first.graph.adjacent);
            CHECK(next.graph.edge_weight == first.graph.edge_weight);
        }
    }
    set_threads(before);
}
