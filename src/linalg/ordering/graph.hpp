// The undirected graph behind a symmetric sparsity pattern, and permutations of its vertices.
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

// One vertex per block row of A, whose pattern is symmetric.
Graph graph_of(const BlockCsr& A);

std::vector<int> inverse(const std::vector<int>& order);

// Groups of vertices with the same closed neighbourhood (indistinguishable vertices), such as the inner nodes of a cell
// of high degree. Eliminating a group at once leaves the fill as it is, so orderings work on the groups.
struct CompressedGraph {
    Graph graph;                         // one vertex per group
    std::vector<int> weight;             // vertices in each group
    std::vector<int> member_start{0};    // groups + 1 offsets into member
    std::vector<int> member;             // vertices of the groups, ascending within a group
};
CompressedGraph compress(const Graph& graph);

// The vertices in the order of their groups.
std::vector<int> expand(const CompressedGraph& compressed, const std::vector<int>& group_order);

}  // namespace almesh
