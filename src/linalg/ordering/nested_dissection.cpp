// Recursive bisection by multilevel vertex separators; the leaves by minimum degree. Pieces of the
// graph are copied out with their part of the coarser graphs, and large ones are tasks of their own.
#include "linalg/ordering/ordering.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "linalg/ordering/multilevel.hpp"

namespace almesh {
namespace {

constexpr int leaf_size = 150;        // groups ordered by minimum degree
constexpr int shared_steps = 3;       // of coarsening, made once for all pieces
constexpr int largest_leaf = 3000;    // beyond this, a piece that cannot be split keeps its order
[[maybe_unused]] constexpr int task_size = 2000;  // pieces that are worth a task of their own

struct Dissection {
    const WeightedGraph& all;
    std::vector<int>& order;        // groups; every piece fills its own range
    std::vector<char> numbered;     // group is in a separator: eliminated after all that is still to be ordered
};

// A piece of the graph: its own copy of the edges inside it, and its groups in the whole graph.
struct Piece {
    Hierarchy graphs;
    std::vector<int> group;
};

Piece extract(const Piece& from, const std::vector<Part>& part, Part side) {
    std::vector<int> kept, group;
    for (std::size_t v = 0; v < part.size(); ++v)
        if (part[v] == side) {
            kept.push_back(static_cast<int>(v));
            group.push_back(from.group[v]);
        }
    return {restrict_to(from.graphs, kept), std::move(group)};
}

// Minimum degree on the piece with the separators next to it as halo.
void order_leaf(const Dissection& dissection, const Piece& piece, int first) {
    SmallGraph small;
    const int n = small.size = small.eliminable = static_cast<int>(piece.group.size());
    const WeightedGraph& own = piece.graphs.finest;
    small.weight = own.weight;
    std::vector<std::pair<int, int>> outside;  // (group in the halo, vertex of the piece)
    for (int v = 0; v < n; ++v) {
        for (int u : own.neighbours(v)) small.edges.push_back({v, u});
        for (int h : dissection.all.neighbours(piece.group[v]))
            if (dissection.numbered[h]) outside.push_back({h, v});
    }
    std::sort(outside.begin(), outside.end());
    for (std::size_t k = 0; k < outside.size(); ++k) {
        if (k == 0 || outside[k].first != outside[k - 1].first) {
            ++small.size;
            small.weight.push_back(dissection.all.weight[outside[k].first]);
        }
        small.edges.push_back({small.size - 1, outside[k].second});
    }
    for (int v : minimum_degree(small)) dissection.order[first++] = piece.group[v];
}

void dissect(Dissection& dissection, const Piece& piece, int first) {
    const int n = static_cast<int>(piece.group.size());
    if (n <= leaf_size) return order_leaf(dissection, piece, first);
    const std::vector<Part> part = find_separator(piece.graphs, static_cast<std::uint64_t>(first) * 7919 + n);
    int count[3] = {0, 0, 0};
    for (Part p : part) ++count[p];
    if (count[left] == 0 || count[right] == 0) {
        if (n <= largest_leaf) return order_leaf(dissection, piece, first);
        std::copy(piece.group.begin(), piece.group.end(), dissection.order.begin() + first);
        return;
    }
    int last = first + n;
    for (int v = n - 1; v >= 0; --v)
        if (part[v] == separator) {
            dissection.order[--last] = piece.group[v];
            dissection.numbered[piece.group[v]] = 1;
        }
#pragma omp task shared(dissection, piece, part) if (count[left] > task_size)
    dissect(dissection, extract(piece, part, left), first);
    dissect(dissection, extract(piece, part, right), first + count[left]);
#pragma omp taskwait
}

}  // namespace

std::vector<int> nested_dissection(const Graph& graph) {
    const CompressedGraph compressed = compress(graph);
    const int groups = compressed.graph.size();
    std::vector<int> group_order(groups);
    Dissection dissection{compressed.graph, group_order, std::vector<char>(groups, 0)};
    Piece whole{build_hierarchy(compressed.graph, shared_steps, groups), std::vector<int>(groups)};
    std::iota(whole.group.begin(), whole.group.end(), 0);
    in_team(groups > task_size, [&] {
#pragma omp single
        dissect(dissection, whole, 0);
    });
    return expand(compressed, group_order);
}

}  // namespace almesh
