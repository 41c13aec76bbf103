// z = M^{-1} r and A z, then z += Z c and A z += (A Z) c with E c = Z'(r - A z). A Z has a row for each node and a
// block for each group next to it; E is factored by sparse Cholesky.
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
    AZ_.n = pattern.n;
    AZ_.d = pattern.d;
    AZ_.row.assign(1, 0);
    place_.resize(pattern.blocks());
    std::vector<int> place_of(groups(), -1);  // of a group in the current row
    for (int i = 0; i < pattern.n; ++i) {
        const int first = static_cast<int>(AZ_.col.size());
        for (int k = pattern.row[i]; k < pattern.row[i + 1]; ++k) {
            const int g = group_[pattern.col[k]];
            if (place_of[g] < first) {
                place_of[g] = static_cast<int>(AZ_.col.size());
                AZ_.col.push_back(g);
                coarse_place_.push_back(E_.find(group_[i], g));
            }
            place_[k] = place_of[g];
        }
        AZ_.row.push_back(static_cast<int>(AZ_.col.size()));
    }
    AZ_.value.resize(AZ_.col.size() * pattern.d * pattern.d);
}

// A Z and E = Z'(A Z), row by row.
template <int d>
void CoarseSpace::add_up(const BlockCsr& A) {
    constexpr int block = d * d;
    const auto add = [](const double* from, double* to) {
        for (int e = 0; e < block; ++e) to[e] += from[e];
    };
    const auto make_row = [&](int g) {
        std::fill_n(E_.block(E_.row[g]), offset(E_.row[g + 1] - E_.row[g], block), 0.0);
        for (const int i : members_.of(g)) {
            std::fill_n(AZ_.block(AZ_.row[i]), offset(AZ_.row[i + 1] - AZ_.row[i], block), 0.0);
            for (int k = A.row[i]; k < A.row[i + 1]; ++k) add(A.block(k), AZ_.block(place_[k]));
            for (int k = AZ_.row[i]; k < AZ_.row[i + 1]; ++k) add(AZ_.block(k), E_.block(coarse_place_[k]));
        }
    };
    parallel_for(groups(), make_row, static_cast<double>(A.value.size()) / std::max(1, groups()));
}

FactorResult CoarseSpace::factor(const BlockCsr& A) {
    with_block_size(A.d, [&](auto d) { add_up<d>(A); });
    return {factor_.factor(E_).status};
}

// c_ = E^{-1} Z'(r - A z); returns r'Z c.
double CoarseSpace::solve(const double* r, const double* Az) {
    const int d = E_.d;
#pragma omp for schedule(static)
    for (int g = 0; g < groups(); ++g)
        for (int a = 0; a < d; ++a) {
            double of_r = 0, of_Az = 0;
            for (const int i : members_.of(g)) {
                of_r += r[offset(i, d, a)];
                if (Az) of_Az += Az[offset(i, d, a)];
            }
            r_[offset(g, d, a)] = of_r;
            c_[offset(g, d, a)] = of_r - of_Az;
        }
#pragma omp single
    {
        factor_.solve(c_.data(), c_.data());
        rZc_ = std::inner_product(r_.begin(), r_.end(), c_.begin(), 0.0);
    }
    return rZc_;  // not written again before the next barrier
}

double CoarseSpace::correct_start(const double* r, double* x) {
    const int d = E_.d;
    const double rZc = solve(r, nullptr);
#pragma omp for schedule(static)
    for (int node = 0; node < static_cast<int>(group_.size()); ++node)
        for (int a = 0; a < d; ++a) x[offset(node, d, a)] += c_[offset(group_[node], d, a)];
    return rZc;
}

double CoarseSpace::correct(const double* r, double* z, double* Az) {
    const double rZc = solve(r, Az);
    with_block_size(E_.d, [&](auto size) {
        constexpr int d = size;
#pragma omp for schedule(static)
        for (int node = 0; node < static_cast<int>(group_.size()); ++node) {
            SumOfProducts<d> product;
            for (int k = AZ_.row[node]; k < AZ_.row[node + 1]; ++k)
                product.add(AZ_.block(k), &c_[offset(AZ_.col[k], d)]);
            for (int a = 0; a < d; ++a) {
                z[offset(node, d, a)] += c_[offset(group_[node], d, a)];
                Az[offset(node, d, a)] += product.entry(a);
            }
        }
    });
    return rZc;
}

Deflated::Deflated(std::unique_ptr<Preconditioner> M, std::unique_ptr<CoarseSpace> coarse)
    : M_(std::move(M)), coarse_(std::move(coarse)) {}

FactorResult Deflated::factor(const BlockCsr& A) {
    FactorResult result = M_->factor(A);
    if (result.status == SolveStatus::success) result.status = coarse_->factor(A).status;
    A_ = &A;
    Az_.resize(A.size());
    return result;
}

double Deflated::apply_and_multiply(const BlockCsr& A, const double* r, double* z, double* Az) {
    const double rz = M_->apply_and_multiply(A, r, z, Az);
    return rz + coarse_->correct(r, z, Az);
}

double Deflated::correct_start(const double* r, double* x) { return coarse_->correct_start(r, x); }

}  // namespace almesh
