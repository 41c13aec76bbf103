// Fixed nodes of a minimisation (a strong Dirichlet condition): their entries of the gradient are set to zero, and
// their rows and columns of the Hessian to those of the unit matrix, so that no step moves them.
#pragma once
#include <algorithm>
#include <vector>

#include "base/index.hpp"
#include "linalg/block_csr.hpp"

namespace almesh {

// fixed: per node; empty: none is. g: node_count x dim.
inline void fix_nodes(const std::vector<char>& fixed, int dim, std::vector<double>& g) {
    for (std::size_t i = 0; i < fixed.size(); ++i)
        if (fixed[i]) std::fill_n(&g[offset(i, dim)], dim, 0.0);
}

inline void fix_nodes(const std::vector<char>& fixed, BlockCsr& H) {
    for (int i = 0; i < H.n && !fixed.empty(); ++i) {
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            if (!fixed[H.node_of(i)] && !fixed[H.node_of(H.col[k])]) continue;
            H.change_block(i, H.col[k], [&H](double* block) { std::fill_n(block, H.d * H.d, 0.0); });
        }
        for (int ab = 0; ab < H.d * H.d && fixed[H.node_of(i)]; ++ab) H.diagonal(i)[ab] = ab % (H.d + 1) == 0;
    }
}

// A v for vectors in the order of the nodes, whatever the order of A's rows.
inline std::vector<double> times_at_nodes(const BlockCsr& A, const std::vector<double>& v) {
    std::vector<double> rows, product(v.size()), result;
    to_rows(A, v, rows);
    multiply(A, rows.data(), product.data());
    to_nodes(A, product, result);
    return result;
}

}  // namespace almesh
