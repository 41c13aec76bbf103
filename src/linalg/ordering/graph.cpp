// compress(): vertices whose closed neighbourhoods have equal hashes are compared (Ashcraft, SIAM J. Sci. Comput. 16,
// 1995).
#include "linalg/ordering/graph.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include "linalg/block_csr.hpp"

namespace almesh {

Graph graph_of(const BlockCsr& A) {
    Graph graph;
    graph.start.reserve(A.n + 1);
    graph.adjacent.reserve(A.col.size());
    for (int i = 0; i < A.n; ++i) {
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            if (A.col[k] != i) graph.adjacent.push_back(A.col[k]);
        graph.start.push_back(static_cast<int>(graph.adjacent.size()));
    }
    return graph;
}

WeightedGraph weighted(Graph graph) {
    const std::size_t edges = graph.adjacent.size(), vertices = graph.size();
    return {std::move(graph), std::vector<int>(edges, 1), std::vector<int>(vertices, 1)};
}

WeightedGraph induced(const WeightedGraph& from, const std::vector<int>& kept) {
    std::vector<int> local(from.size(), -1);
    for (std::size_t k = 0; k < kept.size(); ++k) local[kept[k]] = static_cast<int>(k);
    WeightedGraph graph;
    graph.start.reserve(kept.size() + 1);
    graph.weight.reserve(kept.size());
    std::size_t edges = 0;
    for (int v : kept) edges += from.start[v + 1] - from.start[v];
    graph.adjacent.reserve(edges);
    graph.edge_weight.reserve(edges);
    for (int v : kept) {
        for (int k = from.start[v]; k < from.start[v + 1]; ++k)
            if (const int u = local[from.adjacent[k]]; u >= 0) {
                graph.adjacent.push_back(u);
                graph.edge_weight.push_back(from.edge_weight[k]);
            }
        graph.start.push_back(static_cast<int>(graph.adjacent.size()));
        graph.weight.push_back(from.weight[v]);
    }
    return graph;
}

std::vector<int> inverse(const std::vector<int>& order) {
    std::vector<int> position(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) position[order[k]] = static_cast<int>(k);
    return position;
}

Groups sorted_by_group(const std::vector<int>& group, int groups) {
    Groups result{std::vector<int>(groups + 1, 0), std::vector<int>(group.size())};
    for (int g : group) ++result.start[g + 1];
    std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
    std::vector<int> next(result.start.begin(), result.start.end() - 1);
    for (std::size_t k = 0; k < group.size(); ++k) result.item[next[group[k]]++] = static_cast<int>(k);
    return result;
}

namespace {

// group[v] of every vertex, numbered by first appearance. Vertices of equal neighbourhood are neighbours of each
// other, so only neighbours of equal hash need to be compared.
std::vector<int> group_equal_neighbourhoods(const Graph& graph, int& groups) {
    const int n = graph.size();
    std::vector<std::uint64_t> hash(n);
    auto scramble = [](std::uint64_t v) { return (v + 1) * 0x9e3779b97f4a7c15u ^ (v + 77) * 0xbf58476d1ce4e5b9u; };
    for (int v = 0; v < n; ++v) {
        hash[v] = scramble(v);
        for (int u : graph.neighbours(v)) hash[v] += scramble(u);
    }
    std::vector<int> group(n, -1), mark(n, -1);
    groups = 0;
    for (int v = 0; v < n; ++v) {
        if (group[v] >= 0) continue;
        group[v] = groups++;
        mark[v] = v;
        for (int u : graph.neighbours(v)) mark[u] = v;
        for (int u : graph.neighbours(v)) {
            if (group[u] >= 0 || hash[u] != hash[v] || graph.degree(u) != graph.degree(v)) continue;
            const auto near_u = graph.neighbours(u);
            if (std::all_of(near_u.begin(), near_u.end(), [&](int w) { return mark[w] == v; })) group[u] = group[v];
        }
    }
    return group;
}

}  // namespace

CompressedGraph compress(const Graph& graph) {
    int groups = 0;
    const std::vector<int> group = group_equal_neighbourhoods(graph, groups);
    Graph quotient;
    std::vector<int> mark(groups, -1), weight(groups);
    Groups members = sorted_by_group(group, groups);
    for (int g = 0; g < groups; ++g) {
        mark[g] = g;
        weight[g] = static_cast<int>(members.of(g).size());
        const std::size_t begin = quotient.adjacent.size();
        for (int u : graph.neighbours(members.of(g).front()))
            if (std::exchange(mark[group[u]], g) != g) quotient.adjacent.push_back(group[u]);
        std::sort(quotient.adjacent.begin() + begin, quotient.adjacent.end());
        quotient.start.push_back(static_cast<int>(quotient.adjacent.size()));
    }
    CompressedGraph result{weighted(std::move(quotient)), std::move(members)};
    result.graph.weight = std::move(weight);
    return result;
}

std::vector<int> expand(const CompressedGraph& compressed, const std::vector<int>& group_order) {
    std::vector<int> order;
    order.reserve(compressed.members.item.size());
    for (int g : group_order)
        order.insert(order.end(), compressed.members.of(g).begin(), compressed.members.of(g).end());
    return order;
}

}  // namespace almesh
