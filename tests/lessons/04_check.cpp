#include "lessons/exercises/04.hpp"

#include "lessons/dense.hpp"
#include "lessons/eta_squared.hpp"
#include "lessons/exercise.hpp"
#include "lessons/plain_energy.hpp"
#include "lessons/square.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(order_of_convergence, first_inversion, positive_part, fix_nodes, minimise, curvatures, projected_second);

EXERCISE("4.1", "the order of convergence") {
    for (const auto& [p, constant] :
         {std::pair(1.0, 0.3), std::pair(1.5, 2.0), std::pair(2.0, 0.7), std::pair(3.0, 5.0)}) {
        std::vector<double> size = {7, 0.2};  // the first does not count
        while (size.size() < 4) size.push_back(constant * std::pow(size.back(), p));
        expect_close(concat("the order of size[k+1] = ", constant, " size[k]^", p), order_of_convergence(size), p, 1e-9,
                     "take logarithms of two ratios of successive sizes; the constant drops out");
    }
}

EXERCISE("4.2", "the step at which a triangle inverts") {
    using Vertices = std::array<Vec<2>, 3>;
    const Vertices x = {{{0, 0}, {1, 0}, {0, 1}}};
    const auto expect_t = [&](const char* what, const Vertices& d, double expected, const char* hint) {
        const double t = first_inversion(x, d);
        const bool near = std::isfinite(expected) && std::abs(t - expected) <= 1e-13 * expected;
        expect(t == expected || near, "t for ", what, " is ", t, ", expected ", expected, ": ", hint);
    };
    expect_t("one vertex that goes down", {{{0, 0}, {0, 0}, {0, -2}}}, 0.5,
             "it reaches the opposite edge; 1 - 2 t is linear, a quadratic's formula divides 0 by 0");
    expect_t("one vertex that goes up", {{{0, 0}, {0, 0}, {0, 2}}}, INFINITY,
             "the area grows; a root at t < 0 lies behind");
    expect_t("a translation", {{{3, 5}, {3, 5}, {3, 5}}}, INFINITY, "the area stays as it is");
    expect_t("a triangle that turns", {{{0, 0}, {0, 1}, {-1, 0}}}, INFINITY, "1 + t^2 has no root");
    expect_t("two vertices that swap", {{{0, 0}, {-1, 1}, {1, -1}}}, 0.5, "1 - 2 t: the area is linear here");
    expect_t("a triangle that grows first", {{{0, 0}, {1, 0}, {0, -1}}}, 1,
             "1 - t^2: the area has a root on either side");
    expect_t("two vertices that go down at different speeds", {{{0, 0}, {-3, 0}, {0, -1}}}, 1.0 / 3,
             "(1 - 3 t)(1 - t): the triangle is valid again after the second root, but the first one counts");
    for (const double small : {1e-6, 1e-9, 1e-12})
        expect_t("an area that is almost linear in t", {{{0, 0}, {small, 0}, {0, -2}}}, 0.5,
                 "(1 + small t)(1 - 2 t): -b + root loses its digits where 4 a c is small; the product of the roots is "
                 "c / a");
}

EXERCISE("4.3", "the positive semidefinite part of a matrix") {
    const Mat<2> flipped = positive_part({{{2, 0}, {0, -1}}});
    expect_close("entry 2 2 of the part of diag(2, -1)", flipped[1][1], 0, 1e-14,
                 flipped[1][1] == 1          ? "set negative eigenvalues to 0, not to their absolute value"
                 : std::isnan(flipped[1][1]) ? "off the diagonal are zeros: an eigenvector's formula divides 0 by 0"
                                             : "its eigenvalue -1 is left out");
    for (const Mat<2>& A :
         {Mat<2>{{{2, 0}, {0, -1}}}, Mat<2>{{{1, 2}, {2, 1}}}, Mat<2>{{{3, 1}, {1, 2}}}, Mat<2>{{{-3, 1}, {1, -2}}},
          Mat<2>{{{-1, -4}, {-4, 6}}}, Mat<2>{{{5, 0}, {0, 5}}}, Mat<2>{{{-5, 0}, {0, -5}}}}) {
        double expected[4] = {A[0][0], A[0][1], A[1][0], A[1][1]};
        project(2, expected);
        const Mat<2> part = positive_part(A);
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                expect_close(concat("entry ", i + 1, " ", j + 1, " of the part of (", A[0][0], ", ", A[0][1], "; ",
                                    A[1][0], ", ", A[1][1], ")"),
                             part[i][j], expected[2 * i + j], 1e-12,
                             "sum of max(eigenvalue, 0) v v' over eigenvectors v");
    }
}

