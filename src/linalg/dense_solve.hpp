// Small dense systems.
#pragma once
#include <vector>

namespace almesh {

// Solves the k x k system A s = b (A row-major) by Gaussian elimination with partial pivoting; false where a pivot is
// below `smallest` times the largest entry of A.
bool solve_dense(std::vector<double> A, std::vector<double> b, std::vector<double>& s, double smallest = 1e-14);

}  // namespace almesh
