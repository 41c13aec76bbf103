// Solutions of the exercises of lesson 9.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lessons/exercises/09.hpp"

namespace almesh::lessons {

int edges_needed(double R, double tolerance) {
    return static_cast<int>(std::ceil(std::numbers::pi / std::acos(1 - tolerance / R)));  // R (1 - cos(pi / n))
}

std::array<double, 2> projection(double m_0, double m_1) {
    return {4 * m_0 - 2 * m_1, 4 * m_1 - 2 * m_0};  // the inverse of [1/3 1/6; 1/6 1/3]
}

Quadratic bezier_coefficients(double at_start, double at_middle, double at_end) {
    return {at_start, 2 * at_middle - 0.5 * (at_start + at_end), at_end};
}

namespace {

// What 60 halvings have not proved touches zero, as far as rounding can tell.
bool positive(const Quadratic& b, int halvings) {
    if (std::min({b[0], b[1], b[2]}) > 0) return true;
    if (b[0] <= 0 || b[2] <= 0 || halvings == 60) return false;
    const double left = 0.5 * (b[0] + b[1]), right = 0.5 * (b[1] + b[2]), middle = 0.5 * (left + right);
    return positive({b[0], left, middle}, halvings + 1) && positive({middle, right, b[2]}, halvings + 1);
}

}  // namespace

bool positive_everywhere(const Quadratic& b) { return positive(b, 0); }

namespace {

// q = l' Q l in barycentric coordinates l: Q_ii is the coefficient of vertex i, Q_ij that of the edge ij.
using Form = std::array<std::array<double, 3>, 3>;

// The edge of the vertices i and j among the six nodes.
int edge_node(int i, int j) { return i + j == 1 ? 3 : i + j == 3 ? 4 : 5; }

// On the triangle with the corners p: Q_ij = p_i' Q p_j.
Form restricted(const Form& Q, const Form& p) {
    Form on_piece{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) on_piece[i][j] += p[i][a] * Q[a][b] * p[j][b];
    return on_piece;
}

// The same for a triangle, after 30 cuts.
bool positive(const Form& Q, int cuts) {
    if (Q[0][0] <= 0 || Q[1][1] <= 0 || Q[2][2] <= 0) return false;
    if (Q[0][1] > 0 && Q[1][2] > 0 && Q[2][0] > 0) return true;
    if (cuts == 30) return false;
    const std::array<double, 3> a = {1, 0, 0}, b = {0, 1, 0}, c = {0, 0, 1}, ab = {0.5, 0.5, 0}, bc = {0, 0.5, 0.5},
                                ca = {0.5, 0, 0.5};
    const Form pieces[] = {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}};
    return std::all_of(std::begin(pieces), std::end(pieces),
                       [&](const Form& p) { return positive(restricted(Q, p), cuts + 1); });
}

}  // namespace

std::array<double, 6> jacobian_coefficients(const CurvedTriangle& x) {
    // x = sum_ij l_i l_j P_ij; its derivatives by l_1 and l_2 are 2 sum_i l_i U_i and 2 sum_i l_i V_i.
    std::array<double, 2> U[3], V[3];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 2; ++k) {
            const auto P = [&](int j) {
                return i == j ? x[i][k] : 2 * x[edge_node(i, j)][k] - 0.5 * (x[i][k] + x[j][k]);
            };
            U[i][k] = P(1) - P(0);
            V[i][k] = P(2) - P(0);
        }
    const auto det = [&](int i, int j) { return U[i][0] * V[j][1] - U[i][1] * V[j][0]; };
    std::array<double, 6> b;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        b[i] = 4 * det(i, i);
        b[edge_node(i, j)] = 2 * (det(i, j) + det(j, i));
    }
    return b;
}

bool proved_valid(const CurvedTriangle& x) {
    const auto b = jacobian_coefficients(x);
    return positive(Form{{{b[0], b[3], b[5]}, {b[3], b[1], b[4]}, {b[5], b[4], b[2]}}}, 0);
}

}  // namespace almesh::lessons
