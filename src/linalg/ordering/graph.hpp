// The undirected graph of a symmetric sparsity pattern, permutations of its vertices, and groups of them.
//
// A permutation is a list `order` with order[new] = old; inverse(order)[old] = new.
#pragma once
#include <span>
#include <vector>

namespace almesh {

struct BlockCsr;

// Neighbours of vertex v: adjacent[start[v] .. start[v+1]), ascending, without v itself; every edge is stored twice.
struct Graph {
    std::vector<int> start{0};
    std::vector<int> adjacent;

    int size() const { return static_cast<int>(start.size()) - 1; }
    int degree(int v) const { return start[v + 1] - start[v]; }
    std::span<const int> neighbours(int v) const {
        return {adjacent.data() + start[v], adjacent.data() + start[v + 1]};
    }
};

// With weights: a vertex represents `weight` vertices of the finest graph, an edge `edge_weight` of its edges.
struct WeightedGraph : Graph {
    std::vector<int> edge_weight;  // one per entry of adjacent
    std::vector<int> weight;       // one per vertex
};

// One vertex per block row of A, whose pattern is symmetric.
Graph graph_of(const BlockCsr& A);

// All weights 1.
WeightedGraph weighted(Graph graph);

// The vertices `kept` of a graph, in this order, and the edges among them.
WeightedGraph induced(const WeightedGraph& graph, const std::vector<int>& kept);

std::vector<int> inverse(const std::vector<int>& order);

// Items in groups: those of group g are item[start[g] .. start[g+1]).
struct Groups {
    std::vector<int> start{0}, item;

    std::span<const int> of(int g) const { return {item.data() + start[g], item.data() + start[g + 1]}; }
};

// The items 0 .. group.size()-1 by their group in [0, groups), ascending within one: a counting sort.
Groups sorted_by_group(const std::vector<int>& group, int groups);

// Groups of vertices with the same closed neighbourhood (indistinguishable vertices), such as the inner nodes of a cell
// of high degree. Eliminating a group at once leaves the fill as it is, so orderings work on the groups.
struct CompressedGraph {
    WeightedGraph graph;  // a vertex per group, weight: vertices in it; all edge weights 1
    Groups members;       // vertices of the groups
};
CompressedGraph compress(const Graph& graph);

// The vertices in the order of their groups.
std::vector<int> expand(const CompressedGraph& compressed, const std::vector<int>& group_order);

}  // namespace almesh
