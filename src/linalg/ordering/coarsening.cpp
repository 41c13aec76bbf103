// Every vertex in turn joins the group at the other end of its heaviest edge, then the groups are contracted: edges
// between them are added up.
#include "linalg/ordering/multilevel.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

#include "base/parallel.hpp"

namespace almesh {
namespace {

constexpr int largest_group = 3;  // vertices merged into one
constexpr int smallest_coarse = 500;  // vertices; smaller graphs of a hierarchy are coarsened anew, piece by piece
constexpr int shuffled = 64;      // vertices shuffled among themselves: near ones stay near in memory

// Large graphs are worked on in blocks, so many whatever the number of threads.
int blocks_of(int n) { return n < 40000 ? 1 : 8; }

// Blocks begin where the shuffled pieces do.
int block_begin(int n, int blocks, int b) {
    return b == blocks ? n : static_cast<int>(static_cast<long long>(n) * b / blocks / shuffled * shuffled);
}

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

// Groups while they form. leader[v]: a vertex that represents the group of v, -1 if it has none yet; members and
// weight are those of the group where v is a leader.
struct Merging {
    std::vector<int> leader, members, weight;
};

// Vertex v joins the group at the other end of its heaviest edge, the smallest group among equals; only vertices of
// [begin, end) come into question.
void join(const WeightedGraph& graph, int v, int begin, int end, int heaviest, Merging& groups) {
    int best = v, best_weight = 0;
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
        const int u = graph.adjacent[k];
        if (graph.edge_weight[k] < best_weight || u < begin || u >= end) continue;
        const int group = groups.leader[u] < 0 ? u : groups.leader[u];
        if (graph.edge_weight[k] == best_weight && groups.members[group] >= groups.members[best]) continue;
        if (groups.members[group] == largest_group || groups.weight[group] + graph.weight[v] > heaviest) continue;
        best = group;
        best_weight = graph.edge_weight[k];
    }
    groups.leader[best] = best;
    if (best == v) return;
    groups.leader[v] = best;
    ++groups.members[best];
    groups.weight[best] += graph.weight[v];
}

// Blocks of vertices choose independently among themselves, those left alone at their edges from all others.
std::vector<int> find_groups(const WeightedGraph& graph, int heaviest, std::uint64_t seed) {
    const int n = graph.size(), blocks = blocks_of(n);
    const std::vector<int> order = visiting_order(n, seed);
    Merging groups{std::vector<int>(n, -1), std::vector<int>(n, 1), graph.weight};
    parallel_tasks(blocks, true, [&](int b) {
        const int begin = block_begin(n, blocks, b), end = block_begin(n, blocks, b + 1);
        for (int i = begin; i < end; ++i)
            if (groups.leader[order[i]] < 0) join(graph, order[i], begin, end, heaviest, groups);
    });
    for (int i = 0; i < n && blocks > 1; ++i)
        if (const int v = order[i]; groups.leader[v] == v && groups.members[v] == 1)
            join(graph, v, 0, n, heaviest, groups);
    return std::move(groups.leader);
}

// Coarse vertices [begin, end). place[h]: where this vertex's edge to h stands, if not below its first edge.
WeightedGraph contract(const WeightedGraph& fine, const std::vector<int>& coarse_of, const Groups& members, int begin,
                       int end) {
    const std::size_t groups = members.start.size() - 1;
    std::vector<int> place(groups, -1);
    WeightedGraph coarse;
    const std::size_t edges = fine.adjacent.size() / std::max<std::size_t>(1, groups) * (end - begin);
    coarse.start.reserve(end - begin + 1);
    coarse.weight.assign(end - begin, 0);
    coarse.adjacent.reserve(edges);
    coarse.edge_weight.reserve(edges);
    for (int c = begin; c < end; ++c) {
        const int first_edge = static_cast<int>(coarse.adjacent.size());
        for (int v : members.of(c)) {
            coarse.weight[c - begin] += fine.weight[v];
            for (int k = fine.start[v]; k < fine.start[v + 1]; ++k) {
                const int h = coarse_of[fine.adjacent[k]];
                if (h == c) continue;
                if (place[h] < first_edge) {
                    place[h] = static_cast<int>(coarse.adjacent.size());
                    coarse.adjacent.push_back(h);
                    coarse.edge_weight.push_back(0);
                }
                coarse.edge_weight[place[h]] += fine.edge_weight[k];
            }
        }
        coarse.start.push_back(static_cast<int>(coarse.adjacent.size()));
    }
    return coarse;
}

// Appends the vertices of a piece, whose edges name vertices of the whole graph.
void append(const WeightedGraph& piece, WeightedGraph& whole) {
    const int edges = static_cast<int>(whole.adjacent.size());
    for (int v = 1; v <= piece.size(); ++v) whole.start.push_back(edges + piece.start[v]);
    whole.adjacent.insert(whole.adjacent.end(), piece.adjacent.begin(), piece.adjacent.end());
    whole.edge_weight.insert(whole.edge_weight.end(), piece.edge_weight.begin(), piece.edge_weight.end());
    whole.weight.insert(whole.weight.end(), piece.weight.begin(), piece.weight.end());
}

}  // namespace

