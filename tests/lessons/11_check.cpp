#include "lessons/exercises/11.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(growth_exponent, predicted_entries, sum_in_pieces, crossover, lines_loaded, product_rate);

bool is_close(double value, double expected, double tolerance) {
    return std::abs(value - expected) <= tolerance * std::abs(expected);
}

EXERCISE("11.1", "the exponent of a growth") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const double alpha = k == 0   ? 2
                             : k == 1 ? 0
                                      : random.uniform(-1, 4),
                     factor = k == 0 ? 1 : random.scale(1e-9, 1e3), n_1 = random.scale(2, 1e5),
                     ratio = random.scale(1.5, 100), n_2 = k % 3 ? n_1 * ratio : n_1 / ratio;
        const double t_1 = factor * std::pow(n_1, alpha), t_2 = factor * std::pow(n_2, alpha);
        expect_close(concat("the exponent of t = ", factor, " n^", alpha, " from n = ", n_1, " to ", n_2),
                     growth_exponent(n_1, t_1, n_2, t_2), alpha, 1e-9,
                     "the slope in logarithmic axes; a factor before n does not count");
    }
}

EXERCISE("11.2", "a factor predicted") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const int dim = k % 2 ? 3 : 2;
        const double a = random.scale(1, 30), b = k < 4 ? 0 : random.uniform(-0.5, 3) * a;
        const double n_1 = random.scale(100, 1e5), n_2 = n_1 * (k % 3 ? random.scale(2, 20) : 1 / random.scale(2, 20)),
                     n = random.scale(100, 1e7);
        const auto entries = [=](double m) { return a * (dim == 2 ? m * std::log(m) : m * std::cbrt(m)) + b * m; };
        const double found = predicted_entries(dim, n_1, entries(n_1), n_2, entries(n_2), n);
        expect(is_close(found, entries(n), 1e-9), dim, "D: nnz(L) at n = ", n, " from ", entries(n_1), " at ", n_1,
               " and ", entries(n_2), " at ", n_2, " is ", found, ", expected ", entries(n),
               dim == 3 ? ": proportional to n^{4/3}, but for a part that is proportional to n"
                        : ": proportional to n log n, but for a part that is proportional to n");
    }
    const double circle = predicted_entries(2, 26432, 1588000, 105408, 7982672, 420992) / 37810672;
    expect(circle > 0.97 && circle < 1.03, "for the circle refined 4 times the ratio to what the program counts is ",
           circle);
}

// Pairs by halving: the first part has the largest power of two of sums that leaves some for the second.
double added_in_pairs(const std::vector<double>& sums, std::size_t first, std::size_t count) {
    if (count == 1) return sums[first];
    std::size_t part = 1;
    while (2 * part < count) part *= 2;
    return added_in_pairs(sums, first, part) + added_in_pairs(sums, first + part, count - part);
}

EXERCISE("11.3", "a sum with the same bits") {
    expect(sum_in_pieces({}, 4) == 0, "the sum of no values is ", sum_in_pieces({}, 4), ", expected 0");
    for (int k = 0; k < 24; ++k) {
        const int size = k == 0 ? random_inputs().integer(30000, 50000) : random_inputs().integer(1, 3000),
                  block = k == 0 ? random_inputs().integer(1, 3) : k == 1 ? 5000 : random_inputs().integer(1, 200);
        std::vector<double> v(size), sums;
        for (double& value : v) value = random_inputs().scale(1e-6, 1) * random_inputs().uniform(-1, 2);
        const double serial = std::accumulate(v.begin(), v.end(), 0.0);
        for (int first = 0; first < size; first += block)
            sums.push_back(std::accumulate(v.begin() + first, v.begin() + std::min(first + block, size), 0.0));
        const double expected = added_in_pairs(sums, 0, sums.size()), answer = sum_in_pieces(v, block);
        expect(std::abs(answer - serial) < 1e-9, "the sum of ", size, " values in pieces of ", block, " is ", answer,
               ", that of all is ", serial, ": is the last piece, which is shorter, counted, and nothing beyond it?");
        expect(answer == expected, "the sum of ", size, " values in ", sums.size(), " pieces of ", block,
               " differs by ", answer - expected,
               answer == serial ? ": these are the bits of one sum from left to right, which threads cannot share"
               : answer == std::accumulate(sums.begin(), sums.end(), 0.0)
                   ? ": these are the bits of the pieces added from left to right, not in pairs"
                   : ": each piece starts from zero, and the sums are added in pairs of neighbours");
    }
}

