#include "linalg/direct/factor_plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "linalg/block_csr.hpp"
#include "linalg/direct/dense_kernels.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/ordering.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

FactorPlan plan_of(const BlockCsr& A) {
    const Graph graph = graph_of(A);
    return plan_factorisation(A, graph, nested_dissection(graph));
}

// Row of the matrix (new numbering) at a place of front f.
int row_at(const FactorPlan& plan, int f, int place) {
    const int columns = plan.tree.columns(f);
    return place < columns ? plan.tree.first[f] + place : plan.tree.rows[plan.tree.row_start[f] + place - columns];
}

struct Range {
    std::size_t begin, end;
    bool operator==(const Range&) const = default;
    bool apart(const Range& other) const { return end <= other.begin || other.end <= begin || begin == end; }
};

}  // namespace

TEST_CASE("predicted entries and operations are those of the dense factor") {
    for (int d = 1; d <= 3; ++d)
        for (const Edges& edges : {grid(12, 12), random_edges(144, 300, 2), star(144), Edges{}}) {
            const BlockCsr A = random_spd(144, d, edges);
            const FactorPlan plan = plan_of(A);
            Dense L = to_dense(A, plan.tree.order);
            REQUIRE(dense_cholesky(L) == -1);
            double entries = 0, flops = 0;
            for (int j = 0; j < L.n; ++j) {
                double length = 0;
                for (int i = j; i < L.n; ++i) length += L(i, j) != 0;
                entries += length;
                flops += length * length;
            }
            CHECK(plan.factor_entries == entries);
            CHECK(plan.flops == flops);
            CHECK(plan.panel_at.back() >= entries);
        }
}

TEST_CASE("every block of the lower triangle goes to one place of one front, that of its row and column") {
    const BlockCsr A = random_spd(400, 2, grid(20, 20));
    const FactorPlan plan = plan_of(A);
    const std::vector<int> position = inverse(plan.tree.order);
    CHECK(plan.entries.size() == static_cast<std::size_t>((A.blocks() + A.n) / 2));
    for (int f = 0; f < plan.tree.fronts(); ++f) {
        for (std::size_t e = plan.entry_start[f]; e < plan.entry_start[f + 1]; ++e) {
            const FrontEntry& entry = plan.entries[e];
            const auto next_row = std::upper_bound(A.row.begin(), A.row.end(), entry.block);
            CHECK(row_at(plan, f, entry.column) == position[next_row - A.row.begin() - 1]);
            CHECK(row_at(plan, f, entry.row) == position[A.col[entry.block]]);
            CHECK(entry.column < plan.tree.columns(f));
        }
        if (const int p = plan.tree.parent[f]; p >= 0)
            for (std::size_t k = plan.tree.row_start[f]; k < plan.tree.row_start[f + 1]; ++k)
                CHECK(plan.tree.rows[k] == row_at(plan, p, plan.relative_index[k]));
    }
}

TEST_CASE("subtrees, single fronts and top cover all fronts once, the subtrees are independent") {
    const FactorPlan plan = plan_of(random_spd(6400, 2, grid(80, 80)));
    CHECK(plan.subtrees.size() > 4);
    CHECK(!plan.single.empty());
    CHECK(!plan.top.empty());
    std::vector<int> owner(plan.tree.fronts(), -1);
    for (std::size_t s = 0; s < plan.subtrees.size(); ++s)
        for (int f = plan.subtrees[s].begin; f < plan.subtrees[s].end; ++f) {
            CHECK(owner[f] == -1);
            owner[f] = static_cast<int>(s);
        }
    for (int f : plan.single) {
        CHECK(owner[f] == -1);
        owner[f] = -2;
    }
    for (int f : plan.top) {
        CHECK(owner[f] == -1);
        owner[f] = -3;
    }
    for (int f = 0; f < plan.tree.fronts(); ++f) {
        CHECK(owner[f] != -1);
        const int p = plan.tree.parent[f];
        CHECK((p < 0 || owner[p] == owner[f] || (owner[p] == -2 && owner[f] >= 0) || owner[p] == -3));
    }
    for (const std::vector<int>* fronts : {&plan.single, &plan.top})
        CHECK(std::is_sorted(fronts->begin(), fronts->end()));  // children before parents
    for (int f : plan.single) CHECK(!plan.tree.children.of(f).empty());  // whose last one starts it
    CHECK(plan_of(random_spd(100, 2, grid(10, 10))).subtrees.size() == 1);
}

TEST_CASE("levels hold the fronts above the subtrees once, parents above their children") {
    const FactorPlan plan = plan_of(random_spd(90 * 90, 2, grid(90, 90)));
    std::vector<int> level(plan.tree.fronts(), -1), listed;
    for (std::size_t l = 0; l < plan.levels.size(); ++l)
        for (int f : plan.levels[l]) {
            level[f] = static_cast<int>(l);
            listed.push_back(f);
        }
    CHECK(plan.levels.size() > 1);
    std::sort(listed.begin(), listed.end());
    std::vector<int> above = plan.top;
    above.insert(above.end(), plan.single.begin(), plan.single.end());
    std::sort(above.begin(), above.end());
    CHECK(listed == above);
    for (int f : above)
        if (const int p = plan.tree.parent[f]; p >= 0) CHECK(level[p] == level[f] + 1);
}

TEST_CASE("update matrices that are needed at the same time never overlap") {
    Edges edges = grid(70, 70);
    for (const auto& [i, j] : grid(30, 30)) edges.push_back({i + 4900, j + 4900});
    const FactorPlan plan = plan_of(random_spd(5800, 2, edges));
    // Plays the factorisation through; live[shared]: what lies in the memory of the thread and in the shared one.
    std::vector<Range> live[2];
    auto range = [&](int f) {
        return Range{plan.update_at[f], plan.update_at[f] + update_size(plan.rows(f), plan.pivots(f))};
    };
    auto run = [&](int f) {
        const Range own = range(f);
        CHECK(own.end <= (plan.update_shared[f] ? plan.shared_size : plan.thread_size));
        std::vector<Range>& memory = live[static_cast<int>(plan.update_shared[f])];
        for (const Range& other : memory) CHECK(own.apart(other));
        memory.push_back(own);
        for (int c : plan.tree.children.of(f)) {
            std::vector<Range>& from = live[static_cast<int>(plan.update_shared[c])];
            const auto it = std::find(from.begin(), from.end(), range(c));
            REQUIRE(it != from.end());
            from.erase(it);
        }
    };
    for (const FrontRange& subtree : plan.subtrees) {
        live[0].clear();
        for (int f = subtree.begin; f < subtree.end; ++f) run(f);
    }
    live[0].clear();
    for (int f : plan.single) run(f);
    for (int f : plan.top) run(f);

    CHECK(!plan.single.empty());
    // Threads are at any of the subtrees and single fronts at the same time.
    std::vector<Range> handed_over;
    const auto keep = [&](int f) {
        for (const Range& other : handed_over) CHECK(range(f).apart(other));
        handed_over.push_back(range(f));
    };
    for (const FrontRange& subtree : plan.subtrees)
        if (plan.tree.parent[subtree.end - 1] >= 0) keep(subtree.end - 1);
    for (int f : plan.single) keep(f);
}
