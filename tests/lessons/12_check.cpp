#include "lessons/exercises/12.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lessons/exercise.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"

namespace almesh::lessons {

// Of the judge the densities are those of the answers, which run in children.
MEMBER_ANSWERS(CubicDensity, f, f1, f2)
MEMBER_ANSWERS(BarrierDensity, f, f1, f2)

namespace {

ANSWERS(blended);

// The gradient with respect to F from the library's template, against differences.
template <class Density>
void check_gradient(const Density& density) {
    Mat<2> F = {{{1, 0}, {0, 1}}};
    for (auto& row : F)
        for (double& entry : row) entry += random_inputs().uniform(-0.15, 0.15);
    const Mat<2> P = density_gradient<2>(F, 0.0, density);
    const double h = 1e-5;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            Mat<2> ahead = F, behind = F;
            ahead[i][j] += h;
            behind[i][j] -= h;
            const double slope =
                (density.f(distortion<2>(ahead, 0.0)) - density.f(distortion<2>(behind, 0.0))) / (2 * h);
            expect_close(concat("df/dF_", i, j), P[i][j], slope, 1e-6, "f and f' do not belong together");
        }
}

// expected: f, f', f'' at eta.
template <class Density>
void check_density(const Density& density, double eta, const std::array<double, 3>& expected, const std::string& with) {
    const std::string at = concat(" at eta = ", eta, with, " is ");
    const double found[] = {density.f(eta), density.f1(eta), density.f2(eta)};
    const auto is = [&](int k) {
        return std::abs(found[k] - expected[k]) <= 1e-12 * std::max(1.0, std::abs(expected[k]));
    };
    expect(is(0), "f", at, found[0], ", expected ", expected[0],
           eta == 1 ? ": an undistorted element costs nothing" : "");
    expect(is(1), "f'", at, found[1], ", expected ", expected[1], ": f' is not the derivative of f",
           found[1] < 0 ? ", which has to grow with the distortion" : "");
    expect(is(2), "f''", at, found[2], ", expected ", expected[2], ": f'' is not the derivative of f'",
           found[2] < 0 ? "; f has to be convex" : "");
}

EXERCISE("12.1", "a cubic density") {
    for (int k = 0; k < 20; ++k) {
        const double kappa = k < 4 ? 0.5 : k < 6 ? 0 : random_inputs().scale(0.05, 20),
                     eta = k == 0 || k == 4 ? 1 : 1 + random_inputs().scale(0.01, 10), e = eta - 1;
        check_density(CubicDensity{kappa}, eta,
                      {e * e * e + kappa * e * e, 3 * e * e + 2 * kappa * e, 6 * e + 2 * kappa},
                      concat(" with kappa = ", kappa));
    }
    check_gradient(CubicDensity{random_inputs().uniform(0, 3)});
}

EXERCISE("12.2", "another barrier") {
    for (int k = 0; k < 20; ++k) {
        const double M = k < 4 ? 1.35 : 1 + random_inputs().scale(0.05, 20), a = 1 - M, b = a * a,
                     eta = k % 4 == 0 ? 1 : 1 + (M - 1) * random_inputs().uniform(0, 0.98), left = M - eta;
        check_density(BarrierDensity{M}, eta, {a + b / left, b / (left * left), 2 * b / (left * left * left)},
                      concat(" with M = ", M));
        for (const double beyond : {M, M + random_inputs().scale(0.01, 100)})
            expect(BarrierDensity{M}.f(beyond) == INFINITY, "f(", beyond, ") is ", BarrierDensity{M}.f(beyond),
                   " with M = ", M, ", expected infinity: a long step may jump over the barrier");
    }
    check_gradient(BarrierDensity{random_inputs().uniform(1.5, 3)});
}

// det of the derivative of the map at y, by differences.
double determinant_at(const Vec<2>& y, double d) {
    const double h = 1e-6;
    const Vec<2> a = blended({y[0] - h, y[1]}, d), b = blended({y[0] + h, y[1]}, d), c = blended({y[0], y[1] - h}, d),
                 e = blended({y[0], y[1] + h}, d);
    return ((b[0] - a[0]) * (e[1] - c[1]) - (b[1] - a[1]) * (e[0] - c[0])) / (4 * h * h);
}

struct Least {
    double determinant = INFINITY;
    Vec<2> at{};
};

// On points close to each other: in front of the circle, where it is crowded, and on rays all around.
Least least_determinant(double d) {
    const double first = 1.01 + random_inputs().uniform(0, 0.02), front = d > 0 ? 0 : std::acos(-1.0);
    return in_child([&] {
        Least least;
        for (int ray = 0; ray < 24; ++ray)
            for (double r = first; r < 20.99; r += 0.02) {
                const double angle = front + ray * std::acos(-1.0) / 12;
                const Vec<2> y = {r * std::cos(angle), r * std::sin(angle)};
                const double determinant = determinant_at(y, d);
                if (std::isnan(determinant)) return Least{determinant, y};
                if (determinant < least.determinant) least = {determinant, y};
            }
        return least;
    });
}

// By halving: in a continuous map the change across that half of a path which has more of it goes to zero.
void expect_continuous(const std::function<Vec<2>(double)>& path, double from, double to, double d) {
    const auto shift = [&](double t) {
        const Vec<2> y = path(t), x = blended(y, d);
        return Vec<2>{x[0] - y[0], x[1] - y[1]};
    };
    const auto change = [](const Vec<2>& a, const Vec<2>& b) { return std::hypot(b[0] - a[0], b[1] - a[1]); };
    Vec<2> at_from = shift(from), at_to = shift(to);
    for (int k = 0; k < 28; ++k) {
        const double t = 0.5 * (from + to);
        const Vec<2> middle = shift(t);
        if (change(at_from, middle) > change(middle, at_to)) to = t, at_to = middle;
        else from = t, at_from = middle;
    }
    const Vec<2> at = path(from);
    expect(change(at_from, at_to) < 1e-4, "d = ", d, ": the map jumps near (", at[0], ", ", at[1], "), by ",
           change(at_from, at_to));
}

// Along rays and parts of circles.
void expect_continuous(double d) {
    const double turn = random_inputs().uniform(0, 6.28), radius = random_inputs().uniform(0, 1);
    in_child([&] {
        const auto at = [](double r, double angle) { return Vec<2>{r * std::cos(angle), r * std::sin(angle)}; };
        for (int k = 0; k < 40; ++k) {
            const double angle = turn + k * std::acos(-1.0) / 20, r = 1 + 4 * (k % 5 + radius);
            expect_continuous([&](double t) { return at(t, angle); }, 1, 21, d);
            expect_continuous([&](double t) { return at(r, t); }, angle, angle + std::acos(-1.0) / 4, d);
        }
        return true;
    });
}

EXERCISE("12.3", "a valid start") {
    const double small = random_inputs().uniform(-12, 12), forth = random_inputs().uniform(19.9, 19.99),
                 back = -random_inputs().uniform(19.9, 19.99);
    for (const double d : {small, forth, back}) {
        for (int k = 0; k < 3; ++k) {
            const double angle = random_inputs().uniform(0, 6.28);
            const Vec<2> u = {std::cos(angle), std::sin(angle)};
            const Vec<2> inner = blended(u, d), outer = blended({21 * u[0], 21 * u[1]}, d);
            const std::string of = concat("d = ", d, ": a point of the ");
            expect_close(of + "inner circle is off in x by", inner[0] - u[0] - d, 0, 1e-9);
            expect_close(of + "inner circle is off in y by", inner[1] - u[1], 0, 1e-9);
            expect_close(of + "outer circle moves in x by", outer[0] - 21 * u[0], 0, 1e-9,
                         "only the inner one moves: let the motion fade with |y|");
            expect_close(of + "outer circle moves in y by", outer[1] - 21 * u[1], 0, 1e-9);
        }
        const Least least = least_determinant(d);
        expect(least.determinant > 1e-6, "d = ", d, ": det of the map is ", least.determinant, " at (", least.at[0],
               ", ", least.at[1], "): the motion fades too fast there");
        expect_continuous(d);
    }
}

EXERCISE("12.4", "an ellipse (ellipse.deck)") {
    expect_only("ellipse", {"mesh = ../../../meshes/circle.msh", "boundary outer = fixed"}, {"boundary inner"});
    const auto summary = run_deck("ellipse");
    expect(summary.at("status") == "converged", "the run ends with ", summary.at("status"));
    expect(summary.at("certified_valid") == "yes", "an element is not certified valid");
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(read_mesh("outputs/lessons/answers/ellipse/final.msh"), notes);
    int count = 0;
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int k = 0; k < 2; ++k) {
            if (mesh.boundaries[mesh.face_boundary[f]] != "inner") continue;
            const double* const x = point(mesh.x, mesh.face(f)[k], 2);
            const double level = x[0] * x[0] / 4 + 4 * x[1] * x[1];
            expect_close(concat("(x/2)^2 + (2y)^2 at the boundary node (", x[0], ", ", x[1], ")"), level, 1, 1e-6,
                         "stretch x, squeeze y; each by 2");
            ++count;
        }
    expect(count == 64, "the final mesh has ", count / 2, " faces on the boundary inner, expected 32");
}

EXERCISE("12.5", "row 3 of Table 1 (table_row.deck)") {
    expect_only("table_row", {"mesh = ../../../meshes/circle.msh", "boundary inner = translate 8 0",
                              "boundary outer = fixed", "algorithm = paper", "length_scale = 1", "mu0 = 24",
                              "omega0 = 0.1", "epsilon0 = 1e-4", "omega_star = 1e-6",
                              "epsilon_star = 1e-14"}, {"refine", "objective"});
    const auto summary = run_deck("table_row");
    expect(number(summary, "elements") == 26272, "the mesh has ", number(summary, "elements"),
           " triangles, the row has 26272: each refinement makes four of one");
    expect(summary.at("status") == "converged", "the run ends with ", summary.at("status"));
    const double q = number(summary, "relative_quality");
    expect(std::abs(q - 0.937) < 0.001, "q is ", q, ", the paper has 0.937",
           std::abs(q - 0.9259) < 0.001 ? ": that is the minimum of Eq. 5; which functional are the tables of?" : "");
    expect(number(summary, "al_iterations") <= 8, number(summary, "al_iterations"), " iterations, the paper has 6");
}

}  // namespace
}  // namespace almesh::lessons
