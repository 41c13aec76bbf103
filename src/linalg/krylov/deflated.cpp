// z = M^{-1} r, then z += Z c with E c = Z'r - (Z'A) z. Z'A has a row for each group, stored as the union of the rows
// of A in the group; E is factored by sparse Cholesky.
#include "linalg/krylov/deflated.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/multilevel.hpp"

namespace almesh {

namespace {

// Nodes in a group. Smaller groups save iterations where A has low-energy modes, and make every iteration cost more.
constexpr int group_size = 200;

// The group of every node: the graph is coarsened until a vertex represents `group_size` nodes.
std::vector<int> grouped(const Graph& graph) {
    return coarsen(graph, 2 * group_size, std::numeric_limits<int>::max(), graph.size() / group_size + 1).coarse_of;
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

CoarseSpace::CoarseSpace(const BlockCsr& pattern)
    : group_(grouped(graph_of(pattern))),
      E_(coarse_pattern(pattern, group_)),
      members_(sorted_by_group(group_, groups())),
      factor_(E_),
      r_(E_.size()),
      c_(E_.size()) {
    ZA_.n = groups();
    ZA_.d = pattern.d;
    ZA_.row.assign(1, 0);
    place_.resize(pattern.blocks());
    std::vector<int> place_of(pattern.n, -1);  // of a column in the current row
    for (int g = 0; g < groups(); ++g) {
        const int first = static_cast<int>(ZA_.col.size());
        for (int i : members_.of(g))
            for (int k = pattern.row[i]; k < pattern.row[i + 1]; ++k) {
                const int j = pattern.col[k];
                if (place_of[j] < first) {
                    place_of[j] = static_cast<int>(ZA_.col.size());
                    ZA_.col.push_back(j);
                    coarse_place_.push_back(E_.find(g, group_[j]));
                }
                place_[k] = place_of[j];
            }
        ZA_.row.push_back(static_cast<int>(ZA_.col.size()));
    }
    ZA_.value.resize(ZA_.col.size() * pattern.d * pattern.d);
}

// Z'A and E = (Z'A) Z, row by row.
template <int d>
void CoarseSpace::add_up_rows(const BlockCsr& A) {
    constexpr int block = d * d;
    const auto add = [](const double* from, double* to) {
        for (int e = 0; e < block; ++e) to[e] += from[e];
    };
    const auto make_row = [&](int g) {
        std::fill_n(ZA_.block(ZA_.row[g]), offset(ZA_.row[g + 1] - ZA_.row[g], block), 0.0);
        for (int i : members_.of(g))
            for (int k = A.row[i]; k < A.row[i + 1]; ++k) add(A.block(k), ZA_.block(place_[k]));
        std::fill_n(E_.block(E_.row[g]), offset(E_.row[g + 1] - E_.row[g], block), 0.0);
        for (int k = ZA_.row[g]; k < ZA_.row[g + 1]; ++k) add(ZA_.block(k), E_.block(coarse_place_[k]));
    };
    parallel_for(groups(), make_row, static_cast<double>(A.value.size()) / std::max(1, groups()));
}

FactorResult CoarseSpace::factor(const BlockCsr& A) {
    with_block_size(A.d, [&](auto d) { add_up_rows<d>(A); });
    return {factor_.factor(E_).status};
}

// r_ = Z'r and c_ = Z'(r - A z).
template <int d>
void CoarseSpace::restrict_residual(const double* r, const double* z) {
#pragma omp for schedule(static)
    for (int g = 0; g < groups(); ++g) {
        double sum[d] = {};
        SumOfProducts<d> product;
        for (int i : members_.of(g))
            for (int a = 0; a < d; ++a) sum[a] += r[offset(i, d, a)];
        for (int k = ZA_.row[g]; z && k < ZA_.row[g + 1]; ++k) product.add(ZA_.block(k), z + offset(ZA_.col[k], d));
        for (int a = 0; a < d; ++a) {
            r_[offset(g, d, a)] = sum[a];
            c_[offset(g, d, a)] = sum[a] - product.entry(a);
        }
    }
}

double CoarseSpace::correct(const double* r, const double* z, double* x) {
    const int d = E_.d;
    with_block_size(d, [&](auto size) { restrict_residual<size>(r, z); });
#pragma omp single
    {
        factor_.solve(c_.data(), c_.data());
        rZc_ = std::inner_product(r_.begin(), r_.end(), c_.begin(), 0.0);
    }
    const double rZc = rZc_;  // not written again before the next barrier
#pragma omp for schedule(static)
    for (int node = 0; node < static_cast<int>(group_.size()); ++node)
        for (int a = 0; a < d; ++a) x[offset(node, d, a)] += c_[offset(group_[node], d, a)];
    return rZc;
}

Deflated::Deflated(std::unique_ptr<Preconditioner> M, std::unique_ptr<CoarseSpace> coarse)
    : M_(std::move(M)), coarse_(std::move(coarse)) {}

FactorResult Deflated::factor(const BlockCsr& A) {
    FactorResult result = M_->factor(A);
    if (result.status == SolveStatus::success) result.status = coarse_->factor(A).status;
    return result;
}

double Deflated::apply(const double* r, double* z) {
    const double rz = M_->apply(r, z);
    return rz + coarse_->correct(r, z, z);
}

double Deflated::correct_start(const double* r, double* x) { return coarse_->correct(r, nullptr, x); }

}  // namespace almesh
