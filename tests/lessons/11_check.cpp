#include "lessons/exercises/11.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(growth_exponent, predicted_entries, sum_in_pieces, crossover, lines_loaded, product_rate);

EXERCISE("11.1", "the exponent of a growth") {
    expect_close("the exponent of t = n^2 from 10 to 20", growth_exponent(10, 100, 20, 400), 2, 1e-12,
                 "the slope in logarithmic axes");
    expect_close("the exponent of t = 7 n^1.5 from 4 to 9", growth_exponent(4, 56, 9, 189), 1.5, 1e-12,
                 "the slope between the points in logarithmic axes: a factor before n does not count");
    expect_close("the exponent of a constant", growth_exponent(3, 5, 8, 5), 0, 1e-12,
                 "it has the slope 0 in logarithmic axes");
}

EXERCISE("11.2", "a factor predicted") {
    expect_close("2D, twice the unknowns from 1000, ratio of nnz(L)", predicted_entries(2, 1000, 1, 2000),
                 2 * std::log(2000) / std::log(1000), 1e-12, "proportional to n log n, not to n");
    expect_close("3D, eight times the unknowns, ratio of nnz(L)", predicted_entries(3, 1000, 1, 8000), 16, 1e-12,
                 "proportional to n^{4/3}: 8^{4/3} = 16");
    const double circle = predicted_entries(2, 105408, 7982672, 420992) / 37810672;
    expect(circle > 0.8 && circle < 1.25, "for the circle refined 4 times the ratio to what the program counts is ",
           circle);
}

EXERCISE("11.3", "a sum with the same bits") {
    std::vector<double> v(10007);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = 1.0 / (i + 1);
    const double serial = std::accumulate(v.begin(), v.end(), 0.0);
    for (const int block : {10, 64, 1000}) {
        double expected = 0;
        for (int first = 0; first < 10007; first += block)
            expected += std::accumulate(v.begin() + first, v.begin() + std::min(first + block, 10007), 0.0);
        const double answer = sum_in_pieces(v, block);
        expect(std::abs(answer - serial) < 1e-9, "the sum in pieces of ", block, " is ", answer, ", that of all is ",
               serial, ": is the last piece, which is shorter, counted?");
        expect(answer == expected, "the sum in pieces of ", block, " differs by ", answer - expected,
               answer == serial ? ": these are the bits of one sum from left to right, which threads cannot share"
                                : ": each piece starts from zero, and the pieces are added in their order");
    }
}

EXERCISE("11.4", "where conjugate gradients win") {
    for (const double b : {10.0, 2000.0}) {
        const double a = 2, n = crossover(a, b);
        expect(n > 0, "a = 2, b = ", b, ": n is ", n, ", expected a positive number: solve a n^2 = b n n^{1/3}");
        const double ratio = a * n * n / (b * n * std::cbrt(n));
        expect_close(concat("with a = 2, b = ", b, " the ratio of the two costs at n = ", n), ratio, 1, 1e-9,
                     "a n^2 = b n n^{1/3}");
    }
}

EXERCISE("11.5", "inexact Newton steps (inexact.deck)") {
    expect_only("inexact", {"mesh = ../../../meshes/cube.msh", "refine = 2", "start = identity", "solver = cg",
                            "boundary all = expression \"x + 0.3*z\" \"y\" \"z\""}, {"forcing"});
    const auto summary = run_deck("inexact");
    expect(summary.at("status") == "converged", "the run ends with ", summary.at("status"));
    expect(number(summary, "elements") == 24192, "the mesh has ", number(summary, "elements"), " elements, not 24192");
    expect(summary.at("nodes_off_target") == "0", "the boundary is not in its place");
    const double iterations = number(summary, "linear_iterations");
    expect(iterations > 0, "no iterations of conjugate gradients: leave solver = cg");
    expect(iterations <= 80, "conjugate gradients took ", iterations, " iterations in ",
           number(summary, "newton_iterations"), " Newton steps, at most 80 are wanted: far from the minimum Newton's ",
           "model is not worth ten digits (almesh --keys: forcing)");
}

