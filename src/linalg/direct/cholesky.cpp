// Fronts are factored in postorder. A solve is L y = b in the same order, then L' x = y in the reverse one.
#include "linalg/direct/cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/physical_memory.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh {
namespace {

// A pivot must exceed this times the diagonal entry of A it began as: what is left of it would otherwise be rounding.
constexpr double smallest_pivot = 1e-14;
constexpr double parallel_front = 2e7;  // operations from which a front is worth a team of threads

int thread_number() {
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

FactorPlan plan_in_order(const BlockCsr& pattern, Ordering ordering) {
    const Graph graph = graph_of(pattern);
    return plan_factorisation(pattern, graph, order_vertices(graph, ordering));
}

// Of the iterations of a loop, for parallel_for(): nothing where no team is asked for.
double work_of(bool parallel, double work = 10) { return parallel ? work : 0; }

// Rows of an update matrix that stay next to each other in the parent front; scalar, counted from its first row.
struct Run {
    int begin, end, target;
};

void find_runs(const int* index, int rows, int d, std::vector<Run>& runs) {
    runs.clear();
    for (int i = 0; i < rows; ++i) {
        if (i == 0 || index[i] != index[i - 1] + 1) runs.push_back({i * d, i * d, index[i] * d});
        runs.back().end += d;
    }
}

// Adds column j, which is in run r, of a child's update matrix to its parent's front, from the diagonal down.
void extend_add_column(const Front& child, const Front& parent, const std::vector<Run>& runs, std::size_t r, int j) {
    const double* const from = child.update + offset(j, update_ld(child.m, child.k)) + child.k - update_row(child.k);
    const int target = runs[r].target + j - runs[r].begin;
    // Row i of the front is element [i] of its column.
    double* const to = target < parent.k ? parent.panel + offset(target, front_ld(parent.m))
                                         : parent.update + offset(target - parent.k, update_ld(parent.m, parent.k)) -
                                               update_row(parent.k);
    for (int begin = j; r < runs.size(); ++r, begin = r < runs.size() ? runs[r].begin : 0) {
        double* const run_to = to + runs[r].target - runs[r].begin;
        for (int i = begin; i < runs[r].end; ++i) run_to[i] += from[i];
    }
}

// Adds the columns of a child's update matrix that go to its parent's pivots (panel) or to its update matrix.
void extend_add(const Front& child, const Front& parent, const std::vector<Run>& runs, bool panel, bool parallel) {
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const int pivots = std::clamp(parent.k - runs[r].target + runs[r].begin, runs[r].begin, runs[r].end);
        const int begin = panel ? runs[r].begin : pivots, end = panel ? pivots : runs[r].end;
        parallel_for(end - begin, [&](int j) { extend_add_column(child, parent, runs, r, begin + j); },
                     work_of(parallel && end - begin > 32));
    }
}

}  // namespace

Cholesky::Cholesky(const BlockCsr& pattern, const CholeskyParams& params)
    : params_(params), plan_(plan_in_order(pattern, params.ordering)) {
    for (int f = 0; f < plan_.tree.fronts(); ++f) largest_front_ = std::max(largest_front_, plan_.rows(f));
}

double Cholesky::predicted_bytes() const { return plan_.bytes(max_threads()); }

bool Cholesky::fits() const {
    return predicted_bytes() <= (params_.memory_limit > 0 ? params_.memory_limit : physical_memory());
}

void Cholesky::allocate() {
    const int threads = max_threads();
    if (factor_.empty()) {
        unfinished_.resize(plan_.tree.fronts());
        smallest_.resize(plan_.tree.order.size() * plan_.d);
        permuted_.resize(plan_.tree.order.size() * plan_.d);
        passed_on_.resize(plan_.tree.rows.size() * plan_.d);
        factor_.resize(plan_.panel_at.back());
    }
    if (threads <= threads_) return;
    updates_ = LargeVector<double>();  // first, so that there is never memory for both
    updates_.resize(plan_.shared_size + plan_.thread_size * threads);
    threads_ = threads;
}

Front Cholesky::front(int f, int thread) {
    const std::size_t base = plan_.update_shared[f] ? 0 : plan_.shared_size + plan_.thread_size * thread;
    return {plan_.rows(f), plan_.pivots(f), factor_.data() + plan_.panel_at[f],
            updates_.data() + base + plan_.update_at[f]};
}

// Assembles the entries of A in the panel, and sets the smallest acceptable pivots.
void Cholesky::gather_entries(const BlockCsr& A, int f, const Front& target, bool parallel) {
    const int d = plan_.d, ld = front_ld(target.m);
    double* const smallest = smallest_.data() + offset(plan_.tree.first[f], d);
    parallel_for(target.k, [&](int j) { std::fill_n(target.panel + offset(j, ld), ld, 0.0); },
                 work_of(parallel, target.m));
    for (std::size_t e = plan_.entry_start[f]; e < plan_.entry_start[f + 1]; ++e) {
        const FrontEntry& entry = plan_.entries[e];
        const double* block = A.block(entry.block);  // row-major, row = the entry's column, as A is symmetric
        double* to = target.panel + offset(entry.column * d, ld, entry.row * d);
        for (int c = 0; c < d; ++c)
            for (int r = 0; r < d; ++r) to[c * ld + r] = block[c * d + r];
        for (int c = 0; c < d && entry.row == entry.column; ++c)
            smallest[entry.column * d + c] = smallest_pivot * std::abs(block[c * d + c]);
    }
}

