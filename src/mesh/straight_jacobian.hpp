// The affine map of a straight-sided simplex: A = dy / dxi, whose column k is the edge from vertex 0 to vertex k + 1.
#pragma once
#include <cstddef>
#include <vector>

#include "base/small_matrix.hpp"

namespace almesh {

// vertex: n + 1 nodes, the first of an element in any degree. y: nodes x n.
template <int n>
Mat<n> straight_jacobian(const int* vertex, const std::vector<double>& y) {
    const double* const y0 = &y[static_cast<std::size_t>(vertex[0]) * n];
    Mat<n> A;
    for (int a = 0; a < n; ++a)
        for (int k = 0; k < n; ++k) A[a][k] = y[static_cast<std::size_t>(vertex[k + 1]) * n + a] - y0[a];
    return A;
}

}  // namespace almesh
