// When an iteration no longer pays: the residual has not halved in the last twenty iterations. At that rate 1e-8 takes
// more than five hundred, in which time a direct solver is done. Of residuals that go up and down the best one counts.
#pragma once
#include <algorithm>

namespace almesh {

struct StagnationTest {
    static constexpr int window = 20;
    double best;  // initially the residual before the first iteration
    double best_before = best;
    int count = 0;

    // residual: after one more iteration.
    bool stagnates(double residual) {
        best = std::min(best, residual);
        if (++count % window != 0) return false;
        const bool stands = best > 0.5 * best_before;
        best_before = best;
        return stands;
    }
};

}  // namespace almesh
