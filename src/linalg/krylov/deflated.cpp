// A Z has a row for each node and a block for each group next to it; E is factored by sparse Cholesky.
#include "linalg/krylov/deflated.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
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

CoarseSpace::CoarseSpace(const BlockCsr& pattern, bool in_single)
    : group_(grouped(graph_of(pattern))), E_(coarse_pattern(pattern, group_)), in_single_(in_single) {
    AZ_ = {pattern.n, pattern.d, {0}};
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
    const std::size_t entries = AZ_.col.size() * pattern.d * pattern.d;
    if (in_single) single_.resize(entries);
    else AZ_.value.resize(entries);
}

// body(values of A Z).
template <class Body>
void CoarseSpace::with_values(const Body& body) const {
    if (in_single_) body(single_.data());
    else body(AZ_.value.data());
}

// A Z and E = Z'(A Z), row by row.
template <int d, class Number>
void CoarseSpace::add_up(const BlockCsr& A, Number* AZ) {
    constexpr int block = d * d;
    const auto add = [](const double* from, double* to) {
        for (int e = 0; e < block; ++e) to[e] += from[e];
    };
    const auto make_row = [&](int g) {
        thread_local std::vector<double> row;  // kept between calls
        std::fill_n(E_.block(E_.row[g]), offset(E_.row[g + 1] - E_.row[g], block), 0.0);
        for (const int i : members_.of(g)) {
            const int first = AZ_.row[i], count = AZ_.row[i + 1] - first;
            row.assign(offset(count, block), 0.0);
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                add(A.block(k), row.data() + offset(place_[k] - first, block));
            for (int k = 0; k < count; ++k)
                add(row.data() + offset(k, block), E_.block(coarse_place_[first + k]));
            std::copy(row.begin(), row.end(), AZ + offset(first, block));
        }
    };
    parallel_for(groups(), make_row, static_cast<double>(A.value.size()) / std::max(1, groups()));
}

FactorResult CoarseSpace::factor(const BlockCsr& A) {
    with_block_size(A.d, [&](auto d) {
        if (in_single_) add_up<d>(A, single_.data());
        else add_up<d>(A, AZ_.value.data());
    });
    return {factor_.factor(E_).status};
}

// sums = Z'v.
void CoarseSpace::sum_up_groups(const double* v, std::vector<double>& sums) {
    const int d = E_.d;
#pragma omp for schedule(static)
    for (int g = 0; g < groups(); ++g)
        for (int a = 0; a < d; ++a) {
            double sum = 0;
            for (const int i : members_.of(g)) sum += v[offset(i, d, a)];
            sums[offset(g, d, a)] = sum;
        }
}

// part_sum_ = (A Z)' z over each part of the nodes.
template <int d, class Number>
void CoarseSpace::add_transposed(const Number* AZ, const double* z) {
#pragma omp for schedule(dynamic, 1)
    for (int part = 0; part < parts; ++part) {
        Four* const sum = part_sum_.data() + offset(part, groups());
        std::fill_n(sum, groups(), Four{});
        const auto begin_of = [&](int p) { return static_cast<int>(static_cast<long long>(AZ_.n) * p / parts); };
        for (int i = begin_of(part); i < begin_of(part + 1); ++i)
            for (int k = AZ_.row[i]; k < AZ_.row[i + 1]; ++k)
                for (int a = 0; a < d; ++a)
                    for (int b = 0; b < d; ++b)
                        sum[AZ_.col[k]][b] += AZ[offset(k, d * d, a * d + b)] * z[offset(i, d, a)];
    }
}

// Az_ = Z'A z from the parts.
void CoarseSpace::sum_up_parts() {
    const int d = E_.d;
#pragma omp for schedule(static)
    for (int g = 0; g < groups(); ++g) {
        Four sum{};
        for (int part = 0; part < parts; ++part) sum += part_sum_[offset(part, groups(), g)];
        for (int a = 0; a < d; ++a) Az_[offset(g, d, a)] = sum[a];
    }
}

// c_ = E^{-1} (Z'r - Az_).
void CoarseSpace::solve(const double* r) {
    sum_up_groups(r, r_);
#pragma omp single
    {
        for (int i = 0; i < E_.size(); ++i) c_[i] = r_[i] - Az_[i];
        factor_.solve(c_.data(), c_.data());
        rZc_ = std::inner_product(r_.begin(), r_.end(), c_.begin(), 0.0);  // not written again before the next barrier
        AzZc_ = std::inner_product(Az_.begin(), Az_.end(), c_.begin(), 0.0);
    }
}

// z += Z c, Az += (A Z) c.
void CoarseSpace::add_to(double* z, double* Az) const {
    with_block_size(E_.d, [&](auto size) {
        constexpr int d = size;
        with_values([&](const auto* AZ) {
#pragma omp for schedule(static)
            for (int node = 0; node < static_cast<int>(group_.size()); ++node) {
                SumOfProducts<d> product;
                for (int k = AZ_.row[node]; k < AZ_.row[node + 1]; ++k)
                    product.add(AZ + offset(k, d * d), &c_[offset(AZ_.col[k], d)]);
                for (int a = 0; a < d; ++a) {
                    z[offset(node, d, a)] += c_[offset(group_[node], d, a)];
                    Az[offset(node, d, a)] += product.entry(a);
                }
            }
        });
    });
}

double CoarseSpace::correct_start(const double* r, double* x) {
    const int d = E_.d;
#pragma omp for schedule(static)
    for (int i = 0; i < E_.size(); ++i) Az_[i] = 0;
    solve(r);
#pragma omp for schedule(static)
    for (int node = 0; node < static_cast<int>(group_.size()); ++node)
        for (int a = 0; a < d; ++a) x[offset(node, d, a)] += c_[offset(group_[node], d, a)];
    return rZc_;
}

double CoarseSpace::correct(const double* r, double* z, double* Az) {
    sum_up_groups(Az, Az_);
    solve(r);
    add_to(z, Az);
    return rZc_;
}

// With the correction Z c: (z + Z c)'A (z + Z c) = z'A z + 2 c'Z'A z + c'E c, and E c = Z'(r - A z).
void CoarseSpace::correct_put_off(const double* r, double* z, double* Az, Products& of_z) {
    with_block_size(E_.d, [&](auto d) {
        with_values([&](const auto* AZ) { add_transposed<d>(AZ, z); });
    });
    sum_up_parts();
    solve(r);
    of_z.rz += rZc_;
    of_z.zAz += rZc_ + AzZc_;
    add_to(z, Az);
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

Products Deflated::apply_and_put_off(const double* r, double* z, double* Az) {
    Products of_z = M_->apply_and_put_off(r, z, Az);
    coarse_->correct_put_off(r, z, Az, of_z);
    return of_z;
}

Products Deflated::advance(double alpha, double beta, double* q, double* r, double* z, double* Az) {
    Products of_z = M_->advance(alpha, beta, q, r, z, Az);
    coarse_->correct_put_off(r, z, Az, of_z);
    return of_z;
}

double Deflated::correct_start(const double* r, double* x) { return coarse_->correct_start(r, x); }

}  // namespace almesh
