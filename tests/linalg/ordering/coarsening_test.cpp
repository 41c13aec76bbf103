#include "linalg/ordering/multilevel.hpp"

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

int total(const WeightedGraph& graph) { return std::accumulate(graph.weight.begin(), graph.weight.end(), 0); }

bool has_edge(const WeightedGraph& graph, int u, int v) {
    for (int k = graph.start[u]; k < graph.start[u + 1]; ++k)
        if (graph.adjacent[k] == v) return true;
    return false;
}

// Every edge of a graph stands within one merged vertex of the next, or between neighbours there.
void check_cover(const WeightedGraph& fine, const Coarsening& next) {
    int uncovered = 0;
    for (int v = 0; v < fine.size(); ++v)
        for (int k = fine.start[v]; k < fine.start[v + 1]; ++k) {
            const int c = next.coarse_of[v], h = next.coarse_of[fine.adjacent[k]];
            uncovered += c != h && !has_edge(next.graph, c, h);
        }
    CHECK(uncovered == 0);
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

TEST_CASE("a hierarchy has the steps asked for, and none below some hundred vertices") {
    const WeightedGraph square = weighted(graph_of(random_spd(100 * 100, 1, grid(100, 100))));
    const Hierarchy all = build_hierarchy(square, 2, 1);
    REQUIRE(all.coarser.size() == 2);
    CHECK(all.coarsest().size() < 0.25 * 10000);
    CHECK(build_hierarchy(square, 20, 1).coarsest().size() >= 500);
    CHECK(build_hierarchy(weighted(graph_of(random_spd(400, 1, grid(20, 20)))), 3, 1).coarser.empty());
    CHECK(build_hierarchy(WeightedGraph{}, 3, 1).coarser.empty());
    CHECK(build_hierarchy(weighted(graph_of(random_spd(5000, 1, {}))), 3, 1).coarser.empty());  // nothing to merge
}

TEST_CASE("a part of a hierarchy keeps weights, edges and what covers them") {
    const WeightedGraph square = weighted(graph_of(random_spd(100 * 100, 1, grid(100, 100))));
    const Hierarchy all = build_hierarchy(square, 2, 1);
    std::vector<int> kept;
    for (int v = 0; v < 10000; ++v)
        if (v % 100 < 50 + v / 100 % 7) kept.push_back(v);
    const Hierarchy part = restrict_to(all, kept);
    const int size = static_cast<int>(kept.size());
    REQUIRE(part.finest.size() == size);
    REQUIRE(part.coarser.size() == 2);
    for (int v = 0; v < size; ++v)
        for (int u = 0; u < v; ++u)
            if (has_edge(all.finest, kept[v], kept[u]) != has_edge(part.finest, v, u)) FAIL("edge " << v << " " << u);
    check_cover(part.finest, part.coarser[0]);
    check_cover(part.coarser[0].graph, part.coarser[1]);
    CHECK(total(part.finest) == size);
    CHECK(total(part.coarser[0].graph) == size);
    CHECK(total(part.coarser[1].graph) == size);
    CHECK(restrict_to(all, {kept.begin(), kept.begin() + 600}).coarser.empty());
    CHECK(restrict_to(all, {}).finest.size() == 0);
}

TEST_CASE("a separator found on a hierarchy, or on a part of it, separates the finest graph") {
    const WeightedGraph square = weighted(graph_of(random_spd(100 * 100, 1, grid(100, 100))));
    const Hierarchy all = build_hierarchy(square, 2, 1);
    std::vector<int> kept;
    for (int v = 0; v < 10000; ++v)
        if (v % 100 < 60) kept.push_back(v);
    for (const Hierarchy& graphs : {all, restrict_to(all, kept)}) {
        const std::vector<Part> part = find_separator(graphs, 3);
        const WeightedGraph& fine = graphs.finest;
        REQUIRE(part.size() == static_cast<std::size_t>(fine.size()));
        int weight[3] = {0, 0, 0}, crossing = 0;
        for (int v = 0; v < fine.size(); ++v) {
            ++weight[part[v]];
            for (int k = fine.start[v]; k < fine.start[v + 1]; ++k) crossing += part[v] + part[fine.adjacent[k]] == 1;
        }
        CHECK(crossing == 0);
        CHECK(weight[separator] <= 115);
        CHECK(std::max(weight[left], weight[right]) <= 0.62 * fine.size());
    }
}
