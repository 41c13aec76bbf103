#include "lessons/exercises/05.hpp"

#include <algorithm>
#include <numeric>

#include "lessons/exercise.hpp"
#include "examples/linear_extension.hpp"
#include "method/set_boundary.hpp"
#include "deck/make_problem.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(laplacian_of_triangle, reach_of_translation, determinant_of_turn, turn_of_profile, reach_with_stiffness,
        reach_of_mesh);

bool is_close(double value, double expected, double tolerance) {
    return std::abs(value - expected) <= tolerance * std::abs(expected);
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

// K_ij = -cot(the angle at the third vertex) / 2, and rows have the sum 0.
Mat<3> cotangents(const std::array<Vec<2>, 3>& vertex) {
    Mat<3> K{};
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double ax = vertex[i][0] - vertex[k][0], ay = vertex[i][1] - vertex[k][1],
                     bx = vertex[j][0] - vertex[k][0], by = vertex[j][1] - vertex[k][1],
                     half = (ax * bx + ay * by) / (ax * by - ay * bx) / 2;
        K[i][j] -= half, K[j][i] -= half, K[i][i] += half, K[j][j] += half;
    }
    return K;
}

// Counter-clockwise, of any size, and with angles from 6 degrees on.
std::array<Vec<2>, 3> random_triangle() {
    Random& random = random_inputs();
    const double size = random.scale(1e-4, 1e4), turn = random.uniform(0, 6.28), x = random.uniform(-0.5, 1.5),
                 y = random.uniform(0.2, 1.5), c = size * std::cos(turn), s = size * std::sin(turn);
    const Vec<2> at = {size * random.uniform(-2, 2), size * random.uniform(-2, 2)};
    return {{at, {at[0] + c, at[1] + s}, {at[0] + c * x - s * y, at[1] + s * x + c * y}}};
}

EXERCISE("5.1", "the Laplacian of one triangle") {
    const Mat<3> right = laplacian_of_triangle({{{0, 0}, {1, 0}, {0, 1}}});
    expect_close("K_11 of the triangle (0, 0), (1, 0), (0, 1)", right[0][0], 1, 1e-12,
                 "grad N_1 = (-1, -1), and the area is 1/2");
    expect_close("K_12 of the same", right[0][1], -0.5, 1e-12);
    expect_close("K_23 of the same", right[1][2], 0, 1e-12, "the gradients of N_2 and N_3 are at a right angle");
    for (int k = 0; k < 12; ++k) {
        const std::array<Vec<2>, 3> vertex = random_triangle();
        const Mat<3> K = laplacian_of_triangle(vertex), expected = cotangents(vertex);
        const std::string of = concat(" of the triangle (", vertex[0][0], ", ", vertex[0][1], "), (", vertex[1][0],
                                      ", ", vertex[1][1], "), (", vertex[2][0], ", ", vertex[2][1], ")");
        double energy = 0, least = 0;  // of u = 2x - y: 5 times the area
        for (int i = 0; i < 3; ++i) {
            expect_close(concat("the sum of row ", i + 1, of), K[i][0] + K[i][1] + K[i][2], 0, 1e-9,
                         "a constant displacement costs nothing");
            for (int j = 0; j < 3; ++j) {
                const double uv = (2 * vertex[i][0] - vertex[i][1]) * (2 * vertex[j][0] - vertex[j][1]);
                energy += K[i][j] * uv, least += expected[i][j] * uv;
            }
        }
        expect(is_close(energy, least, 1e-6), "u'K u for u = 2x - y", of, " is ", energy, ", expected ", least,
               ", the integral of |grad u|^2");
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                expect_close(concat("K_", i + 1, j + 1, of), K[i][j], expected[i][j], 1e-9,
                             "a constant displacement costs nothing, but is that all that is known of K?");
    }
}

EXERCISE("5.2", "how far a circle can be translated") {
    for (int k = 0; k < 20; ++k) {
        const double r = k == 0 ? 1 : random_inputs().scale(1e-5, 1e5), gap = random_inputs().scale(0.02, 1e4),
                     R = k == 0 ? 21 : r * (1 + gap), d = reach_of_translation(r, R),
                     det = 1 - d / (r * std::log(R / r));
        expect(std::abs(det) < 1e-9, "for r = ", r, ", R = ", R, " you say ", d, ", where du/dx + 1 = ", det,
               " in front of the circle, not 0", d == R - r ? ": the gap is not what counts" : "");
    }
}

