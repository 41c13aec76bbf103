#include "lessons/exercises/09.hpp"

#include <cmath>
#include <numbers>

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

EXERCISE("9.1", "how many straight edges a circle needs") {
    const auto off = [](int n, double R) { return R * (1 - std::cos(std::numbers::pi / n)); };
    for (const auto& [R, tolerance] : {std::pair(1.0, 0.06), std::pair(1.0, 1e-3), std::pair(5.0, 1e-3),
                                       std::pair(1.0, 0.3), std::pair(2.0, 0.2), std::pair(1.0, 0.99)}) {
        const int n = edges_needed(R, tolerance);
        expect(n >= 3, "R = ", R, " and tolerance ", tolerance, " give ", n, " edges: no polygon");
        expect(off(n, R) <= tolerance, n, " edges of a circle of radius ", R, " are off by ", off(n, R), ", more than ",
               tolerance, ": an edge sees the angle 2 pi / n, half of it to either side of its middle");
        expect(n == 3 || off(n - 1, R) > tolerance, n - 1, " edges of a circle of radius ", R, " are enough for ",
               tolerance, ", the answer was ", n, ": 1 - cos(a) is less than a^2 / 2 where the angle is not small");
    }
}

EXERCISE("9.2", "the projection of a function") {
    const auto [a, b] = projection(0.5 * 2 + 5.0 / 6, 0.5 * 2 + 5.0 / 3);  // of 2 + 5 t
    expect_close("the projection of 2 + 5 t at 0", a, 2, 1e-12,
                 "a linear function is its own projection; solve M (a, b) = (m_0, m_1) with M = [1/3 1/6; 1/6 1/3]");
    expect_close("the projection of 2 + 5 t at 1", b, 7, 1e-12);
    const auto [c, d] = projection(1.0 / 12, 1.0 / 4);  // of t^2
    expect_close("the projection of t^2 at 0", c, -1.0 / 6, 1e-12,
                 "it does not go through the end points of the function");
    expect_close("the projection of t^2 at 1", d, 5.0 / 6, 1e-12);
}

EXERCISE("9.3", "Bezier coefficients of a quadratic") {
    const auto q = [](double t) { return 1 - 5 * t + 6 * t * t; };
    const Quadratic b = bezier_coefficients(q(0), q(0.5), q(1));
    expect_close("b_0 of 1 - 5 t + 6 t^2", b[0], 1, 1e-12, "the outer coefficients are the values at the ends");
    expect_close("b_1 of 1 - 5 t + 6 t^2", b[1], -1.5, 1e-12,
                 "the middle coefficient is not a value: q(1/2) = (b_0 + 2 b_1 + b_2) / 4");
    expect_close("b_2 of 1 - 5 t + 6 t^2", b[2], 2, 1e-12);
    const Quadratic line = bezier_coefficients(3, 5, 7);
    expect_close("b_1 of 3 + 4 t", line[1], 5, 1e-12, "the coefficients of a linear function are its values");
}

EXERCISE("9.4", "a certificate") {
    int positive = 0, all = 0;
    for (double b_0 = -0.25; b_0 < 3; b_0 += 0.5)
        for (double b_2 = -0.25; b_2 < 3; b_2 += 0.5)
            for (double b_1 = -2.7; b_1 < 3; b_1 += 0.3, ++all) {
                const double curvature = b_0 - 2 * b_1 + b_2, t = (b_0 - b_1) / curvature;  // q' = 0 at t
                double least = std::min(b_0, b_2);
                if (curvature > 0 && t > 0 && t < 1) least = (b_0 * b_2 - b_1 * b_1) / curvature;
                const bool said = positive_everywhere({b_0, b_1, b_2});
                positive += said;
                expect(said || least <= 0, "coefficients ", b_0, ", ", b_1, ", ", b_2,
                       ": said not to be positive, but ", "the least value is ", least,
                       ": a negative middle coefficient proves nothing, halve");
                expect(!said || least > 0, "coefficients ", b_0, ", ", b_1, ", ", b_2,
                       ": said to be positive, but at t = ", t, " the value is ", least,
                       b_0 > 0 && b_2 > 0 ? ": positive ends prove nothing" : "");
            }
    // Narrow dips that a sample of many thousand points does not meet, and narrow gaps.
    for (int k = 1; k <= 20; ++k)
        for (const double least : {-1e-11, 1e-11}) {
            const double t = std::fmod(0.6180339887 * k, 1);  // q = (t - t_k)^2 + least
            const bool said = positive_everywhere({t * t + least, t * t - t + least, (1 - t) * (1 - t) + least});
            expect(said == (least > 0), "(t - ", t, ")^2 + ", least, " is said ", said ? "" : "not ",
                   "to be positive: its least value is ", least, ", between the points of a sample; halve until the ",
                   "coefficients prove it or an end disproves it");
        }
    expect(positive > 0 && positive < all, "the same answer for all ", all, " quadratics");
}

EXERCISE("9.5", "a fine wall with few nodes (fine_wall.deck)") {
    expect_only("fine_wall", {"mesh = ../ring.msh", "boundary wall = circle 0 0 1", "boundary outer = circle 0 0 3"},
                {"degree", "refine"});
    const auto summary = run_deck("fine_wall");
    expect(summary.at("status") == "converged", "the run ends with ", summary.at("status"));
    expect(summary.at("certified_valid") == "yes", "an element is not certified valid");
    const double error = number(summary, "constraint_norm"), nodes = number(summary, "nodes");
    expect(nodes <= 4000, nodes,
           " nodes, at most 4000: halving h divides the error by 2^(p+1) and costs four times the ",
           "nodes; a higher degree is cheaper");
    expect(error <= 2e-6, "|c_D| is ", error, " with ", nodes, " nodes in degree ", number(summary, "degree"),
           ", expected at most 2e-6");
}

}  // namespace
}  // namespace almesh::lessons
