// Places in fronts by a map from rows to places in the current front; the tree cut by the work in its subtrees; update
// matrices placed by playing the factorisation through on stacks.
#include "linalg/direct/factor_plan.hpp"

#include <algorithm>

#include "linalg/block_csr.hpp"
#include "linalg/direct/dense_kernels.hpp"

namespace almesh {
namespace {

constexpr double subtree_share = 1.0 / 16;  // largest part of all work in a subtree of several fronts
constexpr double single_share = 1.0 / 8;    // and in the subtree of any front that one thread works on
constexpr double smallest_cost = 2e7;       // less work than this is one subtree, for one thread

// Places of blocks of A and of the rows of update matrices, front by front. Rows of a front are its own columns, then
// tree.rows, both ascending. Block (i, j) of A belongs to the front that eliminates the earlier of the two; as A is
// symmetric, the one stored in the later row is taken.
void find_places(FactorPlan& plan, const BlockCsr& pattern) {
    const AssemblyTree& tree = plan.tree;
    const std::vector<int> position = inverse(tree.order);
    std::vector<int> place(pattern.n, -1);  // of each row in the current front
    plan.relative_index.resize(tree.rows.size());
    plan.entry_start.assign(1, 0);
    for (int f = 0; f < tree.fronts(); ++f) {
        for (int j = tree.first[f]; j < tree.first[f + 1]; ++j) place[j] = j - tree.first[f];
        for (std::size_t k = tree.row_start[f]; k < tree.row_start[f + 1]; ++k)
            place[tree.rows[k]] = tree.columns(f) + static_cast<int>(k - tree.row_start[f]);
        for (int j = tree.first[f]; j < tree.first[f + 1]; ++j) {
            const int v = tree.order[j];
            for (int k = pattern.row[v]; k < pattern.row[v + 1]; ++k) {
                const int i = position[pattern.col[k]];
                if (i >= j) plan.entries.push_back({k, place[i], j - tree.first[f]});
            }
        }
        plan.entry_start.push_back(plan.entries.size());
        for (int c : tree.children.of(f))
            for (std::size_t k = tree.row_start[c]; k < tree.row_start[c + 1]; ++k)
                plan.relative_index[k] = place[tree.rows[k]];
    }
}

void cut_into_subtrees(FactorPlan& plan) {
    const AssemblyTree& tree = plan.tree;
    const auto cost = [&](int f) {  // operations and memory traffic of one front, in flops
        const double m = plan.rows(f), k = plan.pivots(f);
        return k * m * m - k * k * m + k * k * k / 3 + 4 * m * m;
    };
    const int fronts = tree.fronts();
    std::vector<double> work(fronts, 0);  // of the whole subtree
    std::vector<int> begin(fronts);       // first front of the subtree
    double total = 0;
    for (int f = 0; f < fronts; ++f) {
        begin[f] = tree.children.of(f).empty() ? f : begin[tree.children.of(f).front()];
        work[f] += cost(f);
        total += cost(f);
        if (tree.parent[f] >= 0) work[tree.parent[f]] += work[f];
    }
    if (total <= smallest_cost) {
        if (fronts > 0) plan.subtrees.push_back({0, fronts});
        return;
    }
    for (int f = 0; f < fronts; ++f) {
        const int p = tree.parent[f];
        if (work[f] > total * single_share) plan.top.push_back(f);
        else if (work[f] > total * subtree_share && begin[f] < f) plan.single.push_back(f);
        else if (p < 0 || work[p] > total * subtree_share) plan.subtrees.push_back({begin[f], f + 1});
    }
    std::stable_sort(plan.subtrees.begin(), plan.subtrees.end(),
                     [&](const FrontRange& a, const FrontRange& b) { return work[a.end - 1] > work[b.end - 1]; });
}

void sort_into_levels(FactorPlan& plan) {
    std::vector<int> depth(plan.tree.fronts(), 0);
    for (const std::vector<int>* fronts : {&plan.top, &plan.single})
        for (std::size_t k = fronts->size(); k-- > 0;) {
            const int f = (*fronts)[k], p = plan.tree.parent[f];
            if (p >= 0) depth[f] = depth[p] + 1;
            if (depth[f] >= static_cast<int>(plan.levels.size())) plan.levels.resize(depth[f] + 1);
            plan.levels[depth[f]].push_back(f);
        }
    std::reverse(plan.levels.begin(), plan.levels.end());
}

void place_updates(FactorPlan& plan) {
    const AssemblyTree& tree = plan.tree;
    // On which stack each update matrix lies: 0 or 1 by the parity of its front's depth, or `own` if it has a place of
    // its own, which is never popped.
    constexpr int own = 2;
    std::vector<int> stack(tree.fronts(), 0);
    for (int f = tree.fronts() - 1; f >= 0; --f)
        if (tree.parent[f] >= 0) stack[f] = 1 - stack[tree.parent[f]];
    for (const FrontRange& range : plan.subtrees)
        if (tree.parent[range.end - 1] >= 0) stack[range.end - 1] = own;
    for (int f : plan.single) stack[f] = own;

    plan.update_at.assign(tree.fronts(), 0);
    plan.update_shared.assign(tree.fronts(), 0);
    std::size_t top[3] = {}, size[3] = {};
    const auto push = [&](int f) {
        plan.update_at[f] = top[stack[f]];
        top[stack[f]] += update_size(plan.rows(f), plan.pivots(f));
        size[stack[f]] = std::max(size[stack[f]], top[stack[f]]);
        for (int c : tree.children.of(f))
            if (stack[c] != own) {  // those on a stack are its topmost, the first of them lowest
                top[stack[c]] = plan.update_at[c];
                break;
            }
    };
    // Odd stacks begin where even ones can end.
    const auto raise = [&](int f, std::size_t base) { plan.update_at[f] += base + (stack[f] == 1 ? size[0] : 0); };

    for (const FrontRange& range : plan.subtrees) {
        top[0] = top[1] = 0;
        for (int f = range.begin; f < range.end; ++f) push(f);
    }
    for (const FrontRange& range : plan.subtrees)
        for (int f = range.begin; f < range.end; ++f)
            if (stack[f] != own) raise(f, 0);
    plan.thread_size = size[0] + size[1];

    for (int f : plan.single) push(f);
    top[0] = top[1] = size[0] = size[1] = 0;
    for (int f : plan.top) push(f);
    for (int f : plan.top) raise(f, size[own]);
    plan.shared_size = size[0] + size[1] + size[own];
    for (int f = 0; f < tree.fronts(); ++f) plan.update_shared[f] = stack[f] == own;
    for (int f : plan.top) plan.update_shared[f] = 1;
}

}  // namespace

double FactorPlan::bytes(int threads) const {
    const double doubles = static_cast<double>(panel_at.back()) + static_cast<double>(shared_size) +
                           static_cast<double>(thread_size) * threads + static_cast<double>(tree.rows.size()) * d;
    return 8 * doubles + sizeof(FrontEntry) * static_cast<double>(entries.size()) +
           2.0 * sizeof(int) * static_cast<double>(tree.rows.size());
}

FactorPlan plan_factorisation(const BlockCsr& pattern, const Graph& graph, const std::vector<int>& order) {
    FactorPlan plan;
    const int d = plan.d = pattern.d;
    plan.tree = build_assembly_tree(graph, order, d);
    find_places(plan, pattern);
    for (int count : plan.tree.column_count)
        for (int c = 0; c < d; ++c) {
            const double length = static_cast<double>(count) * d - c;
            plan.factor_entries += length;
            plan.flops += length * length;
        }
    cut_into_subtrees(plan);
    sort_into_levels(plan);
    place_updates(plan);
    plan.panel_at.assign(1, 0);
    for (int f = 0; f < plan.tree.fronts(); ++f)
        plan.panel_at.push_back(plan.panel_at.back() + panel_size(plan.rows(f), plan.pivots(f)));
    return plan;
}

}  // namespace almesh
