// What Krylov methods return, and when they give up.
#pragma once
#include <algorithm>

#include "linalg/solve_status.hpp"

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

}  // namespace almesh