EXERCISE("4.4", "fixing the boundary") {
    const Mesh mesh = unit_square(0);
    const Vector x = swirled(mesh, 40, false);
    PlainEnergy energy(mesh, mesh.x, {.objective = Objective::squared});
    BlockCsr H = energy.hessian_pattern();
    energy.add_hessian(x, HessianKind::full, H);
    Vector g(x.size(), 0.0);
    energy.add_gradient(x, g);

    std::vector<char> fixed(mesh.nodes(), 0);
    for (const int i : mesh.faces) fixed[i] = 1;
    std::vector<int> all, interior;
    for (int i = 0; i < 2 * mesh.nodes(); ++i) {
        all.push_back(i);
        if (!fixed[i / 2]) interior.push_back(i);
    }
    Vector expected, of_interior, d;
    for (const int i : interior) of_interior.push_back(-g[i]);
    solve_dense(dense_part(H, interior), of_interior, expected);

    fix_nodes(H, g, fixed);
    const Vector A = dense_part(H, all);
    const int n = static_cast<int>(all.size());
    double asymmetry = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) asymmetry = std::max(asymmetry, std::abs(A[i * n + j] - A[j * n + i]));
    expect(asymmetry < 1e-12, "H has become unsymmetric, by ", asymmetry,
           ": set columns of fixed nodes to 0, not only rows");
    for (double& entry : g) entry = -entry;
    expect(solve_dense(A, g, d, 1e-13),
           "H is singular: are nodes fixed, with the 2 x 2 identity on their diagonal? (four ones are singular too)");
    for (int i = 0; i < n; ++i)
        expect(!fixed[i / 2] || std::abs(d[i]) < 1e-12, "d at node ", i / 2, ", which is fixed, is ", d[i],
               ", expected 0", g[i] != 0 ? ": its entry of g is not 0" : "");
    for (std::size_t i = 0; i < interior.size(); ++i)
        expect_close(concat("d at node ", interior[i] / 2), d[interior[i]], expected[i], 1e-9,
                     "rows and columns of the other nodes must stay as they are");
}

// A function of one variable that keeps count and tells where it is called where it must not be.
double minimum(const std::function<double(double)>& f, const std::function<double(double)>& f1,
               const std::function<double(double)>& f2, double from) {
    Shared<int> calls;
    const auto finite_only = [&](const std::function<double(double)>& derivative) {
        return [&](double x) {
            expect(std::isfinite(f(x)), "a derivative is called at x = ", x, ", where f is ", f(x),
                   ": no step may end there; every comparison with nan is false, so write !(f(x + t d) <= ...)");
            expect(++calls < 1000, "no minimum after 1000 calls of derivatives, start ", from, ", now at x = ", x,
                   ": is any decrease enough for you, where Armijo asks for more?");
            return derivative(x);
        };
    };
    const double x = minimise(
        [&](double y) {
            expect(++calls < 10000, "no minimum after 10000 calls of f, start ", from,
                   ": is any decrease enough for you, or is a nan taken for one?");
            return f(y);
        },
        finite_only(f1), finite_only(f2), from);
    expect(std::abs(f1(x)) <= 1e-7, "from ", from, " it ends at x = ", x, " with f' = ", f1(x),
           ", expected |f'| <= 1e-7");
    return x;
}

EXERCISE("4.5", "Newton's method in one variable") {
    // Barrier at 0, concave beyond e: the full step from 20 leads away, or beyond the barrier.
    const auto f = [](double x) { return x > 0 ? std::log(x) * std::log(x) : INFINITY; };
    const auto f1 = [](double x) { return 2 * std::log(x) / x; };
    const auto f2 = [](double x) { return 2 * (1 - std::log(x)) / (x * x); };
    for (const double from : {0.05, 0.9, 2.0, 20.0, 1000.0})
        expect_close(concat("the minimum of log(x)^2 from ", from), minimum(f, f1, f2, from), 1, 1e-6);
    const auto undefined = [](double x) { return x > 0 ? std::log(x) * std::log(x) : NAN; };
    expect_close("the minimum of log(x)^2, nan for x < 0, from 2", minimum(undefined, f1, f2, 2.0), 1, 1e-6,
                 "every comparison with nan is false");
    // Newton's step goes from x to -0.99992 x: lower, but by less than Armijo asks for.
    const double p = 1.50002;
    const auto power = [p](double x) { return std::pow(std::abs(x), p); };
    const auto power1 = [p](double x) { return p * std::copysign(std::pow(std::abs(x), p - 1), x); };
    const auto power2 = [p](double x) { return p * (p - 1) * std::pow(std::abs(x), p - 2); };
    expect_close("the minimum of |x|^1.50002 from 1", minimum(power, power1, power2, 1), 0, 1e-6);
    const auto wells = [](double x) { return x * x * (x * x - 2); };
    const auto wells1 = [](double x) { return 4 * x * (x * x - 1); };
    const auto wells2 = [](double x) { return 12 * x * x - 4; };
    expect_close("the minimum of x^4 - 2 x^2 from 0.1", minimum(wells, wells1, wells2, 0.1), 1, 1e-6,
                 "at 0 is a maximum: Newton's method goes there where f'' < 0 is not replaced");
    const double of_sine = minimum([](double x) { return std::sin(x); }, [](double x) { return std::cos(x); },
                                   [](double x) { return -std::sin(x); }, 0);
    expect_close("sin at its minimum, from 0, where f'' = 0,", std::sin(of_sine), -1, 1e-12);
}

