#include "linalg/krylov/reordered.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh {

namespace {

// The pattern of A with rows and columns renumbered, its values undefined; source[k]: the block of A that block k comes
// from.
BlockCsr permuted_pattern(const BlockCsr& A, const std::vector<int>& order, std::vector<int>& source) {
    const std::vector<int> position = inverse(order);
    BlockCsr B;
    B.n = A.n;
    B.d = A.d;
    B.row.assign(1, 0);
    for (int v : order) B.row.push_back(B.row.back() + A.row[v + 1] - A.row[v]);
    source.resize(A.col.size());
    B.col.resize(A.col.size());
    parallel_for(A.n, [&](int i) {
        const auto begin = source.begin() + B.row[i], end = source.begin() + B.row[i + 1];
        std::iota(begin, end, A.row[order[i]]);
        std::sort(begin, end, [&](int a, int b) { return position[A.col[a]] < position[A.col[b]]; });
        std::transform(begin, end, B.col.begin() + B.row[i], [&](int k) { return position[A.col[k]]; });
    }, 500);
    B.value.resize(A.value.size());
    return B;
}

// Block k of `to` is block source[k] of `from`. The size is a template argument, so that a copy is not a call. Blocks
// of `from` come in a random order and are prefetched 32 blocks ahead.
template <int size>
void copy_blocks(const std::vector<int>& source, const double* from, double* to) {
    constexpr int ahead = 32;
    const int count = static_cast<int>(source.size());
    parallel_for(count, [&](int k) {
        const double* const later = from + offset(source[std::min(k + ahead, count - 1)], size);
        __builtin_prefetch(later);
        __builtin_prefetch(later + size - 1);
        const double* const block = from + offset(source[k], size);
        for (int e = 0; e < size; ++e) to[offset(k, size, e)] = block[e];
    });
}

}  // namespace

Reordered::Reordered(const BlockCsr& pattern, std::vector<int> order)
    : order_(std::move(order)), matrix_(permuted_pattern(pattern, order_, source_)) {}

void Reordered::set(const BlockCsr& A) {
    const double* const from = A.value.data();
    double* const to = matrix_.value.data();
    if (A.d == 1) copy_blocks<1>(source_, from, to);
    if (A.d == 2) copy_blocks<4>(source_, from, to);
    if (A.d == 3) copy_blocks<9>(source_, from, to);
}

void Reordered::gather(const double* x, double* y) const {
    const int d = matrix_.d;
    parallel_for(matrix_.n, [&](int i) {
        for (int a = 0; a < d; ++a) y[i * d + a] = x[order_[i] * d + a];
    });
}

void Reordered::scatter(const double* y, double* x) const {
    const int d = matrix_.d;
    parallel_for(matrix_.n, [&](int i) {
        for (int a = 0; a < d; ++a) x[order_[i] * d + a] = y[i * d + a];
    });
}

}  // namespace almesh
