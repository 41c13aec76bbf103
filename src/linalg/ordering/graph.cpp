#include "linalg/ordering/graph.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "base/parallel.hpp"

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

bool is_permutation(const std::vector<int>& order) {
    std::vector<char> seen(order.size(), 0);
    for (int v : order) {
        if (v < 0 || v >= static_cast<int>(order.size()) || seen[v]) return false;
        seen[v] = 1;
    }
    return true;
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
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) hash[v] += scramble(graph.adjacent[k]);
    }
    std::vector<int> group(n, -1), mark(n, -1);
    groups = 0;
    for (int v = 0; v < n; ++v) {
        if (group[v] >= 0) continue;
        group[v] = groups++;
        mark[v] = v;
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) mark[graph.adjacent[k]] = v;
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
            const int u = graph.adjacent[k];
            if (group[u] >= 0 || hash[u] != hash[v] || graph.degree(u) != graph.degree(v)) continue;
            const auto list = graph.adjacent.begin();
            const bool equal = std::all_of(list + graph.start[u], list + graph.start[u + 1],
                                           [&](int w) { return mark[w] == v; });
            if (equal) group[u] = group[v];
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
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
            const int h = group[graph.adjacent[k]];
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

namespace {

// Appends the component of `root` to `order` in Cuthill-McKee order and returns how many levels it has; mark[v] =
// `stamp` for the vertices reached.
int breadth_first(const Graph& graph, int root, int stamp, std::vector<int>& mark, std::vector<int>& order) {
    std::size_t begin = order.size(), end = begin + 1;
    order.push_back(root);
    mark[root] = stamp;
    int levels = 0;
    for (; begin < order.size(); ++levels) {
        end = order.size();
        for (; begin < end; ++begin) {
            const int v = order[begin];
            const std::size_t first = order.size();
            for (int k = graph.start[v]; k < graph.start[v + 1]; ++k)
                if (mark[graph.adjacent[k]] != stamp) {
                    mark[graph.adjacent[k]] = stamp;
                    order.push_back(graph.adjacent[k]);
                }
            std::stable_sort(order.begin() + first, order.end(),
                             [&](int a, int b) { return graph.degree(a) < graph.degree(b); });
        }
    }
    return levels;
}

}  // namespace

std::vector<int> reverse_cuthill_mckee(const Graph& graph) {
    std::vector<int> order, mark(graph.size(), -1);
    order.reserve(graph.size());
    std::vector<char> done(graph.size(), 0);
    int stamp = 0;
    for (int v = 0; v < graph.size(); ++v) {
        if (done[v]) continue;
        // A last vertex of a longest breadth-first search is a good end of the component (George & Liu's
        // pseudo-peripheral vertex): start there.
        const std::size_t begin = order.size();
        int root = v, levels = 0;
        for (;;) {
            const int deeper = breadth_first(graph, root, stamp++, mark, order);
            if (deeper <= levels) break;
            levels = deeper;
            root = order.back();
            order.resize(begin);
        }
        for (std::size_t k = begin; k < order.size(); ++k) done[order[k]] = 1;
    }
    std::reverse(order.begin(), order.end());
    return order;
}

BlockCsr permuted_pattern(const BlockCsr& A, const std::vector<int>& order, std::vector<int>& source) {
    const std::vector<int> position = inverse(order);
    BlockCsr B;
    B.n = A.n;
    B.d = A.d;
    B.row.assign(1, 0);
    for (int v : order) B.row.push_back(B.row.back() + A.row[v + 1] - A.row[v]);
    source.resize(A.col.size());
    B.col.resize(A.col.size());
    parallel_for(A.n, [&](int i) {
        const auto begin = source.begin() + B.row[i], end = source.begin() + B.row[i + 1];
        std::iota(begin, end, A.row[order[i]]);
        std::sort(begin, end, [&](int a, int b) { return position[A.col[a]] < position[A.col[b]]; });
        std::transform(begin, end, B.col.begin() + B.row[i], [&](int k) { return position[A.col[k]]; });
    }, 500);
    B.value.resize(A.value.size());
    return B;
}

}  // namespace almesh
