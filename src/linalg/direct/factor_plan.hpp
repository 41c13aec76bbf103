// Everything about a multifrontal factorisation that is known before the values: the front entry that each block of A
// is added to, the rows of the parent front that each update matrix is added to, all places in memory, and the
// independent subtrees.
//
// The tree is cut into subtrees, each worked on by one thread, single fronts above them, each worked on by one thread
// as soon as its children are done, and the top above these, where all threads share the work inside each front. The
// update matrices of the roots of subtrees and of single fronts change threads and have a place of their own. The
// others live on two stacks, those of fronts at even and at odd depth: the children are popped from one while their
// parent's is pushed on the other, so none is ever moved. Each thread has two stacks for its subtrees, the top has two.
#pragma once
#include <cstddef>
#include <vector>

#include "linalg/direct/assembly_tree.hpp"

namespace almesh {

struct BlockCsr;

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
