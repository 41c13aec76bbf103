#include "linalg/ordering/graph.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

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

std::vector<int> inverse(const std::vector<int>& order) {
    std::vector<int> position(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) position[order[k]] = static_cast<int>(k);
    return position;
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
    CompressedGraph result;
    result.weight.assign(groups, 0);
    for (int g : group) ++result.weight[g];
    result.member_start.assign(groups + 1, 0);
    std::partial_sum(result.weight.begin(), result.weight.end(), result.member_start.begin() + 1);
    std::vector<int> next(result.member_start.begin(), result.member_start.end() - 1), mark(groups, -1);
    result.member.resize(group.size());
    for (int v = 0; v < graph.size(); ++v) result.member[next[group[v]]++] = v;
    for (int g = 0; g < groups; ++g) {
        const int v = result.member[result.member_start[g]];
        mark[g] = g;
        const std::size_t begin = result.graph.adjacent.size();
        for (int u : graph.neighbours(v)) {
            const int h = group[u];
            if (mark[h] != g) result.graph.adjacent.push_back(h);
            mark[h] = g;
        }
        std::sort(result.graph.adjacent.begin() + begin, result.graph.adjacent.end());
        result.graph.start.push_back(static_cast<int>(result.graph.adjacent.size()));
    }
    return result;
}

std::vector<int> expand(const CompressedGraph& compressed, const std::vector<int>& group_order) {
    std::vector<int> order;
    order.reserve(compressed.member.size());
    const auto member = compressed.member.begin();
    for (int g : group_order)
        order.insert(order.end(), member + compressed.member_start[g], member + compressed.member_start[g + 1]);
    return order;
}

}  // namespace almesh
