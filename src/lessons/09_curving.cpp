// Lesson 9: a curved triangle that is valid at every point where anybody looks, and is not valid; and how to know.
//
// One triangle of degree 2: its vertices stay, its three edge nodes move away from the middles of the straight edges,
// by s times `bend`. det J of its map is a polynomial of degree 2. The program tabulates over s the least det J at the
// vertices, at all nodes, at quadrature points, and over the whole triangle; then it proves, by Bernstein-Bezier
// coefficients and bisection, whether the triangle of s = 1 (or of its argument) is valid.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "geometry/element_jacobian.hpp"
#include "lessons/plain_energy.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/quadrature.hpp"

using namespace almesh;

namespace {

const LagrangeBasis basis(2, 2);
const Bernstein bernstein(2, 2);
const std::vector<double> straight = {0, 0, 1, 0, 0.5, 1, 0.5, 0, 0.75, 0.5, 0.25, 0.5};
const std::vector<double> bend = {0, 0, 0, 0, 0, 0, 0.1, 0.4, 0, 0.1, -0.35, -0.15};

std::vector<double> bent(double s) {
    std::vector<double> x = straight;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += s * bend[i];
    return x;
}

// det J at the reference point xi: J = sum_i x_i (grad N_i)^T.
double det_J(const std::vector<double>& x, const double* xi) {
    double dN[12];
    basis.gradients(xi, dN);
    Mat<2> J{};
    for (int i = 0; i < 6; ++i)
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) J[a][k] += x[2 * i + a] * dN[2 * i + k];
    return determinant(J);
}

std::vector<double> det_at(const std::vector<double>& x, const std::vector<double>& xi) {
    std::vector<double> values;
    for (std::size_t q = 0; q < xi.size(); q += 2) values.push_back(det_J(x, &xi[q]));
    return values;
}

double least(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

std::vector<double> nodes() {
    std::vector<double> xi;
    for (const MultiIndex& a : basis.nodes) xi.insert(xi.end(), {0.5 * a[1], 0.5 * a[2]});
    return xi;
}

// det J has degree 2, so its values at the six nodes determine it; b = M v are its Bezier coefficients.
std::vector<double> bezier_coefficients(const std::vector<double>& x) {
    const std::vector<double> M = bezier_of_lagrange(basis), v = det_at(x, nodes());
    std::vector<double> b(6);
    for (int a = 0; a < 6; ++a)
        for (int i = 0; i < 6; ++i) b[a] += M[6 * a + i] * v[i];
    return b;
}

double largest_difference_from_the_program(const std::vector<double>& x, const std::vector<double>& b) {
    const JacobianBasis jacobian(2, 2);
    ElementJacobian<2, double> element(jacobian);
    for (int i = 0; i < 6; ++i) element.position(0)[i] = {x[2 * i], x[2 * i + 1]};
    element.compute(1);  // in units of det J of the straight triangle, which is 1 here
    double largest = 0;
    for (int a = 0; a < 6; ++a) largest = std::max(largest, std::abs(element.coefficients(0)[a] - b[a]));
    return largest;
}

void tabulate_over_the_bend() {
    const std::vector<double> rule = simplex_quadrature(2, 6).xi, fine_rule = simplex_quadrature(2, 12).xi;
    std::printf("least det J\n    s   vertices  all nodes  %zu points  %zu points  coefficients  everywhere\n",
                rule.size() / 2, fine_rule.size() / 2);
    for (const double s : {0.0, 0.4, 0.8, 0.9, 0.95, 1.0, 1.1}) {
        const std::vector<double> x = bent(s), b = bezier_coefficients(x);
        std::printf("%5.2f %10.4f %10.4f %10.4f %10.4f %13.4f %11.4f\n", s, least({b[0], b[1], b[2]}),
                    least(det_at(x, nodes())), least(det_at(x, rule)), least(det_at(x, fine_rule)), least(b),
                    polynomial_minimum(bernstein, b.data(), 1e-6, 1000).upper);
    }
}

struct Piece {
    std::vector<Barycentric> corner;
    std::vector<double> b;
};

// Level by level, every piece that is not proved positive is cut in two. Stops where all are, or where a corner,
// which is a value of det J, proves that the triangle is not valid.
void certify(const std::vector<double>& b) {
    std::vector<Piece> open = {{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, b}};
    std::printf("level  pieces  least coefficient  least corner\n");
    for (int level = 0; !open.empty() && level < 20; ++level) {
        double lower = INFINITY, upper = INFINITY;
        std::vector<Piece> halves;
        for (const Piece& piece : open) {
            lower = std::min(lower, least(piece.b));
            upper = std::min(upper, least({piece.b[0], piece.b[1], piece.b[2]}));
            if (least(piece.b) > 0) continue;
            const auto [i, j] = longest_edge(piece.corner, {2, 0, 0});
            Piece near_i = piece, near_j = piece;
            for (int k = 0; k < 3; ++k)
                near_i.corner[j][k] = near_j.corner[i][k] = 0.5 * (piece.corner[i][k] + piece.corner[j][k]);
            bernstein.bisect(i, j, piece.b.data(), near_i.b.data(), near_j.b.data());
            halves.insert(halves.end(), {near_i, near_j});
        }
        std::printf("%5d %7zu %18.5f %13.5f\n", level, open.size(), lower, upper);
        if (upper <= 0) return (void)std::printf("not valid: a value is %.5f\n", upper);
        open = halves;
    }
    std::printf(open.empty() ? "valid everywhere: every coefficient of every piece is positive\n" : "undecided\n");
}

// det J over the reference triangle, and where the rule of 12 points looks at it.
void write_map(const std::vector<double>& x) {
    std::filesystem::create_directories("outputs/lessons/09-curving");
    std::FILE* file = std::fopen("outputs/lessons/09-curving/map.csv", "w");
    std::fprintf(file, "xi,eta,x,y,det\n");
    for (int j = 0; j <= 100; ++j)
        for (int i = 0; i <= 100 - j; ++i) {
            const double xi[2] = {0.01 * i, 0.01 * j};
            double N[6], at[2] = {0, 0};
            basis.values(xi, N);
            for (int k = 0; k < 12; ++k) at[k % 2] += N[k / 2] * x[k];
            std::fprintf(file, "%.2f,%.2f,%.5f,%.5f,%.5f\n", xi[0], xi[1], at[0], at[1], det_J(x, xi));
        }
    std::fclose(file);
    const std::vector<double> rule = simplex_quadrature(2, 6).xi;
    file = std::fopen("outputs/lessons/09-curving/points.csv", "w");
    std::fprintf(file, "xi,eta\n");
    for (std::size_t q = 0; q < rule.size(); q += 2) std::fprintf(file, "%.5f,%.5f\n", rule[q], rule[q + 1]);
    std::fclose(file);
}

}  // namespace

int main(int count, char** argument) {
    const double s = count > 1 ? std::atof(argument[1]) : 1;
    if (count == 1) tabulate_over_the_bend();
    const std::vector<double> b = bezier_coefficients(bent(s));
    std::printf("s = %g, coefficients %.4f %.4f %.4f %.4f %.4f %.4f", s, b[0], b[1], b[2], b[3], b[4], b[5]);
    std::printf("; difference from the program's: %.1e\n", largest_difference_from_the_program(bent(s), b));
    certify(b);
    if (count == 1) write_map(bent(s));
}
