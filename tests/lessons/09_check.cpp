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
    const auto off = [](int n, double R) { return 2 * R * std::pow(std::sin(0.5 * std::numbers::pi / n), 2); };
    for (int k = 0; k < 38;) {
        const double R = k == 0 ? 1 : random_inputs().scale(1e-3, 1e3),
                     ratio = k < 30 ? random_inputs().scale(k % 2 ? 1e-6 : 0.05, 0.98)
                                    : off(k % 4 + 3, 1) * (k < 34 ? 0.999 : 1.001);  // few edges, just enough or not
        const double tolerance = R * ratio, number = std::numbers::pi / std::acos(1 - ratio);
        if (std::abs(number - std::round(number)) < 1e-4) continue;  // rounding could decide
        ++k;
        const int n = edges_needed(R, tolerance);
        expect(n >= 3, "R = ", R, " and tolerance ", tolerance, " give ", n, " edges: no polygon");
        expect(off(n, R) <= tolerance, n, " edges of a circle of radius ", R, " are off by ", off(n, R), ", more than ",
               tolerance, ": which angle does an edge see, and which half of it?");
        const int enough = std::max(3, static_cast<int>(std::ceil(number)));
        expect(n == enough, enough, " edges of a circle of radius ", R, " are enough for ", tolerance,
               ", the answer was ", n, n > 1.5 * enough ? ": which angle does an edge see, and which half of it?"
                                                        : ": 1 - cos(a) is less than a^2 / 2 where a is not small");
    }
}

EXERCISE("9.2", "the projection of a function") {
    const auto [a, b] = projection(0.5 * 2 + 5.0 / 6, 0.5 * 2 + 5.0 / 3);  // of 2 + 5 t
    expect_close("the projection of 2 + 5 t at 0", a, 2, 1e-12, "a linear function is its own projection");
    expect_close("the projection of 2 + 5 t at 1", b, 7, 1e-12);
    for (int k = 0; k < 20; ++k) {
        const double p = random_inputs().uniform(-5, 5), q = random_inputs().uniform(-5, 5),
                     r = random_inputs().uniform(-5, 5);
        // Of t^2 the projection is t - 1/6.
        const auto [c, d] = projection(p / 2 + q / 6 + r / 12, p / 2 + q / 3 + r / 4);
        const std::string of = concat("the projection of ", p, " + ", q, " t + ", r, " t^2 at ");
        expect_close(of + "0", c, p - r / 6, 1e-12, "it does not go through the end points of the function");
        expect_close(of + "1", d, p + q + 5 * r / 6, 1e-12, "it does not go through the end points of the function");
    }
}

EXERCISE("9.3", "Bezier coefficients of a quadratic") {
    for (int k = 0; k < 20; ++k) {
        Random& random = random_inputs();
        const double p = random.uniform(-5, 5), q = random.uniform(-9, 9), r = k % 4 == 0 ? 0 : random.uniform(-9, 9);
        const Quadratic b = bezier_coefficients(p, p + q / 2 + r / 4, p + q + r);
        const std::string of = concat(" of ", p, " + ", q, " t + ", r, " t^2");
        expect_close("b_0" + of, b[0], p, 1e-12, "the outer coefficients are the values at the ends");
        expect_close(
            "b_1" + of, b[1], p + q / 2, 1e-12,
            r == 0 ? "the coefficients of a linear function are its values" : "the middle coefficient is not a value");
        expect_close("b_2" + of, b[2], p + q + r, 1e-12, "the outer coefficients are the values at the ends");
    }
}

double least_value(const Quadratic& b) {
    const double curvature = b[0] - 2 * b[1] + b[2], t = (b[0] - b[1]) / curvature;  // q' = 0 at t
    return curvature > 0 && t > 0 && t < 1 ? (b[0] * b[2] - b[1] * b[1]) / curvature : std::min(b[0], b[2]);
}

