#include "linalg/ordering/domains.hpp"

#include <algorithm>
#include <numeric>

#include "base/parallel.hpp"
#include "linalg/ordering/hierarchy.hpp"
#include "linalg/ordering/separator.hpp"

namespace almesh {

namespace {

constexpr int bisections = 3;        // 2^3 domains
constexpr int coarsenings = 3;       // halvings of the graph before it is cut
constexpr int worth_cutting = 4000;  // vertices; smaller graphs stay one domain

WeightedGraph weighted(const Graph& graph) {
    return {graph.start, graph.adjacent, std::vector<int>(graph.adjacent.size(), 1), std::vector<int>(graph.size(), 1)};
}

// The part of the graph inside `piece`.
WeightedGraph part_of(const WeightedGraph& graph, const std::vector<int>& piece) {
    WeightedGraph part = induced(graph, piece, numbered(graph.size(), piece));
    for (int v : piece) part.weight.push_back(graph.weight[v]);
    return part;
}

// Halves the piece again and again; domain[v] of its vertices becomes first, first + 1, ...
void bisect(const WeightedGraph& graph, const std::vector<int>& piece, int depth, int first, std::vector<int>& domain) {
    if (depth == 0) {
        for (int v : piece) domain[v] = first;
        return;
    }
    const WeightedGraph own = part_of(graph, piece);
    const std::vector<Part> part = find_separator(own, static_cast<std::uint64_t>(first) + 1);
    long long weight[3] = {0, 0, 0};
    for (int v = 0; v < own.size(); ++v) weight[part[v]] += own.weight[v];
    const Part lighter = weight[left] < weight[right] ? left : right;
    std::vector<int> side[2];
    for (int v = 0; v < own.size(); ++v) side[part[v] == separator ? lighter : part[v]].push_back(piece[v]);
    bisect(graph, side[left], depth - 1, first, domain);
    bisect(graph, side[right], depth - 1, first + (1 << (depth - 1)), domain);
}

// domain[v] of every vertex: the halves of halves of the coarsened graph.
std::vector<int> domains_of_vertices(const Graph& graph) {
    std::vector<int> domain(graph.size(), 0), coarse_of(graph.size());
    if (graph.size() < worth_cutting) return domain;
    WeightedGraph coarse = weighted(graph);
    std::iota(coarse_of.begin(), coarse_of.end(), 0);
    for (int level = 0; level < coarsenings; ++level) {
        Coarsening next = coarsen(coarse, 2 << coarsenings, level);
        for (int& v : coarse_of) v = next.coarse_of[v];
        coarse = std::move(next.graph);
    }
    std::vector<int> all(coarse.size()), coarse_domain(coarse.size());
    std::iota(all.begin(), all.end(), 0);
    bisect(coarse, all, bisections, 0, coarse_domain);
    for (int v = 0; v < graph.size(); ++v) domain[v] = coarse_domain[coarse_of[v]];
    return domain;
}

// Takes vertices that see other domains out of theirs (domain[v] = separators), those that see most of them first,
// until no edge joins two domains.
void separate(const Graph& graph, int separators, std::vector<int>& domain) {
    std::vector<int> seen(graph.size(), 0), candidates;  // seen[v]: neighbours in other domains
    for (int v = 0; v < graph.size(); ++v) {
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) seen[v] += domain[graph.adjacent[k]] != domain[v];
        if (seen[v] > 0) candidates.push_back(v);
    }
    std::stable_sort(candidates.begin(), candidates.end(), [&](int a, int b) { return seen[a] > seen[b]; });
    for (int v : candidates) {
        const int* const u = graph.adjacent.data() + graph.start[v];
        if (std::any_of(u, u + graph.degree(v),
                        [&](int w) { return domain[w] != separators && domain[w] != domain[v]; }))
            domain[v] = separators;
    }
}

}  // namespace

Domains cut_into_domains(const Graph& graph) {
    const int count = graph.size() < worth_cutting ? 1 : 1 << bisections;
    std::vector<int> domain, order;
    const auto cut = [&] {
        domain = domains_of_vertices(graph);
        separate(graph, count, domain);
    };
    parallel_invoke(cut, [&] { order = reverse_cuthill_mckee(graph); });
    std::vector<std::vector<int>> pieces(count + 1);
    for (int v : order) pieces[domain[v]].push_back(v);
    // Those with most work first, so that threads that take one after the other end at the same time.
    std::vector<long long> work(count, 0);
    for (int v = 0; v < graph.size(); ++v)
        if (domain[v] < count) work[domain[v]] += graph.degree(v);
    std::vector<int> by_work(count);
    std::iota(by_work.begin(), by_work.end(), 0);
    std::stable_sort(by_work.begin(), by_work.end(), [&](int a, int b) { return work[a] > work[b]; });
    by_work.push_back(count);  // the separators
    Domains domains;
    for (int k : by_work) {
        domains.start.push_back(static_cast<int>(domains.order.size()));
        domains.order.insert(domains.order.end(), pieces[k].begin(), pieces[k].end());
    }
    return domains;
}

}  // namespace almesh
