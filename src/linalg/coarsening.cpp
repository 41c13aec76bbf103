#include "linalg/coarsening.hpp"

#include <algorithm>
#include <numeric>
#include <random>

namespace almesh {

namespace {

// Vertices by ascending degree, shuffled among equals: those with few neighbours have the least choice of a partner
// and choose first.
std::vector<int> visiting_order(const WeightedGraph& graph, std::uint64_t seed) {
    constexpr int classes = 64;
    const int n = graph.size();
    std::vector<int> shuffled(n), order(n), next(classes + 1, 0);
    std::iota(shuffled.begin(), shuffled.end(), 0);
    std::minstd_rand random(static_cast<unsigned>(seed % 2147483646u + 1));
    for (int i = n - 1; i > 0; --i) std::swap(shuffled[i], shuffled[random() % (i + 1)]);
    auto degree = [&](int v) { return std::min(classes - 1, graph.start[v + 1] - graph.start[v]); };
    for (int v = 0; v < n; ++v) ++next[degree(v) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (int v : shuffled) order[next[degree(v)]++] = v;
    return order;
}

// partner[v] along the heaviest edge to an unmatched vertex, v itself where there is none.
std::vector<int> match(const WeightedGraph& graph, int heaviest, std::uint64_t seed) {
    std::vector<int> partner(graph.size(), -1);
    for (int v : visiting_order(graph, seed)) {
        if (partner[v] >= 0) continue;
        int best = v, best_weight = 0;
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
            const int u = graph.adjacent[k];
            if (partner[u] >= 0 || graph.edge_weight[k] <= best_weight) continue;
            if (graph.weight[v] + graph.weight[u] > heaviest) continue;
            best = u;
            best_weight = graph.edge_weight[k];
        }
        partner[v] = best;
        partner[best] = v;
    }
    return partner;
}

// Appends the edges of fine vertex v to coarse vertex c; place[h] = where the edge c-h stands, if >= begin.
void append_edges(const WeightedGraph& fine, int v, int c, const std::vector<int>& coarse_of, int begin,
                  std::vector<int>& place, WeightedGraph& coarse) {
    for (int k = fine.start[v]; k < fine.start[v + 1]; ++k) {
        const int h = coarse_of[fine.adjacent[k]];
        if (h == c) continue;
        if (place[h] < begin) {
            place[h] = static_cast<int>(coarse.adjacent.size());
            coarse.adjacent.push_back(h);
            coarse.edge_weight.push_back(0);
        }
        coarse.edge_weight[place[h]] += fine.edge_weight[k];
    }
}

}  // namespace

Coarsening coarsen(const WeightedGraph& graph, int heaviest, std::uint64_t seed) {
    const int n = graph.size();
    const std::vector<int> partner = match(graph, heaviest, seed);
    Coarsening result;
    result.coarse_of.resize(n);
    int count = 0;
    for (int v = 0; v < n; ++v)
        result.coarse_of[v] = partner[v] < v ? result.coarse_of[partner[v]] : count++;
    std::vector<int> place(count, -1);
    WeightedGraph& coarse = result.graph;
    coarse.start.reserve(count + 1);
    coarse.weight.reserve(count);
    coarse.adjacent.reserve(graph.adjacent.size());
    coarse.edge_weight.reserve(graph.adjacent.size());
    for (int v = 0; v < n; ++v) {
        if (partner[v] < v) continue;
        const int c = result.coarse_of[v], begin = static_cast<int>(coarse.adjacent.size());
        append_edges(graph, v, c, result.coarse_of, begin, place, coarse);
        if (partner[v] != v) append_edges(graph, partner[v], c, result.coarse_of, begin, place, coarse);
        coarse.weight.push_back(graph.weight[v] + (partner[v] != v ? graph.weight[partner[v]] : 0));
        coarse.start.push_back(static_cast<int>(coarse.adjacent.size()));
    }
    return result;
}

}  // namespace almesh
