#include "linalg/krylov/convergence.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace almesh;

namespace {

// Iterations until the test fires on the residuals rate^k, at most 1000.
int iterations_at(double rate) {
    StagnationTest test{1};
    for (int k = 1; k <= 1000; ++k)
        if (test.stagnates(std::pow(rate, k))) return k;
    return 1000;
}

}  // namespace

TEST_CASE("twenty iterations must halve the residual") {
    CHECK(iterations_at(0.95) == 1000);  // 0.95^20 = 0.36
    CHECK(iterations_at(0.99) == 20);    // 0.99^20 = 0.82
    CHECK(iterations_at(1.0) == 20);
    CHECK(iterations_at(2.0) == 20);
}

TEST_CASE("the best residual of each window counts, and only what came since the window before") {
    StagnationTest test{1};
    for (int k = 1; k <= 200; ++k) CHECK_FALSE(test.stagnates((k % 7 == 0 ? 1 : 100) * std::pow(0.9, k)));
    StagnationTest late{1};
    int fired = 0;
    for (int k = 1; k <= 60 && !fired; ++k) fired = late.stagnates(std::pow(0.5, std::min(k, 30))) ? k : 0;
    CHECK(fired == 60);
}
