#include "lessons/exercises/05.hpp"

#include "lessons/exercise.hpp"
#include "examples/linear_extension.hpp"
#include "method/set_boundary.hpp"
#include "deck/make_problem.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(laplacian_of_triangle, reach_of_translation, determinant_at_circle, determinant_of_profile, reach_with_stiffness,
        reach_of_mesh);

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

// The mesh of turned.deck, its displacement extended harmonically in so many increments.
bool is_valid_turned_in(int increments) {
    const Deck deck = read_deck(path_of("turned"));
    const Problem problem = make_problem(deck);
    set_functional(deck, problem);
    const Level& level = *problem.level;
    const BlockCsr pattern = level.energy->hessian_pattern();
    std::vector<double> x = level.ideal;
    for (int k = 1; k <= increments && level.is_valid(x); ++k) {
        std::vector<double> u = level.with_boundary(targets_at(level, static_cast<double>(k) / increments), x);
        for (std::size_t i = 0; i < x.size(); ++i) u[i] -= x[i];
        extend_displacement(level.mesh, pattern, harmonic_stiffness, deck.linear, x, level.on_boundary(), u);
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += u[i];
    }
    return level.is_valid(x);
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
                           "boundary outer = fixed"}, {"let increments"});
    const int increments = std::atoi(keys_of_deck("turned")["let increments"].c_str());
    expect(increments > 1, "turned.deck has ", increments, " increments: at once the elements are inverted");
    expect(is_valid_turned_in(increments), "with ", increments,
           " increments elements are inverted; the lesson's table tells how far one gets");
    expect(!is_valid_turned_in(increments - 1), increments - 1, " increments are enough");
}

// In units of the motion, u of div(r^-p grad u) = 0 has the slope r^(p-1) / integral of it.
double measured_reach(double p, double R) {
    const int n = 400;
    const double h = std::log(R) / n;
    double integral = 0, steepest = 0;
    for (int k = 0; k <= n; ++k) {  // Simpson's rule in log r
        integral += h / 3 * (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * std::exp(p * k * h);
        steepest = std::max(steepest, std::exp((p - 1) * k * h));
    }
    return integral / steepest;
}

// A ring from radius 1 to 6 with rows of nodes at radii that grow geometrically, as the triangles do; those inside are
// shaken, and no two triangles are equally stiff.
Extension shaken_ring(int rows, int around) {
    Extension mesh;
    const double growth = std::pow(6, 1.0 / rows);
    for (int k = 0; k <= rows; ++k)
        for (int i = 0; i < around; ++i) {
            const double r = std::pow(growth, k), phi = (i + 0.5 * k) * 6.283185307179586 / around;
            const double by = k == 0 || k == rows ? 0 : 0.2 * r * (growth - 1);
            const double by_x = by * std::sin(7 * i + 3 * k), by_y = by * std::cos(5 * i);
            mesh.x.push_back({r * std::cos(phi) + by_x, r * std::sin(phi) + by_y});
            mesh.moved.push_back(k == 0);
            mesh.held.push_back(k == rows);
        }
    for (int k = 0; k < rows; ++k)
        for (int i = 0; i < around; ++i) {
            const int a = k * around + i, b = k * around + (i + 1) % around, c = a + around, d = b + around;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({b, c, d});
        }
    for (std::size_t e = 0; e < mesh.triangles.size(); ++e)
        mesh.stiffness.push_back(1.5 + std::sin(static_cast<double>(e)));
    return mesh;
}

struct Reaches {
    double first_inversion = INFINITY, largest_slope = INFINITY;
};

// From areas before and after, by a system of its own.
Reaches measured_reaches(const Extension& mesh) {
    const std::size_t n = mesh.x.size();
    std::vector<double> K(n * n, 0.0), b(n, 0.0), u;
    const auto edge = [&](const std::array<int, 3>& t, int i) {  // opposite to vertex i
        const Vec<2>&from = mesh.x[t[(i + 1) % 3]], &to = mesh.x[t[(i + 2) % 3]];
        return Vec<2>{to[0] - from[0], to[1] - from[1]};
    };
    const auto area = [&](const std::array<int, 3>& t) {
        const Vec<2> p = edge(t, 0), q = edge(t, 1);
        return (p[0] * q[1] - p[1] * q[0]) / 2;
    };
    for (std::size_t e = 0; e < mesh.triangles.size(); ++e)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const auto& t = mesh.triangles[e];
                const Vec<2> p = edge(t, i), q = edge(t, j);
                K[t[i] * n + t[j]] += mesh.stiffness[e] * (p[0] * q[0] + p[1] * q[1]) / (4 * area(t));
            }
    for (std::size_t i = 0; i < n; ++i)
        if (mesh.moved[i] || mesh.held[i]) {
            std::fill_n(&K[i * n], n, 0.0);
            K[i * n + i] = 1;
            b[i] = mesh.moved[i];
        }
    expect(solve_dense(K, b, u), "the check's own system is singular");
    Reaches reach;
    for (const auto& t : mesh.triangles) {
        double by_x = 0, by_y = 0;  // twice the area times the gradient of u
        for (int i = 0; i < 3; ++i) {
            by_x -= edge(t, i)[1] * u[t[i]];
            by_y += edge(t, i)[0] * u[t[i]];
        }
        if (by_x < 0) reach.first_inversion = std::min(reach.first_inversion, -2 * area(t) / by_x);
        reach.largest_slope = std::min(reach.largest_slope, 2 * area(t) / std::hypot(by_x, by_y));
    }
    return reach;
}

EXERCISE("5.6", "an hour: the stiffness that gets farthest") {
    for (const double R : {21.0, 3.0})
        for (const double p : {0.0, 1e-12, 0.5, 1.0, 2.0, -1.0}) {
            const double found = reach_with_stiffness(p, R), expected = measured_reach(p, R);
            expect_close(concat("the reach for p = ", p, ", R = ", R), found, expected, 1e-6,
                         p > 1 ? "r u' / r^p is constant: where is u' the steepest if p > 1?"
                         : std::abs(p) < 1e-6 ? "(R^p - 1) / p tends to log R; std::expm1 keeps its digits"
                                              : "r u' / r^p is constant, u falls from d to 0; det F = 1 + u' in front");
        }
    Extension mesh = shaken_ring(6, 14);
    const double found = reach_of_mesh(mesh);
    const Reaches expected = measured_reaches(mesh);
    std::fill(mesh.stiffness.begin(), mesh.stiffness.end(), 1.0);
    const Reaches uniform = measured_reaches(mesh);
    const auto is = [&](double value) { return std::abs(found - value) < 1e-6 * value; };
    expect_close("the reach on a ring of 168 triangles", found, expected.first_inversion, 1e-9,
                 is(expected.largest_slope)
                     ? "there |grad u| d is 1; but slopes across the motion shear triangles and do not invert them"
                 : is(uniform.first_inversion)
                     ? "that is the reach where all triangles are equally stiff"
                     : "u of the motion d = 1 from one solve; then det F = 1 + d du/dx on each triangle");
    expect_close("the same, all triangles equally stiff,", reach_of_mesh(mesh), uniform.first_inversion, 1e-9);
}

}  // namespace
}  // namespace almesh::lessons
