#include "linalg/coarsening.hpp"

#include <algorithm>
#include <numeric>
#include <random>

namespace almesh {

namespace {

constexpr int largest_group = 3;  // vertices merged into one
constexpr int shuffled = 64;      // vertices shuffled among themselves: near ones stay near in memory

// Vertices in the order in which they choose.
std::vector<int> visiting_order(int n, std::uint64_t seed) {
    std::vector<int> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::minstd_rand random(static_cast<unsigned>(seed % 2147483646u + 1));
    for (int i = n - 1; i > 0; --i) {
        const int first = i / shuffled * shuffled;
        std::swap(order[i], order[first + random() % (i - first + 1)]);
    }
    return order;
}

// leader[v]: a vertex that stands for the group of v. Every vertex joins the group at the other end of its heaviest
// edge, the smallest group among equals.
std::vector<int> find_groups(const WeightedGraph& graph, int heaviest, std::uint64_t seed) {
    std::vector<int> leader(graph.size(), -1), members(graph.size(), 1), weight = graph.weight;
    for (int v : visiting_order(graph.size(), seed)) {
        if (leader[v] >= 0) continue;
        int best = v, best_weight = 0;
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
            if (graph.edge_weight[k] < best_weight) continue;
            const int u = graph.adjacent[k], group = leader[u] < 0 ? u : leader[u];
            if (graph.edge_weight[k] == best_weight && members[group] >= members[best]) continue;
            if (members[group] == largest_group || weight[group] + graph.weight[v] > heaviest) continue;
            best = group;
            best_weight = graph.edge_weight[k];
        }
        leader[best] = best;
        if (best == v) continue;
        leader[v] = best;
        ++members[best];
        weight[best] += graph.weight[v];
    }
    return leader;
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
    const std::vector<int> leader = find_groups(graph, heaviest, seed);
    Coarsening result;
    result.coarse_of.assign(n, -1);
    std::vector<int> first, last, next(n, -1);  // the members of each group as a list, ascending
    for (int v = 0; v < n; ++v) {
        int& c = result.coarse_of[leader[v]];
        if (c < 0) {
            c = static_cast<int>(first.size());
            first.push_back(v);
            last.push_back(v);
        } else {
            last[c] = next[last[c]] = v;
        }
        result.coarse_of[v] = c;
    }
    const int groups = static_cast<int>(first.size());
    std::vector<int> place(groups, -1);
    WeightedGraph& coarse = result.graph;
    coarse.start.reserve(groups + 1);
    coarse.weight.assign(groups, 0);
    coarse.adjacent.reserve(graph.adjacent.size());
    coarse.edge_weight.reserve(graph.adjacent.size());
    for (int c = 0; c < groups; ++c) {
        const int begin = static_cast<int>(coarse.adjacent.size());
        for (int v = first[c]; v >= 0; v = next[v]) {
            append_edges(graph, v, c, result.coarse_of, begin, place, coarse);
            coarse.weight[c] += graph.weight[v];
        }
        coarse.start.push_back(static_cast<int>(coarse.adjacent.size()));
    }
    return result;
}

}  // namespace almesh
