#include "base/lanes.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace almesh;

namespace {

Lanes counting() {
    Lanes v{};
    for (int l = 0; l < lanes; ++l) v[l] = l - 1;
    return v;
}

}  // namespace

TEST_CASE("every lane is worked on by itself") {
    const Lanes v = counting();
    for (int l = 0; l < lanes; ++l) {
        CHECK(select(v < 0, v - 5, 2 * v)[l] == (l == 0 ? -6 : 2 * (l - 1)));
        CHECK(abs(v)[l] == std::abs(l - 1));
        CHECK(max(v, in_all_lanes(0.5))[l] == std::max(l - 1, 0) + (l < 2 ? 0.5 : 0));
        CHECK(sqrt(v * v)[l] == std::abs(l - 1));
        CHECK(in_all_lanes(7)[l] == 7);
    }
    CHECK(sum_of_lanes(v) == lanes * (lanes - 1) / 2 - lanes);
}

TEST_CASE("numbers that come in batches are summed as if there were the most lanes") {
    double apart[most_lanes] = {}, expected = 0;
    SumOfBatches sum;
    for (int k = 0; k < 40; k += lanes) {
        Lanes batch;
        for (int l = 0; l < lanes; ++l) batch[l] = std::exp(0.7 * (k + l));
        sum.add(batch, k / lanes);
    }
    for (int k = 0; k < 40; ++k) apart[k % most_lanes] += std::exp(0.7 * k);
    for (const double part : apart) expected += part;
    CHECK(sum.total() == expected);
    CHECK(sum_of_lanes(counting(), 0.5) == sum_of_lanes(counting()) + 0.5);
}

TEST_CASE("rows of lanes are transposed") {
    Lanes rows[lanes];
    for (int i = 0; i < lanes; ++i)
        for (int l = 0; l < lanes; ++l) rows[i][l] = 10 * i + l;
    transpose_lanes(rows);
    for (int i = 0; i < lanes; ++i)
        for (int l = 0; l < lanes; ++l) CHECK(double(rows[i][l]) == 10 * l + i);
}

TEST_CASE("any sees the first and the last lane") {
    const Lanes v = counting();
    CHECK(any(v < 0));
    CHECK(any(v == lanes - 2));
    CHECK(!any(v > lanes));
}

TEST_CASE("the inverse cube root is that of the library to four units in the last place, over the whole range") {
    double worst = 0;
    for (double v = 1e-300; v < 1e300; v *= 1.37) {
        const Lanes root = inverse_cbrt(in_all_lanes(v));
        for (int l = 0; l < lanes; ++l) worst = std::max(worst, std::abs(root[l] * std::cbrt(v) - 1));
    }
    CHECK(worst < 4 * 2.3e-16);
    CHECK(inverse_cbrt(8.0) == 0.5);
}
