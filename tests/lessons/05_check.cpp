#include "lessons/exercises/05.hpp"

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

// The map that turns the circle of radius 1 and fades out with the profile s(r).
Vec<2> turned(Vec<2> x, double theta, const std::function<double(double)>& s) {
    const double c = std::cos(theta) - 1, q = std::sin(theta), fade = s(std::hypot(x[0], x[1]));
    return {x[0] + fade * (c * x[0] - q * x[1]), x[1] + fade * (q * x[0] + c * x[1])};
}

// det F at (1, 0), by central differences.
double measured(double theta, const std::function<double(double)>& s) {
    const double h = 1e-5;
    const Vec<2> right = turned({1 + h, 0}, theta, s), left = turned({1 - h, 0}, theta, s),
                 up = turned({1, h}, theta, s), down = turned({1, -h}, theta, s);
    return ((right[0] - left[0]) * (up[1] - down[1]) - (up[0] - down[0]) * (right[1] - left[1])) / (4 * h * h);
}

EXERCISE("5.1", "the Laplacian of one triangle") {
    const Mat<3> right = laplacian_of_triangle({{{0, 0}, {1, 0}, {0, 1}}});
    expect_close("K_11 of the triangle (0, 0), (1, 0), (0, 1)", right[0][0], 1, 1e-12,
                 "grad N_1 = (-1, -1), and the area is 1/2");
    expect_close("K_12 of the same", right[0][1], -0.5, 1e-12);
    expect_close("K_23 of the same", right[1][2], 0, 1e-12, "the gradients of N_2 and N_3 are at a right angle");
    const std::array<Vec<2>, 3> vertex = {{{1, 1}, {4, 2}, {2, 5}}};
    const Mat<3> K = laplacian_of_triangle(vertex);
    for (int i = 0; i < 3; ++i)
        expect_close(concat("sum of row ", i + 1), K[i][0] + K[i][1] + K[i][2], 0, 1e-12,
                     "a constant displacement costs nothing");
    // u = 2x - y has |grad u|^2 = 5 on an area of 5.5.
    double energy = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            energy += K[i][j] * (2 * vertex[i][0] - vertex[i][1]) * (2 * vertex[j][0] - vertex[j][1]);
    expect_close("u'K u for u = 2x - y on an area of 5.5", energy, 27.5, 1e-9, "the integral of |grad u|^2");
}

EXERCISE("5.2", "how far a circle can be translated") {
    for (const auto& [r, R] : {std::array<double, 2>{1, 21}, {0.5, 4}, {2, 200}}) {
        const double d = reach_of_translation(r, R), h = 1e-6;
        const auto x_of = [&, inner = r, outer = R](double x) {
            return x + d * std::log(outer / x) / std::log(outer / inner);
        };
        const double det = (x_of(r + h) - x_of(r)) / h;
        expect(std::abs(det) < 1e-4, "for r = ", r, ", R = ", R, " you say ", d, ", where du/dx + 1 = ", det,
               " in front of the circle, not 0", d == R - r ? ": the gap is not what counts" : "");
    }
}

EXERCISE("5.3", "how far a circle can be turned") {
    for (const double R : {21.0, 2.0})
        for (const double theta : {0.3, 1.5}) {
            const auto s = [R](double r) { return (R * R / (r * r) - 1) / (R * R - 1); };
            expect_close(
                concat("det F for theta = ", theta, ", R = ", R), determinant_at_circle(theta, R), measured(theta, s),
                1e-6,
                "the harmonic functions like cos phi are r cos phi and cos phi / r: which sum is 1 at r = 1 and 0 at "
                "r = R?");
        }
}

EXERCISE("5.4", "any profile") {
    for (const double slope : {-2.0, -0.3})
        for (const double theta : {0.3, 2.0, 3.1})
            expect_close(concat("det F for theta = ", theta, ", slope ", slope), determinant_of_profile(theta, slope),
                         measured(theta, [slope](double r) { return 1 + slope * (r - 1); }), 1e-6,
                         "F = Q + s' (Q - I) x x', and det(I + a b') = 1 + a.b");
}

EXERCISE("5.5", "increments") {
    expect_only("turned", {"mesh = ../../../meshes/circle.msh", "boundary inner = rotate 100 about 0 0",
                           "boundary outer = fixed", "method = harmonic"}, {"increments"});
    const int increments = std::atoi(keys_of_deck("turned")["increments"].c_str());
    expect(increments > 1, "turned.deck has ", increments, " increments: at once the elements are inverted");
    expect(run_deck("turned").at("certified_valid") == "yes", "with ", increments,
           " increments elements are inverted; the lesson's table tells how far one gets");
    expect(run_deck("turned", {concat("increments=", increments - 1)}).at("certified_valid") == "no", increments - 1,
           " increments are enough");
}

}  // namespace
}  // namespace almesh::lessons
