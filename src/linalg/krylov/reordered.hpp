// A matrix in another order of its nodes, P A P', with the vectors to go with it.
//
// A mesh generator's numbering has the neighbours of a node anywhere in memory. Iterative solvers pass over the matrix
// dozens of times, so they work on a copy in the order of their preconditioner (domains.hpp), in which rows that are
// near have near columns: one pass to copy, and every product and sweep after it finds its vectors in the cache.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

class Reordered {
public:
    // pattern: of all matrices to come. order[new] = old, a permutation of its nodes.
    Reordered(const BlockCsr& pattern, std::vector<int> order);

    const std::vector<int>& order() const { return order_; }
    const BlockCsr& matrix() const { return matrix_; }  // P A P', its values undefined before the first set()

    void set(const BlockCsr& A);                      // A: on the pattern given to the constructor
    void gather(const double* x, double* y) const;   // y = P x; x, y: n*d
    void scatter(const double* y, double* x) const;  // x = P' y

private:
    std::vector<int> order_, source_;  // source_: block of A for each block of P A P'
    BlockCsr matrix_;
};

}  // namespace almesh
