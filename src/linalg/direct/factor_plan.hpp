// Symbolic factorisation of a sparse symmetric matrix: everything about a multifrontal factorisation that is known
// before the values. Columns are vertices of the graph here: the d scalar columns of a node stay together.
//
// The assembly tree (assembly_tree.cpp), whose vertices are the fronts, from the graph alone. Elimination tree: Liu's
// algorithm with path compression. Column counts: from the leaves of the row subtrees, in nearly O(edges), so that the
// size of a factor that cannot fit is known at once. Supernodes: fundamental ones, then merged with their parents where
// that stores few zeros (Liu, SIAM J. Matrix Anal. Appl. 11, 1990; Davis, Direct Methods for Sparse Linear Systems,
// 2006, chapter 4).
//
// The plan (factor_plan.cpp): the front entry that each block of A is added to, the rows of the parent front that each
// update matrix is added to, all places in memory, and the independent subtrees. The tree is cut into subtrees, each
// worked on by one thread, single fronts above them, each worked on by one thread as soon as its children are done, and
// the top above these, where all threads share the work inside each front. The update matrices of the roots of subtrees
// and of single fronts change threads and have a place of their own. The others live on two stacks, those of fronts at
// even and at odd depth: the children are popped from one while their parent's is pushed on the other, so none is ever
// moved. Each thread has two stacks for its subtrees, the top has two.
#pragma once
#include <cstddef>
#include <vector>

#include "linalg/ordering/graph.hpp"

namespace almesh {

struct AssemblyTree {
    std::vector<int> order;               // order[new] = old, a postorder of the tree
    std::vector<int> first;               // fronts + 1: front f eliminates the columns first[f] .. first[f+1]-1
    std::vector<int> parent;              // front, -1 for a root; parent[f] > f
    Groups children;                      // of each front, ascending; of fronts(): the roots
    std::vector<std::size_t> row_start;   // fronts + 1 offsets into rows
    std::vector<int> rows;                // rows of front f below its own columns, ascending
    std::vector<int> column_count;        // entries of each column of L, diagonal included, merging left out

    int fronts() const { return static_cast<int>(parent.size()); }
    int columns(int f) const { return first[f + 1] - first[f]; }
    int update_rows(int f) const { return static_cast<int>(row_start[f + 1] - row_start[f]); }
};

// order[new] = old: an ordering to start from; the tree's own order is an equivalent one with the same fill.
// d: scalar unknowns per vertex, which decides how far merging pays.
AssemblyTree build_assembly_tree(const Graph& graph, const std::vector<int>& order, int d);

// parent[j] of column j (new numbering), -1 for a root: the row of the first entry of L below the diagonal.
std::vector<int> elimination_tree(const Graph& graph, const std::vector<int>& order);

// Block `block` of A is added to (row, column) of a front, in nodes.
struct FrontEntry {
    int block, row, column;
};

struct FrontRange {
    int begin, end;
};

struct FactorPlan {
    AssemblyTree tree;
    int d = 1;
    std::vector<int> relative_index;          // like tree.rows: the row's place in the parent front, in nodes
    std::vector<std::size_t> entry_start;     // fronts + 1 offsets into entries
    std::vector<FrontEntry> entries;
    std::vector<FrontRange> subtrees;         // costliest first
    std::vector<int> single;                  // fronts above the subtrees, children before parents
    std::vector<int> top;                     // fronts above those, children before parents
    std::vector<std::vector<int>> levels;     // all fronts above the subtrees by their depth, the deepest first

    // Memory, in doubles.
    std::vector<std::size_t> panel_at;        // fronts + 1 offsets into the factor
    std::vector<std::size_t> update_at;       // offset of the update matrix in the shared or a thread's own memory
    std::vector<char> update_shared;          // 1: in the shared memory
    std::size_t shared_size = 0, thread_size = 0;

    double factor_entries = 0;                // scalar entries of L, without zeros stored for larger fronts
    double flops = 0;                         // additions and multiplications for those entries

    int rows(int f) const { return (tree.columns(f) + tree.update_rows(f)) * d; }  // m of the front
    int pivots(int f) const { return tree.columns(f) * d; }                        // k of the front
    double bytes(int threads) const;          // all of the above and the factor
};

// pattern: symmetric, both triangles. order[new] = old: the fill-reducing ordering of its graph.
FactorPlan plan_factorisation(const BlockCsr& pattern, const Graph& graph, const std::vector<int>& order);

}  // namespace almesh
