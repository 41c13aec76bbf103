// Small dense systems and eigenproblems.
#pragma once
#include <vector>

namespace almesh {

// Solves the k x k system A s = b (A row-major) by Gaussian elimination with partial pivoting, for all columns of b, k
// rows; false where a pivot is below `smallest` times the largest entry of A.
bool solve_dense(std::vector<double> A, std::vector<double> b, std::vector<double>& s, double smallest = 1e-14);

// Leaves the eigenvalues of the symmetric n x n matrix A (row-major) on its diagonal, and the eigenvectors in the
// columns of V: by Jacobi's rotations.
void diagonalise(int n, double* A, double* V);

}  // namespace almesh