EXERCISE("5.3", "how far a circle can be turned") {
    for (int k = 0; k < 30; ++k) {
        const double R = k == 0 ? 21 : 1 + random_inputs().scale(0.05, 50), theta = random_inputs().uniform(-3.1, 3.1),
                     r = k < 6 ? 1 : k < 10 ? R : random_inputs().uniform(1, R);
        const double s = (R * R / (r * r) - 1) / (R * R - 1), rs = -2 * R * R / (r * r) / (R * R - 1);
        const double w = 1 - std::cos(theta), expected = 1 - 2 * s * (1 - s) * w + rs * w * (2 * s - 1);
        const double found = determinant_of_turn(theta, R, r);
        expect_close(concat("det F for theta = ", theta, ", R = ", R, ", at the distance ", r), found, expected, 1e-9,
                     r > 1 && std::abs(found - 1 + 2 * R * R / (R * R - 1) * w) < 1e-9 ? "that is det F at the circle"
                     : r == R ? "the outer circle stays where it is, but what is next to it is moved"
                              : "both components of u are harmonic, and at the outer circle they are 0");
    }
}

EXERCISE("5.4", "any profile") {
    for (const double slope :
         {-0.49, -0.1, 0.0, 0.5, random_inputs().scale(0.6, 100), -random_inputs().uniform(0, 0.499)}) {
        const double found = turn_of_profile(slope);
        expect(std::isinf(found) && found > 0, "with the slope ", slope, " you say ", found,
               ": det F at the circle is above 0 for every angle, expected infinity");
    }
    for (int k = 0; k < 20; ++k) {
        const double slope = k == 0 ? -2 : k == 1 ? -0.5 : -0.5 - random_inputs().scale(1e-3, 50);
        const double found = turn_of_profile(slope), det = 1 + slope * (1 - std::cos(found));
        expect(found > 0 && found < 3.1416, "with the slope ", slope, " you say ", found,
               ": expected an angle in radians, above 0 and no more than pi");
        expect(std::abs(det) < 1e-9 * std::abs(slope), "with the slope ", slope, " you say ", found,
               ", where det F at the circle is ", det, ", not 0");
    }
}