// The entries of x that the product with the five-point matrix of m x m points takes; point k has the number place[k].
std::vector<int> columns_of_grid(int m, const std::vector<int>& place) {
    std::vector<int> columns;
    for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j) {
            const int k = i * m + j;
            if (i > 0) columns.push_back(place[k - m]);
            if (j > 0) columns.push_back(place[k - 1]);
            columns.push_back(place[k]);
            if (j + 1 < m) columns.push_back(place[k + 1]);
            if (i + 1 < m) columns.push_back(place[k + m]);
        }
    return columns;
}

// With the time of each line's last use, searched from end to end.
long loads(const std::vector<int>& columns, int capacity) {
    std::vector<std::array<long, 2>> kept(capacity, {-1, -1});  // line, time
    long loaded = 0, time = 0;
    for (const int column : columns) {
        const auto is = [&](const std::array<long, 2>& line) { return line[0] == column / 8; };
        auto at = std::find_if(kept.begin(), kept.end(), is);
        if (at == kept.end()) {
            at = std::min_element(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a[1] < b[1]; });
            ++loaded;
        }
        *at = {column / 8, ++time};
    }
    return loaded;
}

EXERCISE("11.6", "an hour: what a product waits for") {
    const auto expect_loads = [](const std::string& what, const std::vector<int>& columns, int capacity,
                                 const char* hint) {
        const long found = lines_loaded(columns, capacity), expected = loads(columns, capacity);
        expect(found == expected, what, " through ", capacity, " lines loads ", found, ", expected ", expected, ": ", hint);
    };
    expect_loads("x_0 x_7 x_8 x_1", {0, 7, 8, 1}, 4, "x_0, x_1 and x_7 are in one line, which comes once");
    expect_loads("x_0 x_8 x_0 x_16 x_8 x_0", {0, 8, 0, 16, 8, 0}, 2,
                 "the line that goes is the one not used for longest; when x_16 comes that is the line of x_8");
    for (const int m : {40, 64}) {
        std::vector<int> place(m * m);
        std::iota(place.begin(), place.end(), 0);
        for (const int capacity : {4, 3 * m / 8 - 2, 3 * m / 8, 1000})
            expect_loads(concat("a grid of ", m, " x ", m, " points, numbered by rows,"), columns_of_grid(m, place),
                         capacity, "once for each line if three rows fit, three times if they do not");
        for (int k = m * m - 1; k > 0; --k) std::swap(place[k], place[(k * 7919L + 13) % (k + 1)]);
        expect_loads(concat("a grid of ", m, " x ", m, " points, numbered at random,"), columns_of_grid(m, place), 20,
                     "nearly one for each entry");
    }
    const double rate = product_rate({1e6, 5e6, 1, 125000}, 1e12, 1e10);
    expect_close("Gflop/s with 1e6 rows of five numbers, 125000 lines of x and 10 GB/s", rate / 1e9, 10 * 10 / 80.0, 1e-9,
                 "1e7 flops for 60 MB of numbers and columns, 4 MB of rows, 8 MB of x and 8 MB of y");
    expect_close("Gflop/s with 1e5 rows of 15 blocks of 3 x 3, 1e5 lines of x and 20 GB/s",
                 product_rate({1e5, 1.5e6, 3, 1e5}, 1e12, 2e10) / 1e9, 20 * 27 / 123.2, 1e-9,
                 "27 Mflop for 108 MB of numbers, 6.4 MB of columns and rows, 6.4 MB of x and 2.4 MB of y");
    expect_close("Gflop/s of the same with a peak of 1 Gflop/s", product_rate({1e5, 1.5e6, 3, 1e5}, 1e9, 2e10) / 1e9, 1,
                 1e-9, "no faster than the processor computes");
}

}  // namespace
}  // namespace almesh::lessons
