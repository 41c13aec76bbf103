#include "linalg/krylov/deflation.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "linalg/ordering/coarsening.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/small_blocks.hpp"

namespace almesh {

namespace {

// Nodes in a group. Smaller groups save iterations, but only where A is soft, and make each one dearer everywhere.
constexpr int group_size = 200;

// The group of every node: the graph is coarsened until a vertex stands for `group_size` nodes or it gets no coarser.
std::vector<int> grouped(const Graph& graph) {
    const int n = graph.size();
    WeightedGraph coarse{graph.start, graph.adjacent, std::vector<int>(graph.adjacent.size(), 1),
                         std::vector<int>(n, 1)};
    std::vector<int> group(n);
    std::iota(group.begin(), group.end(), 0);
    for (int step = 0; coarse.size() > n / group_size + 1; ++step) {
        Coarsening next = coarsen(coarse, 2 * group_size, step);
        if (next.graph.size() == coarse.size()) break;
        for (int& g : group) g = next.coarse_of[g];
        coarse = std::move(next.graph);
    }
    return group;
}

// The pattern of E: groups are neighbours where their nodes are.
BlockCsr coarse_pattern(const BlockCsr& A, const std::vector<int>& group) {
    std::vector<int> pairs;
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            if (group[A.col[k]] > group[i]) pairs.insert(pairs.end(), {group[i], group[A.col[k]]});
    const int groups = A.n > 0 ? *std::max_element(group.begin(), group.end()) + 1 : 0;
    return matrix_of_cells(groups, A.d, pairs, 2);
}

}  // namespace

Deflation::Deflation(const BlockCsr& pattern)
    : group_(grouped(graph_of(pattern))),
      E_(coarse_pattern(pattern, group_)),
      factor_(E_),
      r_(E_.size()),
      c_(E_.size()) {
    member_.resize(pattern.n);
    std::iota(member_.begin(), member_.end(), 0);
    std::stable_sort(member_.begin(), member_.end(), [&](int a, int b) { return group_[a] < group_[b]; });
    place_.resize(pattern.blocks());
    std::vector<int> place_of(pattern.n, -1);  // of a column in the row at hand
    for (int g = 0, m = 0; g < groups(); ++g) {
        const int first = static_cast<int>(col_.size());
        for (; m < pattern.n && group_[member_[m]] == g; ++m)
            for (int k = pattern.row[member_[m]]; k < pattern.row[member_[m] + 1]; ++k) {
                const int j = pattern.col[k];
                if (place_of[j] < first) {
                    place_of[j] = static_cast<int>(col_.size());
                    col_.push_back(j);
                    coarse_place_.push_back(E_.find(g, group_[j]));
                }
                place_[k] = place_of[j];
            }
        member_start_.push_back(m);
        row_.push_back(static_cast<int>(col_.size()));
    }
    value_.resize(col_.size() * pattern.d * pattern.d);
}

// Z'A and E = (Z'A) Z, row by row.
template <int d>
void Deflation::add_up_rows(const BlockCsr& A) {
    constexpr int block = d * d;
    const auto add = [](const double* from, double* to) {
        for (int e = 0; e < block; ++e) to[e] += from[e];
    };
    const auto make_row = [&](int g) {
        double* const row = value_.data() + static_cast<std::size_t>(row_[g]) * block;
        std::fill_n(row, static_cast<std::size_t>(row_[g + 1] - row_[g]) * block, 0.0);
        for (int m = member_start_[g]; m < member_start_[g + 1]; ++m)
            for (int k = A.row[member_[m]]; k < A.row[member_[m] + 1]; ++k)
                add(A.block(k), value_.data() + static_cast<std::size_t>(place_[k]) * block);
        std::fill_n(E_.block(E_.row[g]), static_cast<std::size_t>(E_.row[g + 1] - E_.row[g]) * block, 0.0);
        for (int k = row_[g]; k < row_[g + 1]; ++k)
            add(value_.data() + static_cast<std::size_t>(k) * block, E_.block(coarse_place_[k]));
    };
    parallel_for(groups(), make_row, static_cast<double>(A.value.size()) / std::max(1, groups()));
}

bool Deflation::factor(const BlockCsr& A) {
    if (A.d == 1) add_up_rows<1>(A);
    if (A.d == 2) add_up_rows<2>(A);
    if (A.d == 3) add_up_rows<3>(A);
    return factor_.factor(E_).status == CholeskyStatus::factored;
}

// r_ = Z'r and c_ = Z'(r - A z).
template <int d>
void Deflation::restrict_residual(const double* r, const double* z) {
#pragma omp for schedule(static)
    for (int g = 0; g < groups(); ++g) {
        double sum[d] = {};
        SumOfProducts<d> product;
        for (int m = member_start_[g]; m < member_start_[g + 1]; ++m)
            for (int a = 0; a < d; ++a) sum[a] += r[static_cast<std::size_t>(member_[m]) * d + a];
        for (int k = row_[g]; z && k < row_[g + 1]; ++k)
            product.add(value_.data() + static_cast<std::size_t>(k) * d * d, z + static_cast<std::size_t>(col_[k]) * d);
        for (int a = 0; a < d; ++a) {
            r_[static_cast<std::size_t>(g) * d + a] = sum[a];
            c_[static_cast<std::size_t>(g) * d + a] = sum[a] - product.entry(a);
        }
    }
}

double Deflation::solve_in_team(const double* r, const double* z) {
    if (E_.d == 1) restrict_residual<1>(r, z);
    if (E_.d == 2) restrict_residual<2>(r, z);
    if (E_.d == 3) restrict_residual<3>(r, z);
#pragma omp single
    {
        factor_.solve(c_.data(), c_.data());
        rZc_ = std::inner_product(r_.begin(), r_.end(), c_.begin(), 0.0);
    }
    return rZc_;  // not written again before the next two waits
}

}  // namespace almesh
