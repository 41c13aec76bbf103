#include "linalg/vector_ops.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/parallel.hpp"
#include "support/matrices.hpp"

using namespace almesh;

TEST_CASE("sums of integers are exact at every length around the chunk sizes") {
    for (int n : {0, 1, 7, 8, 9, 63, 64, 65, 1000, 70000}) {
        std::vector<double> x(n), ones(n, 1.0);
        for (int i = 0; i < n; ++i) x[i] = i + 1;
        CHECK(dot(x, ones) == 0.5 * n * (n + 1));
        CHECK(norm_2(ones) == std::sqrt(n));
        CHECK(norm_inf(x) == n);
    }
}

TEST_CASE("vector updates") {
    const int n = 20000;  // long enough for threads
    std::vector<double> x(n, 2.0), y(n, 3.0), z(n);
    axpy(2, x, y);
    CHECK(y == std::vector<double>(n, 7.0));
    scale(n, 0.5, y.data());
    subtract(n, x.data(), y.data(), z.data());
    CHECK(z == std::vector<double>(n, -1.5));
    copy(n, x.data(), z.data());
    CHECK(z == x);
    fill(n, 4, z.data());
    CHECK(z == std::vector<double>(n, 4.0));
}

TEST_CASE("what is not a number is not overlooked") {
    std::vector<double> x(100, 1.0);
    x[37] = std::nan("");
    x[38] = 5;
    CHECK(std::isnan(norm_inf(x)));
    CHECK(std::isnan(norm_2(x)));
}

TEST_CASE("sums have the same bits for any number of threads") {
    const std::vector<double> x = random_vector(200001), y = random_vector(200001, 5);
    const int before = max_threads();
    set_threads(1);
    const double first = dot(x, y);
    for (int threads : {2, 3, 5}) {
        set_threads(threads);
        CHECK(dot(x, y) == first);
    }
    set_threads(before);
}
