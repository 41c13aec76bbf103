// Three bisections of the coarsened graph by vertex separators, whose vertices then join the lighter side; projected
// to the graph, the vertices along the cuts are moved into the separators, greedily.
#include <algorithm>
#include <numeric>

#include "base/parallel.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/ordering/multilevel.hpp"
#include "linalg/ordering/ordering.hpp"

namespace almesh {
namespace {

constexpr int bisections = 3;        // 2^3 domains
constexpr int coarsenings = 3;       // of the graph before it is cut
constexpr int worth_cutting = 1000;  // vertices; smaller graphs stay one domain

// Halves the vertices `piece` recursively; domain[v] of each becomes first, first + 1, ...
void bisect(const WeightedGraph& graph, const std::vector<int>& piece, int depth, int first, std::vector<int>& domain) {
    if (depth == 0) {
        for (int v : piece) domain[v] = first;
        return;
    }
    const Hierarchy own{induced(graph, piece)};
    const std::vector<Part> part = find_separator(own, static_cast<std::uint64_t>(first) + 1);
    long long weight[3] = {0, 0, 0};
    for (std::size_t v = 0; v < piece.size(); ++v) weight[part[v]] += graph.weight[piece[v]];
    const Part lighter = weight[left] < weight[right] ? left : right;
    std::vector<int> side[2];
    for (std::size_t v = 0; v < piece.size(); ++v) side[part[v] == separator ? lighter : part[v]].push_back(piece[v]);
    bisect(graph, side[left], depth - 1, first, domain);
    bisect(graph, side[right], depth - 1, first + (1 << (depth - 1)), domain);
}

// domain[v] of every vertex, by bisection of the coarsened graph.
std::vector<int> domains_of_vertices(const Graph& graph) {
    Coarsening coarse = coarsen(graph, 2 << coarsenings, coarsenings, 0);
    std::vector<int> all(coarse.graph.size()), domain(coarse.graph.size());
    std::iota(all.begin(), all.end(), 0);
    bisect(coarse.graph, all, bisections, 0, domain);
    for (int& v : coarse.coarse_of) v = domain[v];
    return coarse.coarse_of;
}

// Moves vertices with neighbours in other domains into the separators (domain[v] = separators), those with most of them
// first, until no edge joins two domains.
void separate(const Graph& graph, int separators, std::vector<int>& domain) {
    std::vector<int> outside(graph.size(), 0), candidates;  // outside[v]: neighbours in other domains
    for (int v = 0; v < graph.size(); ++v) {
        for (int u : graph.neighbours(v)) outside[v] += domain[u] != domain[v];
        if (outside[v] > 0) candidates.push_back(v);
    }
    std::stable_sort(candidates.begin(), candidates.end(), [&](int a, int b) { return outside[a] > outside[b]; });
    for (int v : candidates)
        for (int u : graph.neighbours(v))
            if (domain[u] != separators && domain[u] != domain[v]) {
                domain[v] = separators;
                break;
            }
}

}  // namespace

RowOrder cut_into_domains(const Graph& graph) {
    if (graph.size() < worth_cutting) return row_order(reverse_cuthill_mckee(graph));
    constexpr int count = 1 << bisections;
    std::vector<int> domain, order;
    const auto cut = [&] {
        domain = domains_of_vertices(graph);
        separate(graph, count, domain);
    };
    parallel_invoke(cut, [&] { order = reverse_cuthill_mckee(graph); });
    std::vector<int> piece[count + 1];  // the separators last
    long long work[count + 1] = {};
    for (int v : order) {
        piece[domain[v]].push_back(v);
        work[domain[v]] += graph.degree(v);
    }
    // Most work first, so that threads that take one domain after the other end at the same time.
    std::vector<int> by_work(count);
    std::iota(by_work.begin(), by_work.end(), 0);
    std::stable_sort(by_work.begin(), by_work.end(), [&](int a, int b) { return work[a] > work[b]; });
    by_work.push_back(count);
    order.clear();
    std::vector<int> start;
    for (int k : by_work) {
        start.push_back(static_cast<int>(order.size()));
        order.insert(order.end(), piece[k].begin(), piece[k].end());
    }
    return row_order(std::move(order), std::move(start));
}

}  // namespace almesh
