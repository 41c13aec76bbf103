#include "linalg/ordering/hierarchy.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/separator.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

WeightedGraph weighted(const Graph& graph) {
    return {graph.start, graph.adjacent, std::vector<int>(graph.adjacent.size(), 1), std::vector<int>(graph.size(), 1)};
}

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