Coarsening coarsen(const WeightedGraph& graph, int heaviest, std::uint64_t seed) {
    const std::vector<int> leader = find_groups(graph, heaviest, seed);
    Coarsening result{{}, std::vector<int>(graph.size(), -1)};
    int groups = 0;  // numbered by their first vertices
    for (int v = 0; v < graph.size(); ++v) {
        int& c = result.coarse_of[leader[v]];
        if (c < 0) c = groups++;
        result.coarse_of[v] = c;
    }
    const Groups members = sorted_by_group(result.coarse_of, groups);
    const int blocks = blocks_of(groups);
    std::vector<WeightedGraph> pieces(blocks);
    parallel_tasks(blocks, true, [&](int b) {
        pieces[b] = contract(graph, result.coarse_of, members, block_begin(groups, blocks, b),
                             block_begin(groups, blocks, b + 1));
    });
    result.graph = std::move(pieces[0]);
    for (int b = 1; b < blocks; ++b) append(pieces[b], result.graph);
    return result;
}

Coarsening coarsen(const Graph& graph, int heaviest, int levels, int enough) {
    Coarsening result{weighted(graph), std::vector<int>(graph.size())};
    std::iota(result.coarse_of.begin(), result.coarse_of.end(), 0);
    for (int level = 0; level < levels && result.graph.size() > enough; ++level) {
        Coarsening next = coarsen(result.graph, heaviest, level);
        if (next.graph.size() == result.graph.size()) break;
        for (int& v : result.coarse_of) v = next.coarse_of[v];
        result.graph = std::move(next.graph);
    }
    return result;
}

Hierarchy build_hierarchy(WeightedGraph finest, int steps, std::uint64_t seed) {
    Hierarchy result{std::move(finest)};
    for (int step = 0; step < steps && result.coarsest().size() >= smallest_coarse; ++step) {
        const WeightedGraph& fine = result.coarsest();
        const long long total = std::accumulate(fine.weight.begin(), fine.weight.end(), 0LL);
        Coarsening next = coarsen(fine, static_cast<int>(2 + total / smallest_coarse), seed + step);
        if (next.graph.size() < smallest_coarse || next.graph.size() > 0.8 * fine.size()) break;
        result.coarser.push_back(std::move(next));
    }
    return result;
}

Hierarchy restrict_to(const Hierarchy& whole, const std::vector<int>& kept) {
    Hierarchy result{induced(whole.finest, kept)};
    std::vector<int> fine_kept = kept;
    for (const Coarsening& from : whole.coarser) {
        std::vector<int> coarse_kept, local(from.graph.size(), -1);
        for (int v : fine_kept) local[from.coarse_of[v]] = 0;
        for (int c = 0; c < from.graph.size(); ++c)
            if (local[c] == 0) {
                local[c] = static_cast<int>(coarse_kept.size());
                coarse_kept.push_back(c);
            }
        if (static_cast<int>(coarse_kept.size()) < smallest_coarse) break;
        const WeightedGraph& fine = result.coarsest();
        Coarsening next{induced(from.graph, coarse_kept), {}};
        next.graph.weight.assign(coarse_kept.size(), 0);  // some of what a vertex stood for may have gone
        for (std::size_t v = 0; v < fine_kept.size(); ++v) {
            next.coarse_of.push_back(local[from.coarse_of[fine_kept[v]]]);
            next.graph.weight[next.coarse_of[v]] += fine.weight[v];
        }
        result.coarser.push_back(std::move(next));
        fine_kept = std::move(coarse_kept);
    }
    return result;
}

}  // namespace almesh