// Returns -1 or the bad column of the front.
int Cholesky::factor_one(const BlockCsr& A, int f, int thread, bool parallel) {
    thread_local std::vector<Run> runs;  // scratch, kept between calls
    const Front target = front(f, thread);
    parallel = parallel && static_cast<double>(target.k) * target.m * target.m > parallel_front;
    gather_entries(A, f, target, parallel);
    auto add_children = [&](bool panel) {
        for (int c : plan_.tree.children.of(f)) {
            find_runs(plan_.relative_index.data() + plan_.tree.row_start[c], plan_.tree.update_rows(c), plan_.d, runs);
            extend_add(front(c, thread), target, runs, panel, parallel);
        }
    };
    add_children(true);
    const double* smallest = smallest_.data() + offset(plan_.tree.first[f], plan_.d);
    const int bad = factor_front(target, smallest, parallel);
    if (bad < 0) add_children(false);  // factor_front() writes the update matrix, it does not add to it
    return bad;
}

// Fronts of a range in order, up to the first bad column known: the first in elimination order, whichever thread is
// faster, since only later columns are skipped.
void Cholesky::factor_fronts(const BlockCsr& A, FrontRange range, bool parallel, std::atomic<int>& first_bad) {
    for (int f = range.begin; f < range.end && plan_.tree.first[f] < first_bad; ++f) {
        const int bad = factor_one(A, f, thread_number(), parallel);
        if (bad < 0) continue;
        const int column = plan_.tree.first[f] + bad / plan_.d;
        for (int seen = first_bad; column < seen && !first_bad.compare_exchange_weak(seen, column);) {
        }
    }
}

FactorResult Cholesky::factor(const BlockCsr& A) {
    if (!fits()) return {SolveStatus::too_large};
    allocate();
    constexpr int none = std::numeric_limits<int>::max();
    std::atomic<int> first_bad = none;
    for (const int f : plan_.single) unfinished_[f] = static_cast<int>(plan_.tree.children.of(f).size());
    const int subtrees = static_cast<int>(plan_.subtrees.size());
    parallel_tasks(subtrees, true, [&](int s) {
        factor_fronts(A, plan_.subtrees[s], false, first_bad);
        // The thread that finishes the last child of a single front goes on with the front.
        for (int f = plan_.subtrees[s].end - 1; (f = plan_.tree.parent[f]) >= 0;) {
            if (take_one_off(unfinished_[f]) != 0) break;
            factor_fronts(A, {f, f + 1}, false, first_bad);
        }
    });
    for (const int f : plan_.top) factor_fronts(A, {f, f + 1}, true, first_bad);
    if (first_bad < none) return {SolveStatus::not_positive_definite, plan_.tree.order[first_bad]};
    return {SolveStatus::success};
}

// Gathers w of the front from x and from what its children (forward) or its ancestors (backward) leave it, solves with
// its columns of L, and hands the result on.
void Cholesky::solve_front(int f, bool forward, double* x, bool parallel) {
    thread_local std::vector<double> work;  // scratch, kept between calls
    const AssemblyTree& tree = plan_.tree;
    const Front L = front(f, 0);
    const int d = plan_.d;
    work.resize(largest_front_);
    double *const w = work.data(), *const own = x + offset(tree.first[f], d);
    double* const passed_on = passed_on_.data() + offset(tree.row_start[f], d);
    std::copy_n(own, L.k, w);
    if (forward) {
        std::fill(w + L.k, w + L.m, 0.0);
        for (int c : tree.children.of(f))
            for (std::size_t i = tree.row_start[c]; i < tree.row_start[c + 1]; ++i)
                for (int r = 0; r < d; ++r) w[plan_.relative_index[i] * d + r] += passed_on_[i * d + r];
        solve_forward(L, w, parallel);
        std::copy(w + L.k, w + L.m, passed_on);
    } else {
        for (int i = 0; i < tree.update_rows(f); ++i)
            std::copy_n(x + offset(tree.rows[tree.row_start[f] + i], d), d, w + L.k + i * d);
        solve_backward(L, w, parallel);
    }
    std::copy_n(w, L.k, own);
}

void Cholesky::solve(const double* b, double* x) {
    const int d = plan_.d, subtrees = static_cast<int>(plan_.subtrees.size());
    const std::vector<int>& order = plan_.tree.order;
    const int nodes = static_cast<int>(order.size()), levels = static_cast<int>(plan_.levels.size());
    double* const y = permuted_.data();
    const auto sweep_subtrees = [&](bool forward) {
        parallel_tasks(subtrees, true, [&](int s) {
            const auto [begin, end] = plan_.subtrees[s];
            for (int k = 0; k < end - begin; ++k) solve_front(forward ? begin + k : end - 1 - k, forward, y, false);
        });
    };
    // Solves read each panel once, so threads that share a front wait more than they work: parallel across a level, and
    // inside a front only where it is alone.
    const auto sweep_level = [&](int l, bool forward) {
        const int fronts = static_cast<int>(plan_.levels[l].size());
        parallel_tasks(fronts, true, [&](int i) { solve_front(plan_.levels[l][i], forward, y, fronts == 1); });
    };
    parallel_for(nodes, [&](int i) { std::copy_n(b + offset(order[i], d), d, y + offset(i, d)); });
    sweep_subtrees(true);
    for (int l = 0; l < levels; ++l) sweep_level(l, true);
    for (int l = levels - 1; l >= 0; --l) sweep_level(l, false);
    sweep_subtrees(false);
    parallel_for(nodes, [&](int i) { std::copy_n(y + offset(i, d), d, x + offset(order[i], d)); });
}

}  // namespace almesh