EXERCISE("11.4", "where conjugate gradients win") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const double a = random.scale(0.01, 100), b = random.scale(1, 1e4), c = k < 3 ? 0 : b * random.uniform(0, 0.95);
        const int count = k % 3 ? random.integer(2, 50) : 1;
        const double n = crossover(a, b, c, count), third = n * std::cbrt(n), cholesky = a * n * n + count * c * third;
        const std::string where =
            concat("a = ", a, ", b = ", b, ", c = ", c, ", ", count, " right-hand sides: n is ", n);
        expect(n > 0, where, ", expected a positive number");
        expect(is_close(cholesky, count * b * third, 1e-9), where, ", where Cholesky takes ", cholesky,
               " operations and conjugate gradients ", count * b * third, ", expected as many");
        const double none = crossover(a, b, b * random.uniform(1, 3), count);
        expect(none == 0, "where a solve with the factor takes more than conjugate gradients do you say ", none,
               ", expected 0: they take fewer for every n");
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
           "model is not worth ten digits (./almesh --keys: forcing)");
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

// Of sparse matrices with any columns.
std::vector<int> random_columns(int count, int largest) {
    Random& random = random_inputs();
    std::vector<int> columns(count);
    for (int& column : columns) column = random.integer(0, largest);
    return columns;
}

EXERCISE("11.6", "an hour: what a product waits for") {
    const auto expect_loads = [](const std::string& what, const std::vector<int>& columns, int capacity,
                                 const char* hint) {
        const long found = lines_loaded(columns, capacity), expected = loads(columns, capacity);
        expect(found == expected, what, " through ", capacity, " lines loads ", found, ", expected ", expected, ": ",
               hint);
    };
    expect_loads("x_0 x_7 x_8 x_1", {0, 7, 8, 1}, 4, "x_0, x_1 and x_7 are in one line, which comes once");
    expect_loads("x_0 x_8 x_0 x_16 x_8 x_0", {0, 8, 0, 16, 8, 0}, 2,
                 "the line that goes is the one not used for longest; when x_16 comes that is the line of x_8");
    expect_loads("nothing", {}, 3, "nothing is used");
    for (int k = 0; k < 13; ++k) {
        const bool is_large = k == 12;
        const int count = is_large ? 8000 : random_inputs().integer(1, 400),
                  largest = is_large ? 16000 : random_inputs().integer(8, 200),
                  capacity = is_large ? random_inputs().integer(600, 1500)
                             : k == 0 ? 1
                                      : random_inputs().integer(1, 20);
        expect_loads(concat("a product with a ", is_large ? "large " : "", "matrix with any columns"),
                     random_columns(count, largest), capacity, "the line that goes is the one not used for longest");
    }
    for (const int m : {40, 8 * random_inputs().integer(5, 9)}) {
        std::vector<int> place(m * m);
        std::iota(place.begin(), place.end(), 0);
        for (const int capacity : {4, 3 * m / 8 - 2, 3 * m / 8, 1000})
            expect_loads(concat("a grid of ", m, " x ", m, " points, numbered by rows,"), columns_of_grid(m, place),
                         capacity, "once for each line if three rows fit, three times if they do not");
        random_inputs().shuffle(place);
        expect_loads(concat("a grid of ", m, " x ", m, " points, numbered at random,"), columns_of_grid(m, place), 20,
                     "nearly one for each entry");
    }
    expect_close("Gflop/s with 1e6 rows of five numbers, 125000 lines of x and 10 GB/s",
                 product_rate({1e6, 5e6, 1, 125000}, 1e12, 1e10) / 1e9, 10 * 10 / 80.0, 1e-9,
                 "1e7 flops for 60 MB of numbers and columns, 4 MB of rows, 8 MB of x and 8 MB of y");
    for (int k = 0; k < 16; ++k) {
        Random& random = random_inputs();
        const int block = k % 4 + 1;
        const double rows = random.integer(1000, 1000000), blocks = rows * random.integer(2, 30),
                     numbers = blocks * block * block, lines = std::ceil(rows * block / 8 * random.uniform(1, 4)),
                     bandwidth = random.scale(1e9, 1e12), megabytes_of_A = (8 * numbers + 4 * (blocks + rows)) / 1e6,
                     of_x = 64 * lines / 1e6, of_y = 8 * rows * block / 1e6,
                     allowed = 2 * numbers / (megabytes_of_A + of_x + of_y) * bandwidth / 1e6,
                     peak = allowed * (k % 3 ? random.scale(2, 100) : random.uniform(0.1, 0.9));
        const double found = product_rate({rows, blocks, block, lines}, peak, bandwidth);
        expect(is_close(found, std::min(peak, allowed), 1e-9), found / 1e9, " Gflop/s with ", rows, " rows of ",
               blocks / rows, " blocks of ", block, " x ", block, ", ", lines, " lines of x, ", bandwidth / 1e9,
               " GB/s and a peak of ", peak / 1e9, " Gflop/s, expected ", std::min(peak, allowed) / 1e9, ": ",
               peak < allowed ? "no faster than the processor computes"
                              : concat(2 * numbers / 1e6, " Mflop for ", megabytes_of_A, " MB of A, ", of_x,
                                       " of x and ", of_y, " of y"));
    }
}

}  // namespace
}  // namespace almesh::lessons
