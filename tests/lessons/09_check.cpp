#include "lessons/exercises/09.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "lessons/exercise.hpp"
#include "mesh/lagrange.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(edges_needed, projection, bezier_coefficients, positive_everywhere, jacobian_coefficients, proved_valid);

EXERCISE("9.1", "how many straight edges a circle needs") {
    const auto off = [](int n, double R) { return R * (1 - std::cos(std::numbers::pi / n)); };
    for (const auto& [R, tolerance] : {std::pair(1.0, 0.06), std::pair(1.0, 1e-3), std::pair(5.0, 1e-3),
                                       std::pair(1.0, 0.3), std::pair(2.0, 0.2), std::pair(1.0, 0.99)}) {
        const int n = edges_needed(R, tolerance);
        expect(n >= 3, "R = ", R, " and tolerance ", tolerance, " give ", n, " edges: no polygon");
        expect(off(n, R) <= tolerance, n, " edges of a circle of radius ", R, " are off by ", off(n, R), ", more than ",
               tolerance, ": an edge sees the angle 2 pi / n, half of it to either side of its middle");
        int enough = 3;
        while (off(enough, R) > tolerance) ++enough;
        expect(n == enough, enough, " edges of a circle of radius ", R, " are enough for ", tolerance,
               ", the answer was ", n, n > 1.5 * enough ? ": an edge sees the angle 2 pi / n, half of it to either side"
                                                        : ": 1 - cos(a) is less than a^2 / 2 where a is not small");
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
                       b_0 > 0 && b_2 > 0 ? ": positive ends prove nothing, and both halves have to be positive" : "");
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
    expect_only("fine_wall", {"mesh = ../ring.msh", "boundary wall = circle 0 0 1", "boundary outer = circle 0 0 3",
                              "target = least_squares"},
                {"degree", "refine"});
    const auto summary = run_deck("fine_wall");
    expect(summary.at("status") == "converged", "the run ends with ", summary.at("status"));
    expect(summary.at("certified_valid") == "yes", "an element is not certified valid");
    const double error = number(summary, "constraint_norm"), nodes = number(summary, "nodes");
    expect(nodes <= 4000, nodes,
           " nodes, at most 4000: halving h divides the error by 2^(p+1) and costs four times the ",
           "nodes; a higher degree is cheaper");
    expect(error <= 2e-6, "|c_D| is ", error, " with ", nodes, " nodes in degree ", number(summary, "degree"),
           ", expected at most 2e-6: it falls as h^(p+1), and degrees above 4 are allowed");
}

// det J at the nodes, from the shape functions; those of edges turned into coefficients: q(1/2) = (b_0 + 2 b_1 + b_2)/4.
std::array<double, 6> coefficients_of(const CurvedTriangle& x) {
    static const LagrangeBasis basis(2, 2);
    std::array<double, 6> b;
    for (int node = 0; node < 6; ++node) {
        const MultiIndex& a = basis.nodes[node];
        const double xi[2] = {0.5 * a[1], 0.5 * a[2]};
        double dN[12], J[2][2] = {};
        basis.gradients(xi, dN);
        for (int i = 0; i < 6; ++i)
            for (int k = 0; k < 4; ++k) J[k / 2][k % 2] += x[i][k / 2] * dN[2 * i + k % 2];
        b[node] = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    }
    for (int i = 0; i < 3; ++i) b[3 + i] = 2 * b[3 + i] - 0.5 * (b[i] + b[(i + 1) % 3]);
    return b;
}

// The least value of sum_ij l_i l_j Q_ij on the edges, exactly. Where it is positive it is the least of all.
double least_on_edges(const std::array<double, 6>& b) {
    double least = std::min({b[0], b[1], b[2]});
    for (int i = 0; i < 3; ++i) {
        const double p = b[i], q = b[3 + i], r = b[(i + 1) % 3], curvature = p - 2 * q + r, t = (p - q) / curvature;
        if (curvature > 0 && t > 0 && t < 1) least = std::min(least, (p * r - q * q) / curvature);
    }
    return least;
}

