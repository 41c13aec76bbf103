#include "linalg/ordering/hierarchy.hpp"

#include <numeric>
#include <utility>

namespace almesh {

namespace {

constexpr int smallest_coarse = 500;  // vertices; smaller graphs are coarsened anew, which suits their pieces better

}  // namespace

WeightedGraph induced(const WeightedGraph& from, const std::vector<int>& kept, const std::vector<int>& local) {
    WeightedGraph graph;
    graph.start.reserve(kept.size() + 1);
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
    }
    return graph;
}

std::vector<int> numbered(int size, const std::vector<int>& kept) {
    std::vector<int> local(size, -1);
    for (std::size_t k = 0; k < kept.size(); ++k) local[kept[k]] = static_cast<int>(k);
    return local;
}

Hierarchy build_hierarchy(WeightedGraph finest, int steps, std::uint64_t seed) {
    Hierarchy result{std::move(finest), {}};
    for (int step = 0; step < steps; ++step) {
        const WeightedGraph& fine = result.coarsest();
        const long long total = std::accumulate(fine.weight.begin(), fine.weight.end(), 0LL);
        Coarsening next = coarsen(fine, static_cast<int>(2 + total / smallest_coarse), seed + step);
        if (next.graph.size() < smallest_coarse || next.graph.size() > 0.8 * fine.size()) break;
        result.coarser.push_back(std::move(next));
    }
    return result;
}

Hierarchy restrict_to(const Hierarchy& whole, const std::vector<int>& kept) {
    Hierarchy result;
    std::vector<int> fine_kept = kept, local = numbered(whole.finest.size(), kept);
    result.finest = induced(whole.finest, kept, local);
    for (int v : kept) result.finest.weight.push_back(whole.finest.weight[v]);
    for (const Coarsening& from : whole.coarser) {
        std::vector<char> present(from.graph.size(), 0);
        for (int v : fine_kept) present[from.coarse_of[v]] = 1;
        std::vector<int> coarse_kept;
        for (int c = 0; c < from.graph.size(); ++c)
            if (present[c]) coarse_kept.push_back(c);
        if (static_cast<int>(coarse_kept.size()) < smallest_coarse) break;
        local = numbered(from.graph.size(), coarse_kept);
        const WeightedGraph& fine = result.coarsest();
        Coarsening next;
        next.graph = induced(from.graph, coarse_kept, local);
        next.graph.weight.assign(coarse_kept.size(), 0);
        next.coarse_of.reserve(fine_kept.size());
        for (int v : fine_kept) {
            const int c = local[from.coarse_of[v]];
            next.graph.weight[c] += fine.weight[next.coarse_of.size()];
            next.coarse_of.push_back(c);
        }
        result.coarser.push_back(std::move(next));
        fine_kept = std::move(coarse_kept);
    }
    return result;
}

}  // namespace almesh
