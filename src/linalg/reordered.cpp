#include "linalg/reordered.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "linalg/graph.hpp"

namespace almesh {

Reordered::Reordered(const BlockCsr& pattern, std::vector<int> order)
    : order_(std::move(order)), matrix_(permuted_pattern(pattern, order_, source_)) {}

void Reordered::set(const BlockCsr& A) {
    const int block = A.d * A.d;
    parallel_for(matrix_.blocks(), [&](int k) { std::copy_n(A.block(source_[k]), block, matrix_.block(k)); });
}

void Reordered::gather(const double* x, double* y) const {
    const std::size_t d = matrix_.d;
    parallel_for(matrix_.n, [&](int i) { std::copy_n(x + order_[i] * d, d, y + i * d); });
}

void Reordered::scatter(const double* y, double* x) const {
    const std::size_t d = matrix_.d;
    parallel_for(matrix_.n, [&](int i) { std::copy_n(y + i * d, d, x + order_[i] * d); });
}

}  // namespace almesh
