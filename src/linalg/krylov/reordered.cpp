#include "linalg/krylov/reordered.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh {

Reordered::Reordered(const BlockCsr& pattern, std::vector<int> order)
    : order_(std::move(order)), matrix_(permuted_pattern(pattern, order_, source_)) {}

namespace {

// Block k of `to` is block source[k] of `from`. Of a length known here: a copy of any other is a call. The blocks are
// called from memory well before their turn, which comes in an order that the machine cannot guess.
template <int size>
void copy_blocks(const std::vector<int>& source, const double* from, double* to) {
    constexpr int ahead = 32;
    const int count = static_cast<int>(source.size());
    parallel_for(count, [&](int k) {
        const double* const later = from + static_cast<std::size_t>(source[std::min(k + ahead, count - 1)]) * size;
        __builtin_prefetch(later);
        __builtin_prefetch(later + size - 1);
        const double* const block = from + static_cast<std::size_t>(source[k]) * size;
        for (int e = 0; e < size; ++e) to[static_cast<std::size_t>(k) * size + e] = block[e];
    });
}

}  // namespace

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
