#include "lessons/exercises/11.hpp"

#include <cmath>
#include <numeric>

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

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

}  // namespace
}  // namespace almesh::lessons
