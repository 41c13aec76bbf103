// Dense matrices of the unknowns, row by row: for lessons with some hundred of them.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh::lessons {

// The rows and columns of K, a matrix of 2 x 2 blocks, that belong to the unknowns: entries of (x_0, y_0, x_1, ...).
inline std::vector<double> dense_part(const BlockCsr& K, const std::vector<int>& unknowns) {
    std::vector<double> A;
    for (const int i : unknowns)
        for (const int j : unknowns) {
            const int k = K.find(i / 2, j / 2);
            A.push_back(k < 0 ? 0 : K.block(k)[2 * (i % 2) + j % 2]);
        }
    return A;
}

// Of a symmetric n x n matrix: as many as Gaussian elimination without exchanges meets negative pivots (Sylvester's law
// of inertia).
inline int negative_eigenvalues(int n, std::vector<double> A) {
    int count = 0;
    for (int k = 0; k < n; ++k) {
        const double pivot = A[offset(k, n, k)];
        count += pivot < 0;
        for (int i = k + 1; i < n; ++i)
            if (const double factor = A[offset(i, n, k)] / pivot; factor != 0)
                for (int j = k; j < n; ++j) A[offset(i, n, j)] -= factor * A[offset(k, n, j)];
    }
    return count;
}

}  // namespace almesh::lessons
