// Postorder of the elimination tree, column counts, supernodes, merged supernodes (fronts), postorder of the fronts
// that needs least memory, rows of each front.
#include <algorithm>
#include <numeric>

#include "linalg/direct/factor_plan.hpp"

namespace almesh {
namespace {

// The children of every vertex of a forest, ascending; parent: -1 for a root. Roots count as children of vertex n.
Groups children_of(std::vector<int> parent) {
    const int n = static_cast<int>(parent.size());
    std::replace(parent.begin(), parent.end(), -1, n);
    return sorted_by_group(parent, n + 1);
}

// Vertices of a forest, children before parents and subtrees together, siblings in the order of their list.
std::vector<int> postorder(const Groups& children) {
    const auto roots = children.of(static_cast<int>(children.item.size()));
    std::vector<int> order, stack(roots.begin(), roots.end());
    while (!stack.empty()) {  // a preorder in which the last sibling comes first is a postorder reversed
        const int v = stack.back();
        stack.pop_back();
        order.push_back(v);
        stack.insert(stack.end(), children.of(v).begin(), children.of(v).end());
    }
    std::reverse(order.begin(), order.end());
    return order;
}

// Sorts the children of v by a key, the largest first.
template <class Key>
void sort_children(Groups& children, int v, const Key& key) {
    std::stable_sort(children.item.begin() + children.start[v], children.item.begin() + children.start[v + 1],
                     [&](int a, int b) { return key(a) > key(b); });
}

// Root of the tree that vertex v has been joined to so far, with path halving.
int find_root(std::vector<int>& ancestor, int v) {
    while (ancestor[v] != v) v = ancestor[v] = ancestor[ancestor[v]];
    return v;
}

// Entries of each column of L. Column j has one for every row i whose row subtree, the paths from the entries of row i
// of A up to i, contains j. Each subtree is counted as +1 at its leaves and -1 where two paths meet, then summed up the
// tree (Gilbert, Ng & Peyton, SIAM J. Matrix Anal. Appl. 15, 1994). The columns are in postorder, so j is a new leaf
// of row i if no earlier one lies below it, and two paths meet where j's predecessor has been joined to.
std::vector<int> count_columns(const Graph& graph, const std::vector<int>& order, const std::vector<int>& parent) {
    const int n = graph.size();
    const std::vector<int> position = inverse(order);
    std::vector<int> first(n), count(n, 0), ancestor(n), last_leaf(n, -1);  // first: lowest vertex of the subtree
    std::iota(first.begin(), first.end(), 0);
    std::iota(ancestor.begin(), ancestor.end(), 0);
    for (int j = 0; j < n; ++j) {
        if (first[j] == j) ++count[j];
        if (const int p = parent[j]; p >= 0) {
            first[p] = std::min(first[p], first[j]);
            --count[p];
        }
        for (int u : graph.neighbours(order[j])) {
            const int i = position[u], leaf = i > j ? last_leaf[i] : j;
            if (leaf >= first[j]) continue;
            ++count[j];
            if (leaf >= 0) --count[find_root(ancestor, leaf)];
            last_leaf[i] = j;
        }
        if (parent[j] >= 0) ancestor[j] = parent[j];
    }
    for (int j = 0; j < n; ++j)
        if (parent[j] >= 0) count[parent[j]] += count[j];
    return count;
}

// Supernodes while they are merged: `columns` pivots, `rows` in all, and how many of their entries are known zeros.
struct Supernode {
    int parent = -1;
    long long columns = 0, rows = 0, zeros = 0;
    long long entries() const { return columns * rows - columns * (columns - 1) / 2; }
};

Groups children_of(const std::vector<Supernode>& supernodes) {
    std::vector<int> parent;
    for (const Supernode& s : supernodes) parent.push_back(s.parent);
    return children_of(std::move(parent));
}

// Fundamental supernodes: runs of columns with nested structures, each the only child of the next.
// supernode_of[j] on return.
std::vector<Supernode> find_supernodes(const std::vector<int>& parent, const std::vector<int>& count,
                                       std::vector<int>& supernode_of) {
    const int n = static_cast<int>(parent.size());
    const Groups children = children_of(parent);
    std::vector<Supernode> supernodes;
    for (int j = 0; j < n; ++j) {
        const bool continues =
            j > 0 && parent[j - 1] == j && children.of(j).size() == 1 && count[j - 1] == count[j] + 1;
        if (!continues) supernodes.push_back({-1, 0, count[j], 0});
        ++supernodes.back().columns;
        supernode_of.push_back(static_cast<int>(supernodes.size()) - 1);
    }
    for (int j = 0; j < n; ++j)
        if (parent[j] >= 0 && supernode_of[parent[j]] != supernode_of[j])
            supernodes[supernode_of[j]].parent = supernode_of[parent[j]];
    return supernodes;
}

// Zeros that may be stored for the sake of larger fronts, as a part of all entries, by scalar columns of the front.
// Small fronts cost more in overhead than in operations.
double zeros_allowed(long long columns) {
    if (columns <= 8) return 0.6;
    if (columns <= 16) return 0.35;
    if (columns <= 32) return 0.2;
    if (columns <= 64) return 0.1;
    return 0.03;
}

// Merges supernodes into their parents, bottom up, largest children first. Returns which one each now belongs to.
std::vector<int> merge_supernodes(std::vector<Supernode>& supernodes, int d) {
    const int n = static_cast<int>(supernodes.size());
    std::vector<int> merged_into(n);
    std::iota(merged_into.begin(), merged_into.end(), 0);
    Groups children = children_of(supernodes);
    for (int p = 0; p < n; ++p) {
        sort_children(children, p, [&](int s) { return supernodes[s].rows; });
        for (int c : children.of(p)) {
            Supernode both = supernodes[p];
            both.columns += supernodes[c].columns;
            both.rows += supernodes[c].columns;
            both.zeros = both.entries() - (supernodes[c].entries() - supernodes[c].zeros) -
                         (supernodes[p].entries() - supernodes[p].zeros);
            if (both.zeros > zeros_allowed(both.columns * d) * both.entries()) continue;
            supernodes[p] = both;
            merged_into[c] = p;
        }
    }
    for (int s = n - 1; s >= 0; --s) merged_into[s] = merged_into[merged_into[s]];
    return merged_into;
}

// Children of one front in the order in which the stack of update matrices stays lowest: by how much more a subtree
// needs while it is worked on than it leaves behind (Liu, ACM Trans. Math. Softw. 12, 1986). Returns the fronts in
// postorder; `fronts` are the merged supernodes, their parents being fronts.
std::vector<int> order_fronts(const std::vector<Supernode>& fronts) {
    const int n = static_cast<int>(fronts.size());
    Groups children = children_of(fronts);
    std::vector<double> peak(n, 0), left(n);
    const auto excess = [&](int f) { return peak[f] - left[f]; };
    for (int f = 0; f < n; ++f) {
        sort_children(children, f, excess);
        double stacked = 0;
        for (int c : children.of(f)) {
            peak[f] = std::max(peak[f], stacked + peak[c]);
            stacked += left[c];
        }
        const double update_rows = static_cast<double>(fronts[f].rows - fronts[f].columns);
        left[f] = update_rows * update_rows;
        peak[f] = std::max(peak[f], stacked + left[f]);
    }
    sort_children(children, n, excess);
    return postorder(children);
}

// Rows of every front below its columns: those of A in its columns and those its children leave.
void find_rows(const Graph& graph, AssemblyTree& tree) {
    const std::vector<int> position = inverse(tree.order);
    std::vector<int> mark(graph.size(), -1);
    tree.row_start.assign(1, 0);
    for (int f = 0; f < tree.fronts(); ++f) {
        const std::size_t begin = tree.rows.size();
        auto add = [&](int row) {
            if (row < tree.first[f + 1] || mark[row] == f) return;
            mark[row] = f;
            tree.rows.push_back(row);
        };
        for (int j = tree.first[f]; j < tree.first[f + 1]; ++j)
            for (int u : graph.neighbours(tree.order[j])) add(position[u]);
        for (int c : tree.children.of(f))
            for (std::size_t k = tree.row_start[c]; k < tree.row_start[c + 1]; ++k) add(tree.rows[k]);
        std::sort(tree.rows.begin() + begin, tree.rows.end());
        tree.row_start.push_back(tree.rows.size());
    }
}

}  // namespace

std::vector<int> elimination_tree(const Graph& graph, const std::vector<int>& order) {
    const int n = graph.size();
    const std::vector<int> position = inverse(order);
    std::vector<int> parent(n, -1), ancestor(n, -1);  // ancestor: shortcuts towards the root
    for (int i = 0; i < n; ++i)
        for (int u : graph.neighbours(order[i])) {
            int j = position[u];
            while (j >= 0 && j < i) {
                const int up = ancestor[j];
                ancestor[j] = i;
                if (up < 0) parent[j] = i;
                j = up;
            }
        }
    return parent;
}

AssemblyTree build_assembly_tree(const Graph& graph, const std::vector<int>& start_order, int d) {
    std::vector<int> order;  // a postorder of the elimination tree
    for (int v : postorder(children_of(elimination_tree(graph, start_order)))) order.push_back(start_order[v]);
    const std::vector<int> parent = elimination_tree(graph, order), count = count_columns(graph, order, parent);
    std::vector<int> supernode_of;
    std::vector<Supernode> supernodes = find_supernodes(parent, count, supernode_of);
    const std::vector<int> merged_into = merge_supernodes(supernodes, d);

    std::vector<int> front_of(supernodes.size());  // fronts before they are put in their final order
    std::vector<Supernode> fronts;
    for (std::size_t s = 0; s < supernodes.size(); ++s)
        if (merged_into[s] == static_cast<int>(s)) {
            front_of[s] = static_cast<int>(fronts.size());
            fronts.push_back(supernodes[s]);
        }
    for (Supernode& front : fronts)
        if (front.parent >= 0) front.parent = front_of[merged_into[front.parent]];
    for (int& s : supernode_of) s = front_of[merged_into[s]];
    const Groups columns = sorted_by_group(supernode_of, static_cast<int>(fronts.size()));

    AssemblyTree tree;
    const std::vector<int> front_order = order_fronts(fronts), front_position = inverse(front_order);
    tree.first.push_back(0);
    for (int f : front_order) {
        tree.parent.push_back(fronts[f].parent < 0 ? -1 : front_position[fronts[f].parent]);
        for (int j : columns.of(f)) {
            tree.order.push_back(order[j]);
            tree.column_count.push_back(count[j]);
        }
        tree.first.push_back(static_cast<int>(tree.order.size()));
    }
    tree.children = children_of(tree.parent);
    find_rows(graph, tree);
    return tree;
}

}  // namespace almesh