EXERCISE("9.4", "a certificate") {
    Random& random = random_inputs();
    for (int k = 0; k < 80;) {
        const double unit = random.scale(1e-6, 1e6);
        const Quadratic b = {unit * random.uniform(k % 8 ? 0 : -1, 3), unit * random.uniform(-2, 2),
                             unit * random.uniform(k % 8 ? 0 : -1, 3)};
        const double least = least_value(b);
        if (std::abs(least) < 1e-6 * unit) continue;
        ++k;
        const bool said = positive_everywhere(b);
        const std::string of = concat("coefficients ", b[0], ", ", b[1], ", ", b[2], ": ");
        expect(said || least <= 0, of, "said not to be positive, but the least value is ", least,
               b[1] < 0 ? ": a negative middle coefficient proves nothing, halve" : "");
        expect(!said || least > 0, of, "said to be positive, but the least value is ", least,
               b[0] > 0 && b[2] > 0 ? ": positive ends prove nothing, and both halves have to be positive" : "");
    }
    // Narrow dips that a sample of many thousand points does not meet, and narrow gaps.
    for (int k = 0; k < 30; ++k)
        for (const double dip : {-1e-11, 1e-11}) {
            const double t = random.uniform(0.01, 0.99), unit = random.scale(1e-6, 1e6), least = dip * unit;
            const bool said = positive_everywhere(
                {unit * (t * t + dip), unit * (t * t - t + dip), unit * ((1 - t) * (1 - t) + dip)});
            expect(said == (least > 0), unit, " ((t - ", t, ")^2 + ", dip, ") is said ", said ? "" : "not ",
                   "to be positive: its least value is ", least, ", between the points of a sample; halve until the ",
                   "coefficients prove it or an end disproves it");
        }
    for (int k = 0; k < 20; ++k) {
        const double p = random.integer(1, 9), q = random.integer(1, 9), unit = std::ldexp(1, random.integer(-20, 20));
        expect(!positive_everywhere({unit * p * p, -unit * p * q, unit * q * q}), "coefficients ", unit * p * p, ", ",
               -unit * p * q, ", ", unit * q * q, ": said to be positive, but it touches zero at t = ", p / (p + q),
               ", where halving does not end: what is not proved is not true");
    }
    expect(!positive_everywhere({0, 1, 1}) && !positive_everywhere({1, 1, 0}) && !positive_everywhere({0, 0, 0}),
           "said to be positive, but it touches zero at an end");
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

// det J at the nodes, from the shape functions; those of edges turned into coefficients: q(1/2) = (b_0 + 2 b_1 +
// b_2)/4.
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

// A way to bend a triangle.
using Bend = std::array<double, 6>;
Bend random_bend() {
    Bend bend = {0.1, 0.4, 0, 0.1, -0.35, -0.15};
    for (double& by : bend) by += random_inputs().uniform(-0.15, 0.15);
    return bend;
}

CurvedTriangle bent(const Bend& bend, double s) {
    CurvedTriangle x = {{{0, 0}, {1, 0}, {0.5, 1}, {0.5, 0}, {0.75, 0.5}, {0.25, 0.5}}};
    for (int i = 0; i < 6; ++i) x[3 + i / 2][i % 2] += s * bend[i];
    return x;
}

// Bent until the least det J is `least`, but for rounding.
CurvedTriangle bent_until(double least) {
    const Bend bend = random_bend();
    double low = 0, high = 0.1;
    while (least_on_edges(coefficients_of(bent(bend, high))) > least) low = high, high *= 1.05;
    for (int i = 0; i < 60; ++i) {
        const double s = 0.5 * (low + high);
        (least_on_edges(coefficients_of(bent(bend, s))) > least ? low : high) = s;
    }
    return bent(bend, low);
}

// An affine map that keeps the orientation: any triangle, of any size, with det J multiplied by `determinant`.
struct Affine {
    double A[2][2], shift[2], determinant;

    Affine() {
        Random& random = random_inputs();
        const double size = random.scale(1e-3, 1e3);
        do {
            for (auto& row : A)
                for (double& entry : row) entry = size * random.uniform(-1, 1);
            determinant = A[0][0] * A[1][1] - A[0][1] * A[1][0];
        } while (determinant < 0.1 * size * size);
        for (double& by : shift) by = size * random.uniform(-2, 2);
    }
    CurvedTriangle of(CurvedTriangle x) const {
        for (auto& p : x)
            p = {A[0][0] * p[0] + A[0][1] * p[1] + shift[0], A[1][0] * p[0] + A[1][1] * p[1] + shift[1]};
        return x;
    }
};

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

// The image of the same under (3 z - a)^2, a = a_0 + i a_1: det J = 36 |3 z - a|^2 touches zero at a / 3, and all
// numbers are integers, but for quarters.
CurvedTriangle touching(int a_0, int a_1, double unit) {
    CurvedTriangle x = folded_inside({a_0 / 3.0, a_1 / 3.0}, 0);
    for (auto& p : x)
        for (double& entry : p) entry = unit * std::round(36 * entry) / 4;
    return x;
}

void expect_judged(const CurvedTriangle& x, double least, const char* place) {
    const std::array<double, 6> b = coefficients_of(x);
    const bool said = proved_valid(x);
    const std::string where = concat("a triangle with the coefficients ", b[0], ", ", b[1], ", ", b[2],
                                     " at vertices and ", b[3], ", ", b[4], ", ", b[5], " of edges is said to be ",
                                     said ? "valid" : "not valid", ", but its least det J is ", least);
    expect(said || least <= 0, where,
           ": a coefficient that belongs to no vertex is not a value; if it is negative, cut ",
           "the triangle and look again");
    expect(!said || least != 0, where, ", ", place,
           ": one that touches zero is not valid; cutting does not end there, and ", "what is not proved is not true");
    expect(!said || least > 0, where, ", ", place,
           " and between the points of a sample; cut until coefficients prove it, or a vertex disproves it");
}

EXERCISE("9.6", "an hour: a curved triangle proved valid") {
    for (int k = 0; k < 10; ++k) {
        const Affine affine;
        const CurvedTriangle x = k < 2 ? bent(random_bend(), k) : affine.of(bent(random_bend(), k == 2 ? 0 : 0.5));
        const std::array<double, 6> b = jacobian_coefficients(x), expected = coefficients_of(x);
        const double tolerance =
            1e-11 * std::abs(*std::max_element(expected.begin(), expected.end(),
                                               [](double p, double q) { return std::abs(p) < std::abs(q); }));
        std::string where = " of the triangle with vertices and edge nodes";
        for (const auto& p : x) where += concat(" (", p[0], ", ", p[1], ")");
        for (int i = 0; i < 6; ++i) {
            const char* const hint =
                i >= 3       ? ": B_ij = 2 l_i l_j, and the product of two sums has l_i l_j twice"
                : b[i] < 0   ? ": J has the derivative by l_1 in its first column, that by l_2 in its "
                               "second"
                : k % 2 == 0 ? ": for a straight triangle it is twice the area; l_i^2 has the "
                               "derivative 2 l_i"
                             : ": det J there; a node of an edge is a value of the map, not its control "
                               "point";
            expect(std::abs(b[i] - expected[i]) <= tolerance, "the coefficient ",
                   i < 3 ? concat("at vertex ", i) : concat("of edge ", i - 3, (i - 2) % 3), where, " is ", b[i],
                   ", expected ", expected[i], hint);
        }
    }
    for (int k = 0; k < 20; ++k)
        for (const double least : {0.1, -0.1, 1e-9, -1e-9}) {
            const Affine affine;
            expect_judged(affine.of(bent_until(least)), affine.determinant * least, "on an edge");
        }
    for (int k = 0; k < 15; ++k) {
        const Affine affine;
        const double a = random_inputs().uniform(0.05, 0.9), b = (0.95 - a) * random_inputs().uniform(0.1, 0.9);
        expect_judged(affine.of(folded_inside({a, b}, 3e-5)), -9e-10 * affine.determinant, "inside");
    }
    for (int k = 0; k < 3; ++k) {
        const double unit = std::ldexp(1, random_inputs().integer(-9, 9));
        expect_judged(touching(1, 1, unit), 0, "inside");
        for (const auto& [a_0, a_1] : {std::pair(1, 0), {2, 0}, {0, 1}, {0, 2}, {1, 2}, {2, 1}})
            expect_judged(touching(a_0, a_1, unit), 0, "on an edge");
    }
    CurvedTriangle mirrored = bent(random_bend(), 0.1);
    for (auto& p : mirrored) p[0] = -p[0];
    expect(!proved_valid(mirrored),
           "a triangle that is mirrored is said to be valid, but its det J is negative everywhere");
}

}  // namespace
}  // namespace almesh::lessons