// s times the k-th way to bend a triangle.
CurvedTriangle bent(int k, double s) {
    CurvedTriangle x = {{{0, 0}, {1, 0}, {0.5, 1}, {0.5, 0}, {0.75, 0.5}, {0.25, 0.5}}};
    const double bend[] = {0.1, 0.4, 0, 0.1, -0.35, -0.15};
    for (int i = 0; i < 6; ++i) x[3 + i / 2][i % 2] += s * (bend[i] + 0.15 * std::sin(12.9898 * (6 * k + i + 1)));
    return x;
}

// The k-th triangle bent until its least det J is `least`, but for rounding.
CurvedTriangle bent_until(int k, double least) {
    double low = 0, high = 0.1;
    while (least_on_edges(coefficients_of(bent(k, high))) > least) low = high, high *= 1.05;
    for (int i = 0; i < 60; ++i) {
        const double s = 0.5 * (low + high);
        (least_on_edges(coefficients_of(bent(k, s))) > least ? low : high) = s;
    }
    return bent(k, low);
}

// The image of the triangle 0, 1, i under (z - z_0)^2 + delta conj(z): det J = |2 (z - z_0)|^2 - delta^2 is negative in
// a disc around z_0 alone.
CurvedTriangle folded_inside(std::complex<double> z_0, double delta) {
    CurvedTriangle x;
    const std::complex<double> nodes[] = {0, 1, {0, 1}, 0.5, {0.5, 0.5}, {0, 0.5}};
    for (int i = 0; i < 6; ++i) {
        const std::complex<double> w = (nodes[i] - z_0) * (nodes[i] - z_0) + delta * std::conj(nodes[i]);
        x[i] = {w.real(), w.imag()};
    }
    return x;
}

void expect_judged(const CurvedTriangle& x, double least, const char* place) {
    const std::array<double, 6> b = coefficients_of(x);
    const bool said = proved_valid(x);
    const std::string where =
        concat("a triangle with the coefficients ", b[0], ", ", b[1], ", ", b[2], " at vertices and ", b[3], ", ", b[4],
               ", ", b[5], " of edges is said to be ", said ? "valid" : "not valid", ", but its least det J is ", least);
    expect(said || least < 0, where, ": a coefficient that belongs to no vertex is not a value; if it is negative, cut ",
           "the triangle and look again");
    expect(!said || least > 0, where, ", ", place,
           " and between the points of a sample; cut until coefficients prove it, or a vertex disproves it");
}

EXERCISE("9.6", "an hour: a curved triangle proved valid") {
    for (int k = 0; k < 5; ++k) {
        const CurvedTriangle x = bent(k, 0.3 * k);  // the first one is straight
        const std::array<double, 6> b = jacobian_coefficients(x), expected = coefficients_of(x);
        const std::string where =
            concat(" of the triangle with vertices (0, 0), (1, 0), (0.5, 1) and edge nodes (", x[3][0], ", ", x[3][1],
                   "), (", x[4][0], ", ", x[4][1], "), (", x[5][0], ", ", x[5][1], ")");
        for (int i = 0; i < 3; ++i)
            expect_close(concat("the coefficient at vertex ", i, where), b[i], expected[i], 1e-12,
                         b[i] < 0 ? "J has the derivative by l_1 in its first column, that by l_2 in its second"
                         : k == 0 ? "twice the area, the triangle is straight; l_i^2 has the derivative 2 l_i"
                                  : "det J there; a node of an edge is a value of the map, not its control point");
        for (int i = 3; i < 6; ++i)
            expect_close(concat("the coefficient of edge ", i - 3, (i - 2) % 3, where), b[i], expected[i], 1e-12,
                         "B_ij = 2 l_i l_j, and the product of two sums has l_i l_j twice");
    }
    for (int k = 0; k < 60; ++k)
        for (const double least : {0.1, -0.1, 1e-9, -1e-9}) expect_judged(bent_until(k, least), least, "on an edge");
    for (int k = 1; k < 20; ++k)
        expect_judged(folded_inside({0.05 * k, 0.4 * (1 - 0.05 * k)}, 3e-5), -9e-10, "inside");
}

}  // namespace
}  // namespace almesh::lessons
