// What Krylov methods share: their result, when they give up, sums over a team of threads, and the interface of
// preconditioners z = M^{-1} r with M near A, for ConjugateGradients (M symmetric positive definite) and Gmres (M
// nonsingular).
//
// A Krylov method runs in one team of threads, all of which call apply() together. Its loops are therefore work-sharing
// loops, `#pragma omp for` without a `parallel` around them, which a thread that calls it outside of a team runs alone.
// To add a preconditioner, derive from Preconditioner and construct it in make_preconditioner() of linear_solver.cpp.
#pragma once
#include <algorithm>
#include <vector>

#include "linalg/block_csr.hpp"
#include "linalg/solve_status.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

struct KrylovResult {
    SolveStatus status;
    int iterations;            // products with A
    double relative_residual;  // |b - A x|_2 / |b|_2, computed from the x returned
};

// An iteration stagnates if the residual norm has not halved in the last twenty iterations. At that rate a reduction by
// 1e-8 takes more than five hundred, in which time a direct solver is done. As residual norms may oscillate, the
// smallest one counts.
struct StagnationTest {
    static constexpr int window = 20;
    double best;  // initially the residual norm before the first iteration
    double best_before = best;
    int count = 0;

    // residual: its norm after one more iteration.
    bool stagnates(double residual) {
        best = std::min(best, residual);
        if (++count % window != 0) return false;
        const bool stagnated = best > 0.5 * best_before;
        best_before = best;
        return stagnated;
    }
};

class Preconditioner {
public:
    virtual ~Preconditioner() = default;

    // Sets M up for the values of A, whose pattern and order of the unknowns are those of the constructor. Not called
    // by a team; apply() needs a success.
    virtual FactorResult factor(const BlockCsr& A) = 0;

    // z = M^{-1} r; returns r'z, which sweeps often give for free. r, z: A.size(), different arrays. When it returns on
    // one thread, all of z is written: the last loop ends in a barrier. All threads get the same r'z, with the same
    // bits for any number of threads.
    virtual double apply(const double* r, double* z) = 0;

    // For those that require it of the x from which conjugate gradients start: x += y, given r = b - A x; returns r'y.
    // Called like apply(). By default y = 0, for which 0 is returned.
    virtual double correct_start(const double* /*r*/, double* /*x*/) { return 0; }
};

// A sum over the unknowns for all threads of a team, by fixed blocks: the bits do not depend on the number of threads.
// A thread may still be adding up when others go on, so each sum of an iteration has an object of its own.
class TeamSum {
public:
    explicit TeamSum(int size) : size_(size), partial_((size + block - 1) / block) {}

    // Sum of term(begin, count) over the blocks of unknowns begin .. begin + count-1; no node is split among blocks.
    template <class Term>
    double operator()(const Term& term) {
        const int blocks = static_cast<int>(partial_.size());
#pragma omp for schedule(static)
        for (int b = 0; b < blocks; ++b) partial_[b] = term(b * block, std::min(block, size_ - b * block));
        double sum = 0;
        for (double value : partial_) sum += value;
        return sum;
    }

private:
    static constexpr int block = 768;  // a multiple of 1, 2 and 3 unknowns per node
    int size_;
    std::vector<double> partial_;
};

}  // namespace almesh
