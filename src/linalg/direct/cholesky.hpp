// Sparse Cholesky factorisation A = L L' by the multifrontal method (Duff & Reid, ACM Trans. Math. Softw. 9, 1983;
// Liu, SIAM Review 34, 1992): every front of the assembly tree gathers its columns of A and the update matrices of its
// children, eliminates its columns by dense kernels and passes its own update matrix on.
//
// Analysis (ordering of the node graph, by default nested dissection) once per pattern, then any number of
// factorisations. Parallel over independent subtrees and fronts and inside the large fronts above them; same bits for
// any number of threads.
#pragma once
#include <atomic>
#include <vector>

#include "base/large_array.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/direct/dense_kernels.hpp"
#include "linalg/direct/factor_plan.hpp"
#include "linalg/ordering/ordering.hpp"
#include "linalg/solve_status.hpp"

namespace almesh {

struct CholeskyParams {
    double memory_limit = 0;  // bytes the factorisation may take; 0: the machine's physical memory
    Ordering ordering = Ordering::nested_dissection;
};

class Cholesky {
public:
    // pattern: symmetric with both triangles and the diagonal, d = 1, 2, 3.
    explicit Cholesky(const BlockCsr& pattern, const CholeskyParams& params = {});

    double factor_entries() const { return plan_.factor_entries; }  // scalar entries of L
    double flops() const { return plan_.flops; }
    double predicted_bytes() const;                                 // with the number of threads now in force
    bool fits() const;                                              // predicted_bytes() within the limit

    // A: values on the pattern of the constructor; its upper triangle in elimination order is ignored. Allocates in the
    // first call and when the number of threads has grown. Stops early at a bad pivot:
    // not_positive_definite; too_large: nothing is allocated.
    FactorResult factor(const BlockCsr& A);

    // x = A^{-1} b with the last factorisation, which must have succeeded. b, x: n*d; they may be the same array.
    void solve(const double* b, double* x);

private:
    void allocate();
    Front front(int f, int thread);
    int factor_one(const BlockCsr& A, int f, int thread, bool parallel);
    void factor_fronts(const BlockCsr& A, FrontRange range, bool parallel, std::atomic<int>& first_bad);
    void gather_entries(const BlockCsr& A, int f, const Front& target, bool parallel);
    void solve_front(int f, bool forward, double* x, bool parallel);

    CholeskyParams params_;
    FactorPlan plan_;
    LargeVector<double> factor_;              // panels of all fronts
    LargeVector<double> updates_;             // shared memory, then that of each thread
    std::vector<int> unfinished_;             // children of each single front that are not done yet; others: <= 0
    int threads_ = 0;                         // number of threads there is memory for
    std::vector<double> smallest_;            // n*d: smallest acceptable pivot of each column
    std::vector<double> passed_on_;           // d per tree.rows: contributions to the right-hand side
    std::vector<double> permuted_;            // n*d: right-hand side, then solution, in elimination order
    int largest_front_ = 0;                   // scalar rows
};

}  // namespace almesh