EXERCISE("5.5", "increments") {
    expect_only("turned", {"mesh = ../../../meshes/circle.msh", "boundary inner = rotate 100 about 0 0",
                           "boundary outer = fixed"}, {"let increments"});
    const std::string given = keys_of_deck("turned")["let increments"];
    const int increments = std::atoi(given.c_str());
    expect(given == concat(increments), "turned.deck has `let increments = ", given, "`, expected a whole number");
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

// A ring of any size, with rows of nodes at radii that grow geometrically, as the triangles do; those inside are
// shaken, nodes and triangles have any numbers, and some triangles are a hundred times as stiff as others.
Extension shaken_ring(int rows, int around) {
    Random& random = random_inputs();
    Extension mesh;
    const double size = random.scale(0.01, 100), growth = std::pow(random.uniform(3, 8), 1.0 / rows);
    std::vector<int> place((rows + 1) * around);
    std::iota(place.begin(), place.end(), 0);
    random.shuffle(place);
    mesh.x.resize(place.size());
    mesh.moved.resize(place.size());
    mesh.held.resize(place.size());
    for (int k = 0; k <= rows; ++k)
        for (int i = 0; i < around; ++i) {
            const double r = size * std::pow(growth, k), phi = (i + 0.5 * k) * 6.283185307179586 / around;
            const double by = k == 0 || k == rows ? 0 : 0.2 * r * std::min(growth - 1, 6.28 / around);
            const int node = place[k * around + i];
            mesh.x[node] = {r * std::cos(phi) + random.uniform(-by, by), r * std::sin(phi) + random.uniform(-by, by)};
            mesh.moved[node] = k == 0;
            mesh.held[node] = k == rows;
        }
    for (int k = 0; k < rows; ++k)
        for (int i = 0; i < around; ++i) {
            const int next = (i + 1) % around, a = place[k * around + i], b = place[k * around + next],
                      c = place[(k + 1) * around + i], d = place[(k + 1) * around + next];
            mesh.triangles.push_back({c, b, a});
            mesh.triangles.push_back({b, c, d});
        }
    random.shuffle(mesh.triangles);
    for (std::size_t e = 0; e < mesh.triangles.size(); ++e) mesh.stiffness.push_back(random.scale(0.1, 10));
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

void expect_reach(double p, double R) {
    const double found = reach_with_stiffness(p, R), expected = measured_reach(p, R);
    expect(is_close(found, expected, 1e-6), "the reach for p = ", p, ", R = ", R, " is ", found, ", expected ",
           expected,
           p > 1                ? ": is det F the least in front of the circle for every p?"
           : std::abs(p) < 1e-2 ? ": the limit for p to 0, with as many digits as for other p"
                                : ": how steep is u where it is steepest?");
}

// The triangle (0, 0), (h, 0), (0, h) of which one vertex is moved, or all.
Extension one_triangle(double h, int moved) {
    Extension mesh{{{0, 0}, {h, 0}, {0, h}}, {{0, 1, 2}}, {1}, {}, {}};
    for (int v = 0; v < 3; ++v) {
        mesh.moved.push_back(moved < 0 || v == moved);
        mesh.held.push_back(!mesh.moved.back());
    }
    return mesh;
}

EXERCISE("5.6", "an hour: the stiffness that gets farthest") {
    for (const double p : {0.0, 1e-12, -1e-10, 0.5, 1.0, 2.0, -1.0}) expect_reach(p, 21);
    for (int k = 0; k < 6; ++k)
        expect_reach((k % 2 ? 1 : -1) * (k < 4 ? random_inputs().scale(1e-5, 1e-3) : random_inputs().scale(1e-9, 1e-5)),
                     1 + random_inputs().scale(1, 100));
    for (int k = 0; k < 12; ++k)
        expect_reach(random_inputs().uniform(-3, 4), k < 3 ? 21 : 1 + random_inputs().scale(0.05, 100));
    for (int k = 0; k < 4; ++k) {
        Extension mesh = shaken_ring(random_inputs().integer(2, 6), random_inputs().integer(7, 14));
        const double found = reach_of_mesh(mesh);
        const Reaches expected = measured_reaches(mesh);
        const std::string on = concat("the reach on a ring of ", mesh.triangles.size(), " triangles is ", found,
                                      ", expected ", expected.first_inversion);
        std::fill(mesh.stiffness.begin(), mesh.stiffness.end(), 1.0);
        const Reaches uniform = measured_reaches(mesh);
        const auto is = [&](double value) { return is_close(found, value, 1e-6); };
        expect(is_close(found, expected.first_inversion, 1e-8), on,
               is(expected.largest_slope)
                   ? ": there |grad u| d is 1; but slopes across the motion shear triangles and do "
                     "not invert them"
               : is(uniform.first_inversion) ? ": that is the reach where all triangles are equally stiff"
                                             : ": at which d has the first triangle no area?");
        expect(is_close(reach_of_mesh(mesh), uniform.first_inversion, 1e-8),
               "the same, all triangles equally stiff, is ", reach_of_mesh(mesh), ", expected ",
               uniform.first_inversion);
    }
    const double h = random_inputs().scale(0.01, 100), along = reach_of_mesh(one_triangle(h, 0));
    expect(is_close(along, h, 1e-9), "(0, 0) of the triangle (0, 0), (", h, ", 0), (0, ", h,
           ") is moved, the others are ", "held: the reach is ", along, ", expected ", h);
    for (const int moved : {1, 2, -1})
        expect(reach_of_mesh(one_triangle(h, moved)) == INFINITY, "the reach of the triangle (0, 0), (", h,
               ", 0), (0, ", h, ") is ", reach_of_mesh(one_triangle(h, moved)), " if ",
               moved < 0    ? "all are"
               : moved == 1 ? "the second is"
                            : "the third is",
               " moved and nothing else: that ", "inverts nothing, expected infinity");
}

}  // namespace
}  // namespace almesh::lessons
