// The determinant of an element's map at a point, from the Lagrange basis: what bounds are tested with.
#pragma once
#include <vector>

#include "base/small_matrix.hpp"
#include "mesh/lagrange.hpp"

namespace almesh::test {

// node: those of the element, x: node_count x n, xi: n reference coordinates.
template <int n>
double determinant_at(const LagrangeBasis& basis, const int* node, const std::vector<double>& x, const double* xi) {
    std::vector<double> dN(static_cast<std::size_t>(basis.count) * n);
    basis.gradients(xi, dN.data());
    Mat<n> J{};
    for (int i = 0; i < basis.count; ++i)
        for (int a = 0; a < n; ++a)
            for (int k = 0; k < n; ++k) J[a][k] += x[node[i] * n + a] * dN[i * n + k];
    return determinant(J);
}

}  // namespace almesh::test