Mat<2> turn(double angle) {
    return {{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}}};
}

double along(const Mat<2>& A, const Mat<2>& B) {
    return A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[1][0] * B[1][0] + A[1][1] * B[1][1];
}

// One F = U diag(s1, s2) V', one density f.
void check_curvatures(double s1, double s2, const char* density, double f1, double f2) {
    const Mat<2> U = turn(0.7), V = turn(-1.9);
    const auto turned = [&](const Mat<2>& A) { return multiply<2>(multiply<2>(U, A), transpose<2>(V)); };
    const Mat<2> F = turned({{{s1, 0}, {0, s2}}});
    const double eta = distortion<2>(F, 0), r = std::sqrt(0.5);
    // H : W_FF K by lesson 2, from those of eta^2.
    const auto second = [&](const Mat<2>& H, const Mat<2>& K) {
        const double eta_H = along(W_F(F), H) / (2 * eta), eta_K = along(W_F(F), K) / (2 * eta);
        return f2 * eta_H * eta_K + f1 * (along(H, W_FF(F, K)) - 2 * eta_H * eta_K) / (2 * eta);
    };
    const std::string of = concat(" where the singular values are ", s1, " and ", s2, ", density ", density, ",");
    const Mat<2> twist = turned({{{0, -r}, {r, 0}}}), flip = turned({{{0, r}, {r, 0}}});
    const Mat<2> first = turned({{{1, 0}, {0, 0}}}), other = turned({{{0, 0}, {0, 1}}});
    const double trace = second(first, first) + second(other, other), size = std::max({1.0, trace, second(flip, flip)});
    const auto found = curvatures(F, f1, f2);
    const auto compare = [&](const std::string& what, double value, double expected, const char* hint) {
        expect(std::abs(value - expected) <= 1e-9 * size, what, of, " is ", value, ", expected ", expected, ": ", hint);
    };
    compare("the twist's eigenvalue", found[0], second(twist, twist),
            "(s1, -t; t, s2) has the determinant s1 s2 + t^2, and |F|^2 grows by 2 t^2; its length is sqrt 2 t");
    compare("the flip's eigenvalue", found[1], second(flip, flip),
            std::isnan(found[1]) ? "s1 = s2 is allowed, and nothing need be divided by s1 - s2"
                                 : "(s1, t; t, s2) has the determinant s1 s2 - t^2; its length is sqrt 2 t");
    compare("the sum of the stretches' eigenvalues", found[2] + found[3], trace,
            "second derivatives by s1 and s2 of f(cosh x), x = log(s1 / s2): f' and f'' both count");
    expect(found[2] <= found[3] + 1e-9 * size, "the stretches' eigenvalues", of, " are ", found[2], " and ", found[3],
           ": the smaller one comes first");
    const double product = second(first, first) * second(other, other) - std::pow(second(first, other), 2);
    expect(std::abs(found[2] * found[3] - product) <= 1e-9 * size * size, "the product of the stretches' eigenvalues",
           of, " is ", found[2] * found[3], ", expected ", product, ": W_12 is not zero");

    double expected[16];
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            Mat<2> H{}, K{};
            H[i / 2][i % 2] = K[j / 2][j % 2] = 1;
            expected[4 * i + j] = second(H, K);
        }
    project(4, expected);
    const auto part = projected_second(F, f1, f2);
    const auto on_part = [&](const Mat<2>& H) {
        double sum = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) sum += H[i / 2][i % 2] * part[i][j] * H[j / 2][j % 2];
        return sum;
    };
    compare("the projected curvature along the twist", on_part(twist), 0,
            "its eigenvalue is negative: leave it out; F = U S V' is not diagonal, each direction H becomes U H V'");
    compare("the projected curvature along the flip", on_part(flip), found[1],
            "its eigenvalue is positive: it stays, times L L' with L of length 1");
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            compare(concat("entry ", i + 1, " ", j + 1, " of the projected W_FF"), part[i][j], expected[4 * i + j],
                    "the flip, and the positive part of the 2 x 2 matrix of the stretches (mind the sign of W_12), "
                    "each with its directions");
}

EXERCISE("4.6", "an hour: the projection in closed form") {
    for (const auto& [s1, s2] :
         {std::array<double, 2>{2, 0.5}, {3, 2.9}, {1, 0.01}, {1, 1}, {0.2, 0.2}, {1, 0.9999999}}) {
        const double eta = (s1 / s2 + s2 / s1) / 2;
        check_curvatures(s1, s2, "eta", 1, 0);
        check_curvatures(s1, s2, "eta^2", 2 * eta, 2);
        check_curvatures(s1, s2, "(eta - 1)^2", 2 * (eta - 1), 2);
    }
}

}  // namespace
}  // namespace almesh::lessons
