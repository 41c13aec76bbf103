// The undirected graph behind a symmetric sparsity pattern, and permutations of its vertices.
//
// A permutation is a list `order` with order[new] = old; inverse(order)[old] = new.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

// Neighbours of vertex v: adjacent[start[v] .. start[v+1]), ascending, without v itself; every edge stands twice.
struct Graph {
    std::vector<int> start{0};
    std::vector<int> adjacent;

    int size() const { return static_cast<int>(start.size()) - 1; }
    int degree(int v) const { return start[v + 1] - start[v]; }
};

// One vertex per block row of A, whose pattern is symmetric.
Graph graph_of(const BlockCsr& A);

std::vector<int> inverse(const std::vector<int>& order);
bool is_permutation(const std::vector<int>& order);

// Groups of vertices with the same closed neighbourhood, such as the inner nodes of a cell of high degree. They can be
// eliminated one after the other without any fill between the groups changing, so orderings work on the groups.
struct CompressedGraph {
    Graph graph;                         // one vertex per group
    std::vector<int> weight;             // vertices in each group
    std::vector<int> member_start{0};    // groups + 1 offsets into member
    std::vector<int> member;             // vertices of the groups, ascending within a group
};
CompressedGraph compress(const Graph& graph);

// The vertices in the order of their groups.
std::vector<int> expand(const CompressedGraph& compressed, const std::vector<int>& group_order);

// Reverse Cuthill-McKee: a breadth-first numbering from an end vertex of each component, neighbours by ascending
// degree, reversed. Keeps neighbours close in number, which makes ILU(0) accurate (George & Liu, Computer Solution
// of Large Sparse Positive Definite Systems, 1981, ch. 4). Returns order[new] = old. O(edges log degree).
std::vector<int> reverse_cuthill_mckee(const Graph& graph);

// The pattern of A with rows and columns renumbered, its values anything; source[k]: the block of A that block k comes
// from.
BlockCsr permuted_pattern(const BlockCsr& A, const std::vector<int>& order, std::vector<int>& source);

}  // namespace almesh
