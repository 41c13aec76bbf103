#include "linalg/direct/factor_plan.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "linalg/direct/dense_kernels.hpp"

namespace almesh {

namespace {

constexpr double subtree_share = 1.0 / 16;  // largest part of all work that a subtree of several fronts may hold
constexpr double single_share = 1.0 / 8;    // and the subtree of any front that one thread works on
constexpr double smallest_cost = 2e7;       // less work than this is one subtree: threads would cost more

void find_children(FactorPlan& plan) {
    const int fronts = plan.tree.fronts();
    plan.child_start.assign(fronts + 1, 0);
    for (int p : plan.tree.parent)
        if (p >= 0) ++plan.child_start[p + 1];
    for (int f = 0; f < fronts; ++f) plan.child_start[f + 1] += plan.child_start[f];
    std::vector<int> next(plan.child_start.begin(), plan.child_start.end() - 1);
    plan.child.resize(plan.child_start[fronts]);
    for (int f = 0; f < fronts; ++f)
        if (const int p = plan.tree.parent[f]; p >= 0) plan.child[next[p]++] = f;
}

// Rows of a front are its own columns, then tree.rows, both ascending: walks the two lists of child and parent at once.
void find_places_in_parents(FactorPlan& plan) {
    const AssemblyTree& tree = plan.tree;
    plan.in_parent.resize(tree.rows.size());
    parallel_for(tree.fronts(), [&](int f) {
        const int p = tree.parent[f];
        if (p < 0) return;
        std::size_t at = tree.row_start[p];
        for (std::size_t k = tree.row_start[f]; k < tree.row_start[f + 1]; ++k) {
            const int row = tree.rows[k];
            if (row < tree.first[p + 1]) {
                plan.in_parent[k] = row - tree.first[p];
                continue;
            }
            while (tree.rows[at] != row) ++at;
            plan.in_parent[k] = tree.columns(p) + static_cast<int>(at - tree.row_start[p]);
        }
    }, 100);
}

// Block (i, j) of A belongs to the front that eliminates the earlier of the two; as A is symmetric, the one stored in
// the later row is taken.
void find_entries(FactorPlan& plan, const BlockCsr& pattern) {
    const AssemblyTree& tree = plan.tree;
    const std::vector<int> position = inverse(tree.order);
    std::vector<int> place(pattern.n, -1);
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
    }
}

void count_work(FactorPlan& plan) {
    const double d = plan.d;
    for (int count : plan.tree.column_count)
        for (int c = 0; c < plan.d; ++c) {
            const double length = count * d - c;
            plan.factor_entries += length;
            plan.flops += length * length;
        }
}

// Operations and memory traffic of one front, in flops.
double cost(const FactorPlan& plan, int f) {
    const double m = plan.rows(f), k = plan.pivots(f);
    return k * m * m - k * k * m + k * k * k / 3 + 4 * m * m;
}

void cut_into_subtrees(FactorPlan& plan) {
    const AssemblyTree& tree = plan.tree;
    const int fronts = tree.fronts();
    std::vector<double> work(fronts, 0);  // of the whole subtree
    std::vector<int> begin(fronts);       // first front of the subtree
    double total = 0;
    for (int f = 0; f < fronts; ++f) {
        begin[f] = f;
        if (plan.child_start[f] < plan.child_start[f + 1]) begin[f] = begin[plan.child[plan.child_start[f]]];
        work[f] += cost(plan, f);
        total += cost(plan, f);
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
    std::stable_sort(plan.subtrees.begin(), plan.subtrees.end(), [&](const FrontRange& a, const FrontRange& b) {
        return work[a.end - 1] > work[b.end - 1];
    });
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

// The two stacks of some part of the tree, even on `at[0]`, odd on `at[1]`.
struct Stacks {
    std::size_t at[2] = {0, 0}, peak[2] = {0, 0};
};

void push_update(FactorPlan& plan, int f, int parity, Stacks& stacks) {
    plan.update_at[f] = stacks.at[parity];
    stacks.at[parity] += update_size(plan.rows(f), plan.pivots(f));
    stacks.peak[parity] = std::max(stacks.peak[parity], stacks.at[parity]);
}

// Children that stand on a stack lie on its top, the first of them lowest.
void pop_children(const FactorPlan& plan, int f, const std::vector<char>& handed_over, int parity, Stacks& stacks) {
    for (int k = plan.child_start[f]; k < plan.child_start[f + 1]; ++k)
        if (const int c = plan.child[k]; !handed_over[c]) {
            stacks.at[parity] = plan.update_at[c];
            return;
        }
}

// Offsets of the odd stack are raised by `even_size`, so that it starts where the even one can end.
void raise_odd(FactorPlan& plan, int f, int parity, std::size_t even_size) {
    if (parity) plan.update_at[f] += even_size;
}

void place_updates(FactorPlan& plan) {
    const AssemblyTree& tree = plan.tree;
    const int fronts = tree.fronts();
    std::vector<char> parity(fronts, 0), handed_over(fronts, 0);
    for (int f = fronts - 1; f >= 0; --f) parity[f] = tree.parent[f] < 0 ? 0 : 1 - parity[tree.parent[f]];
    plan.update_at.assign(fronts, 0);
    plan.update_shared.assign(fronts, 0);

    const auto hand_over = [&](int f) {
        handed_over[f] = plan.update_shared[f] = 1;
        plan.update_at[f] = plan.shared_size;
        plan.shared_size += update_size(plan.rows(f), plan.pivots(f));
    };
    std::size_t even = 0, odd = 0;
    for (const FrontRange& range : plan.subtrees) {
        Stacks stacks;
        for (int f = range.begin; f < range.end; ++f) {
            if (f == range.end - 1 && tree.parent[f] >= 0) {
                hand_over(f);
                continue;
            }
            push_update(plan, f, parity[f], stacks);
            pop_children(plan, f, handed_over, 1 - parity[f], stacks);
        }
        even = std::max(even, stacks.peak[0]);
        odd = std::max(odd, stacks.peak[1]);
    }
    for (const FrontRange& range : plan.subtrees)
        for (int f = range.begin; f < range.end; ++f)
            if (!handed_over[f]) raise_odd(plan, f, parity[f], even);
    plan.thread_size = even + odd;
    for (int f : plan.single) hand_over(f);

    Stacks stacks;
    for (int f : plan.top) {
        plan.update_shared[f] = 1;
        push_update(plan, f, parity[f], stacks);
        pop_children(plan, f, handed_over, 1 - parity[f], stacks);
    }
    for (int f : plan.top) {
        plan.update_at[f] += plan.shared_size;
        raise_odd(plan, f, parity[f], stacks.peak[0]);
    }
    plan.shared_size += stacks.peak[0] + stacks.peak[1];
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
    plan.d = pattern.d;
    plan.tree = build_assembly_tree(graph, order, pattern.d);
    find_children(plan);
    find_places_in_parents(plan);
    find_entries(plan, pattern);
    count_work(plan);
    cut_into_subtrees(plan);
    sort_into_levels(plan);
    place_updates(plan);
    plan.panel_at.assign(1, 0);
    for (int f = 0; f < plan.tree.fronts(); ++f)
        plan.panel_at.push_back(plan.panel_at.back() + panel_size(plan.rows(f), plan.pivots(f)));
    return plan;
}

}  // namespace almesh
