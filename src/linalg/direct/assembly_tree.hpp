// Symbolic factorisation of a sparse symmetric matrix, from its graph alone: elimination tree, column counts of L,
// supernodes, and the assembly tree whose vertices are the fronts of the multifrontal method.
//
// Elimination tree: Liu's algorithm with path compression. Column counts: from the leaves of the row subtrees, in
// nearly O(edges), so that the size of a factor that cannot fit is known at once. Supernodes: fundamental ones, then
// merged with their parents where that stores few zeros (Liu, SIAM J. Matrix Anal. Appl. 11, 1990; Davis, Direct
// Methods for Sparse Linear Systems, 2006, chapter 4).
// Columns are vertices of the graph here: the d scalar columns of a node stay together.
#pragma once
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace almesh {

struct Graph;

// The children of every vertex of a forest, ascending or sorted. The roots count as children of vertex `size`.
class Children {
public:
    Children() = default;
    explicit Children(const std::vector<int>& parent);  // -1 for a root

    std::span<const int> of(int v) const { return {child_.data() + start_[v], child_.data() + start_[v + 1]}; }
    std::span<const int> roots() const { return of(static_cast<int>(start_.size()) - 2); }

    template <class Less>
    void sort(int v, const Less& less) {
        std::stable_sort(child_.begin() + start_[v], child_.begin() + start_[v + 1], less);
    }

private:
    std::vector<int> start_{0, 0}, child_;
};

struct AssemblyTree {
    std::vector<int> order;               // order[new] = old, a postorder of the tree
    std::vector<int> first;               // fronts + 1: front f eliminates the columns first[f] .. first[f+1]-1
    std::vector<int> parent;              // front, -1 for a root; parent[f] > f
    Children children;                    // fronts
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

}  // namespace almesh
