// Exercises of lesson 10. Answers go into 10.cpp; `make check-lesson-10` says which hold.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh::lessons {

using Vector = std::vector<double>;

// 10.1 y = A x for a symmetric A of which `lower` has the lower triangle with the diagonal only (d = 1): row i of it is
// lower.col[k], lower.value[k], k = lower.row[i] ... lower.row[i + 1] - 1.
Vector multiply_symmetric(const BlockCsr& lower, const Vector& x);

// 10.2 Entries of the Cholesky factor L, the diagonal included, of a matrix with the pattern of `graph`, its vertices
// eliminated in the order 0, 1, 2, ...: eliminating a vertex joins all its later neighbours to each other.
int factor_entries(const Graph& graph);

// 10.3 An order (order[new] = old) in which a tree is eliminated without fill. `tree` is a connected graph without
// cycles, of at least one vertex.
std::vector<int> order_of_tree(const Graph& tree);

// 10.4 One step of conjugate gradients for A x = b, without a preconditioner; r = b - A x, p the search direction.
struct CgState {
    Vector x, r, p;
};
void cg_step(const BlockCsr& A, CgState& state);

// 10.5 The number of steps after which conjugate gradients are sure to have reduced the energy norm of the error by
// `factor` < 1, from |e_k| <= 2 ((sqrt(kappa) - 1) / (sqrt(kappa) + 1))^k |e_0|; kappa > 1 is the condition number.
int sufficient_steps(double kappa, double factor);

// 10.6 Nested dissection of a grid of rows x columns points, point i * columns + j joined to its neighbours in row i and
// column j. The order (order[new] = old), and the entries of L that it leads to, foretold to a few per cent by adding
// up s^2/2 + s b over all separators: s points with b points around their piece that come later.
std::vector<int> dissection_of_grid(int rows, int columns);
double entries_foretold(int rows, int columns);

}  // namespace almesh::lessons
