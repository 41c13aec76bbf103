// For every front in postorder: assemble its columns of A, extend-add the update matrices of the children, partial
// dense Cholesky. A solve is L y = b in the same order, then L' x = y in the reverse one.
#include "linalg/direct/cholesky.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh {

namespace {

constexpr double parallel_front = 2e7;  // operations from which a front is worth a team of threads

int thread_number() {
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

double physical_memory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

FactorPlan plan_in_order(const BlockCsr& pattern, Ordering ordering) {
    const Graph graph = graph_of(pattern);
    return plan_factorisation(pattern, graph, order_vertices(graph, ordering));
}

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

// Adds the lower triangle of a child's update matrix to its parent's front.
struct ExtendAdd {
    Front child, parent;
    const std::vector<Run>& runs;

    // Column j, which is in run r, from the diagonal down.
    void column(std::size_t r, int j) const {
        const int ld = update_ld(child.m, child.k);
        const double* const from = child.update + offset(j, ld) + child.k - update_row(child.k);
        const int target = runs[r].target + j - runs[r].begin;
        double* const to = column_of_parent(target);
        for (int begin = j; r < runs.size(); ++r, begin = r < runs.size() ? runs[r].begin : 0) {
            double* const run_to = to + runs[r].target - runs[r].begin;
            for (int i = begin; i < runs[r].end; ++i) run_to[i] += from[i];
        }
    }

    // Column j of the parent, offset so that row i of the front is element [i].
    double* column_of_parent(int j) const {
        if (j < parent.k) return parent.panel + offset(j, front_ld(parent.m));
        const std::size_t ld = update_ld(parent.m, parent.k);
        return parent.update + (j - parent.k) * ld - update_row(parent.k);
    }

    // Columns that go to the parent's pivots (panel) or to its update matrix.
    void add(bool panel, bool parallel) const {
        for (std::size_t r = 0; r < runs.size(); ++r) {
            const int pivots = std::clamp(parent.k - runs[r].target + runs[r].begin, runs[r].begin, runs[r].end);
            const int begin = panel ? runs[r].begin : pivots, end = panel ? pivots : runs[r].end;
            if (parallel && end - begin > 32) {
                parallel_for(end - begin, [&](int j) { column(r, begin + j); });
            } else {
                for (int j = begin; j < end; ++j) column(r, j);
            }
        }
    }
};

// Solves read each panel once, so threads that share a front wait more than they work: parallel across a level, and
// inside a front only where it is alone.
template <class Body>
void for_level(const std::vector<int>& level, const Body& body) {
    const int count = static_cast<int>(level.size());
    if (count == 1) return body(level.front(), true);
#pragma omp parallel for schedule(dynamic, 1)
    for (int i = 0; i < count; ++i) body(level[i], false);
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

double* Cholesky::update_of(int f, int thread) {
    const std::size_t base = plan_.update_shared[f] ? 0 : plan_.shared_size + plan_.thread_size * thread;
    return updates_.data() + base + plan_.update_at[f];
}

Front Cholesky::front(int f, int thread) {
    return {plan_.rows(f), plan_.pivots(f), factor_.data() + plan_.panel_at[f], update_of(f, thread)};
}

// Assembles the entries of A in the panel, and sets the smallest acceptable pivots.
void Cholesky::gather_entries(const BlockCsr& A, int f, const Front& target, bool parallel) {
    const int d = plan_.d, ld = front_ld(target.m);
    double* const smallest = smallest_.data() + offset(plan_.tree.first[f], d);
    auto clear = [&](int j) { std::fill_n(target.panel + offset(j, ld), ld, 0.0); };
    if (parallel) {
        parallel_for(target.k, clear, target.m);
    } else {
        for (int j = 0; j < target.k; ++j) clear(j);
    }
    for (std::size_t e = plan_.entry_start[f]; e < plan_.entry_start[f + 1]; ++e) {
        const FrontEntry& entry = plan_.entries[e];
        const double* block = A.block(entry.block);  // row-major, row = the entry's column, as A is symmetric
        double* to = target.panel + offset(entry.column * d, ld, entry.row * d);
        for (int c = 0; c < d; ++c)
            for (int r = 0; r < d; ++r) to[c * ld + r] = block[c * d + r];
        for (int c = 0; c < d && entry.row == entry.column; ++c)
            smallest[entry.column * d + c] = params_.smallest_pivot * std::abs(block[c * d + c]);
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
            ExtendAdd{front(c, thread), target, runs}.add(panel, parallel);
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
#pragma omp parallel for schedule(dynamic, 1) if (subtrees > 1)
    for (int s = 0; s < subtrees; ++s) {
        factor_fronts(A, plan_.subtrees[s], false, first_bad);
        // The thread that finishes the last child of a single front goes on with the front.
        for (int f = plan_.subtrees[s].end - 1; (f = plan_.tree.parent[f]) >= 0;) {
            if (std::atomic_ref(unfinished_[f]).fetch_sub(1) != 1) break;
            factor_fronts(A, {f, f + 1}, false, first_bad);
        }
    }
    for (const int f : plan_.top) factor_fronts(A, {f, f + 1}, true, first_bad);
    if (first_bad < none) return {SolveStatus::not_positive_definite, plan_.tree.order[first_bad]};
    return {SolveStatus::success};
}

void Cholesky::solve_forward_one(int f, double* x, bool parallel) {
    thread_local std::vector<double> work;  // scratch, kept between calls
    const Front L = front(f, 0);
    const int d = plan_.d;
    work.resize(largest_front_);
    double* const own = x + offset(plan_.tree.first[f], d);
    std::copy_n(own, L.k, work.data());
    std::fill(work.begin() + L.k, work.begin() + L.m, 0.0);
    for (int c : plan_.tree.children.of(f))
        for (std::size_t i = plan_.tree.row_start[c]; i < plan_.tree.row_start[c + 1]; ++i)
            for (int r = 0; r < d; ++r) work[plan_.relative_index[i] * d + r] += passed_on_[i * d + r];
    solve_forward(L, work.data(), parallel);
    std::copy_n(work.data(), L.k, own);
    std::copy(work.begin() + L.k, work.begin() + L.m, passed_on_.begin() + plan_.tree.row_start[f] * d);
}

void Cholesky::solve_backward_one(int f, double* x, bool parallel) {
    thread_local std::vector<double> work;  // scratch, kept between calls
    const Front L = front(f, 0);
    const int d = plan_.d;
    work.resize(largest_front_);
    double* const own = x + offset(plan_.tree.first[f], d);
    std::copy_n(own, L.k, work.data());
    double* to = work.data() + L.k;
    for (std::size_t i = plan_.tree.row_start[f]; i < plan_.tree.row_start[f + 1]; ++i, to += d)
        std::copy_n(x + offset(plan_.tree.rows[i], d), d, to);
    solve_backward(L, work.data(), parallel);
    std::copy_n(work.data(), L.k, own);
}

void Cholesky::solve(const double* b, double* x) {
    const std::size_t d = plan_.d;
    const std::vector<int>& order = plan_.tree.order;
    const std::vector<FrontRange>& ranges = plan_.subtrees;
    const int subtrees = static_cast<int>(ranges.size()), nodes = static_cast<int>(order.size());
    double* const y = permuted_.data();
    parallel_for(nodes, [&](int i) { std::copy_n(b + order[i] * d, d, y + i * d); });
#pragma omp parallel for schedule(dynamic, 1) if (subtrees > 1)
    for (int s = 0; s < subtrees; ++s)
        for (int f = ranges[s].begin; f < ranges[s].end; ++f) solve_forward_one(f, y, false);
    const std::vector<std::vector<int>>& levels = plan_.levels;
    for (const std::vector<int>& level : levels)
        for_level(level, [&](int f, bool parallel) { solve_forward_one(f, y, parallel); });
    for (std::size_t l = levels.size(); l-- > 0;)
        for_level(levels[l], [&](int f, bool parallel) { solve_backward_one(f, y, parallel); });
#pragma omp parallel for schedule(dynamic, 1) if (subtrees > 1)
    for (int s = 0; s < subtrees; ++s)
        for (int f = ranges[s].end - 1; f >= ranges[s].begin; --f) solve_backward_one(f, y, false);
    parallel_for(nodes, [&](int i) { std::copy_n(y + i * d, d, x + order[i] * d); });
}

}  // namespace almesh
