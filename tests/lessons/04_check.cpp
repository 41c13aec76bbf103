#include "lessons/exercises/04.hpp"

#include "lessons/dense.hpp"
#include "lessons/eta_squared.hpp"
#include "lessons/exercise.hpp"
#include "lessons/plain_energy.hpp"
#include "lessons/random_inputs.hpp"
#include "lessons/square.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(order_of_convergence, first_inversion, positive_part, fix_nodes, minimise, curvatures, projected_second);

EXERCISE("4.1", "the order of convergence") {
    Random& random = random_inputs();
    for (int k = 0; k < 12; ++k) {
        const double p = k < 4 ? 1 + k % 3 : random.uniform(1, 3.5), first = random.uniform(-3, -0.3);
        const double unit = k < 6 ? 0 : random.uniform(-15, 15);  // of length
        std::vector<double> size;
        while (static_cast<int>(size.size()) < k % 5) size.push_back(random.scale(1e-3, 1e3));  // do not count
        for (const double log : {0.0, first, first + p * first}) size.push_back(std::exp(unit + log));
        expect_close(concat("the order of ", listed(size)), order_of_convergence(size), p, 1e-9,
                     "size[k+1] = constant size[k]^p for the last three: which quantity does not have the constant?");
    }
}

// first_inversion() of the unit triangle with the velocities d, then of images of both: the area has the same roots.
void expect_t(const std::string& what, const Corners& d, double expected, const char* hint, double tolerance = 1e-12) {
    Random& random = random_inputs();
    for (int k = 0; k < 3; ++k) {
        Mat<2> M = {{{1, 0}, {0, 1}}};
        while (k > 0 && (determinant(M) <= 0 || M[0][1] == 0))
            for (auto& row : M)
                for (double& entry : row) entry = random.integer(-3, 3);
        const double two = k ? std::ldexp(1, random.integer(-40, 40)) : 1;
        const Vec<2> origin = {k * two * random.integer(-5, 5), k * two * random.integer(-5, 5)};
        const Corners unit = {{{0, 0}, {1, 0}, {0, 1}}};
        Corners x, velocity;
        for (int i = 0; i < 3; ++i) {
            x[(i + k) % 3] = times<2>(scaled<2>(two, M), unit[i]);
            for (int a = 0; a < 2; ++a) x[(i + k) % 3][a] += origin[a];
            velocity[(i + k) % 3] = times<2>(scaled<2>(two, M), d[i]);
        }
        const double t = first_inversion(x, velocity);
        const bool near = std::isfinite(expected) && std::abs(t - expected) <= tolerance * expected;
        expect(t == expected || near, "t for ", what, ", vertices (", listed(x[0]), "), (", listed(x[1]), "), (",
               listed(x[2]), ") with the velocities (", listed(velocity[0]), "), (", listed(velocity[1]), "), (",
               listed(velocity[2]), "), is ", t, ", expected ", expected, ": ", hint);
    }
}

EXERCISE("4.2", "the step at which a triangle inverts") {
    Random& random = random_inputs();
    expect_t("one vertex that goes down", {{{0, 0}, {0, 0}, {0, -2}}}, 0.5,
             "it reaches the opposite edge; 1 - 2 t is linear, a quadratic's formula divides 0 by 0");
    expect_t("one vertex that goes up", {{{0, 0}, {0, 0}, {0, 2}}}, INFINITY,
             "the area grows; a root at t < 0 lies behind");
    expect_t("a translation", {{{3, 5}, {3, 5}, {3, 5}}}, INFINITY, "the area stays as it is");
    expect_t("a triangle that stays", {}, INFINITY, "the area stays as it is");
    expect_t("a triangle that turns", {{{0, 0}, {0, 1}, {-1, 0}}}, INFINITY, "1 + t^2 has no root");
    expect_t("two vertices that swap", {{{0, 0}, {-1, 1}, {1, -1}}}, 0.5, "1 - 2 t: the area is linear here");
    expect_t("a triangle that grows first", {{{0, 0}, {1, 0}, {0, -1}}}, 1,
             "1 - t^2: the area has a root on either side");
    expect_t("two vertices that go down at different speeds", {{{0, 0}, {-3, 0}, {0, -1}}}, 1.0 / 3,
             "(1 - 3 t)(1 - t): the triangle is valid again after the second root, but the first one counts");
    expect_t("a triangle that shrinks to a point and comes out turned by 180 degrees", {{{0, 0}, {-2, 0}, {0, -2}}},
             0.5, "(1 - 2 t)^2: at its end it is as it was, but on the way it has no area");
    for (const double small : {1e-6, 1e-9, 1e-12})
        expect_t("an area that is almost linear in t", {{{0, 0}, {small, 0}, {0, -2}}}, 0.5,
                 "(1 + small t)(1 - 2 t): -b + root loses its digits where 4 a c is small; the product of the roots is "
                 "c / a");
    for (int k = 0; k < 12; ++k) {
        const double sign_p = k % 2 ? -1 : 1, sign_q = k / 2 % 2 ? -1 : 1;
        const double p = sign_p * random.scale(0.01, 100), q = sign_q * std::abs(p) * random.scale(1.3, 50);
        const double expected = p > 0 ? p : q > 0 ? q : INFINITY;
        const Vec<2> all = {random.integer(-4, 4) / 4.0, random.integer(-4, 4) / 4.0};
        expect_t(concat("an area (1 - t / p)(1 - t / q), p = ", in_short(p), ", q = ", in_short(q)),
                 {{all, {all[0] - 1 / p, all[1]}, {all[0], all[1] - 1 / q}}}, expected,
                 "the smallest positive root, where there is one", 1e-8);
    }
    for (int k = 0; k < 6; ++k) {
        const double a = random.integer(-8, 8) / 4.0, c = random.integer(1, 8) / 16.0;
        expect_t("a triangle that turns and changes its size", {{{0, 0}, {-a, c}, {-c, -a}}}, INFINITY,
                 "(1 - a t)^2 + (c t)^2 has no root");
    }
}

EXERCISE("4.3", "the positive semidefinite part of a matrix") {
    Random& random = random_inputs();
    const Mat<2> flipped = positive_part({{{2, 0}, {0, -1}}});
    expect_close("entry 2 2 of the part of diag(2, -1)", flipped[1][1], 0, 1e-14,
                 flipped[1][1] == 1          ? "set negative eigenvalues to 0, not to their absolute value"
                 : std::isnan(flipped[1][1]) ? "off the diagonal are zeros: an eigenvector's formula divides 0 by 0"
                                             : "its eigenvalue -1 is left out");
    for (const double equal : {0.0, -1.0, random.uniform(0.5, 3)}) {
        const Mat<2> part = positive_part({{{equal, 0}, {0, equal}}});
        const double expected = std::max(equal, 0.0);
        expect(part == Mat<2>{{{expected, 0}, {0, expected}}}, "the part of ", equal, " times the identity is ",
               shown<2>(part), ", expected ", expected, " times it: both eigenvalues are ", equal,
               ", and any two directions are eigenvectors");
    }
    for (int k = 0; k < 30; ++k) {
        const double size = k < 12 ? 1 : random.scale(1e-8, 1e8);
        Vec<2> eigenvalue = {size * random.uniform(-3, 3), size * random.uniform(-3, 3)};
        if (k % 6 == 5) eigenvalue[1] = k % 4 == 1 ? eigenvalue[0] : 0;
        const double angle = k % 4 == 3 ? 0 : random.uniform(-3, 3), c = std::cos(angle), s = std::sin(angle);
        const auto with = [&](const Vec<2>& l) {
            const double mixed = (l[0] - l[1]) * c * s;
            return Mat<2>{{{l[0] * c * c + l[1] * s * s, mixed}, {mixed, l[0] * s * s + l[1] * c * c}}};
        };
        const Mat<2> A = with(eigenvalue), part = positive_part(A),
                     expected = with({std::max(eigenvalue[0], 0.0), std::max(eigenvalue[1], 0.0)});
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                expect(std::abs(part[i][j] - expected[i][j]) <= 1e-12 * size, "entry ", i + 1, " ", j + 1,
                       " of the part of ", shown<2>(A), ", which has the eigenvalues ", listed(eigenvalue), ", is ",
                       part[i][j], ", expected ", expected[i][j],
                       ": sum of max(eigenvalue, 0) v v' over eigenvectors v");
    }
}

// One system; `which`: what is fixed.
void check_fixed(const std::string& which, BlockCsr H, Vector g, const std::vector<char>& fixed) {
    std::vector<int> all, free;
    for (int i = 0; i < 2 * H.n; ++i) {
        all.push_back(i);
        if (!fixed[i / 2]) free.push_back(i);
    }
    Vector expected, of_free, d;
    for (const int i : free) of_free.push_back(-g[i]);
    solve_dense(dense_part(H, free), of_free, expected);

    const BlockCsr before = H;
    fix_nodes(H, g, fixed);
    expect(H.row == before.row && H.col == before.col && H.value.size() == before.value.size(),
           "the pattern of H has changed");
    const Vector A = dense_part(H, all);
    const int n = static_cast<int>(all.size());
    double asymmetry = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) asymmetry = std::max(asymmetry, std::abs(A[i * n + j] - A[j * n + i]));
    expect(asymmetry < 1e-12 * norm_inf(before), "with ", which, " H has become unsymmetric, by ", asymmetry,
           ": set columns of fixed nodes to 0, not only rows");
    for (double& entry : g) entry = -entry;
    expect(solve_dense(A, g, d, 1e-13), "with ", which, " H is singular: are the nodes fixed, and what is in their own "
           "2 x 2 block? (four ones are singular too)");
    double size = 0;
    for (const double entry : expected) size = std::max(size, std::abs(entry));
    for (int i = 0; i < n; ++i)
        expect(!fixed[i / 2] || d[i] == 0, "with ", which, " d at node ", i / 2, ", which is fixed, is ", d[i],
               ", expected 0", g[i] != 0 ? ": its entry of g is not 0" : "");
    for (std::size_t i = 0; i < free.size(); ++i)
        expect(std::abs(d[free[i]] - expected[i]) <= 1e-8 * size, "with ", which, " d at node ", free[i] / 2,
               ", which is free, is ", d[free[i]], ", expected ", expected[i],
               ": rows and columns of the other nodes must stay as they are");
}

// Symmetric and positive definite, of this size.
BlockCsr random_system(const Numbered& mesh, double size) {
    BlockCsr H = matrix_of(mesh);
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            const int j = H.col[k];
            if (j > i) continue;
            for (int ab = 0; ab < 4; ++ab) H.block(k)[ab] = size * random_inputs().uniform(-1, 1);
            double* const mirrored = H.block(H.find(j, i));
            if (j < i)
                for (int ab = 0; ab < 4; ++ab) mirrored[ab / 2 + 2 * (ab % 2)] = H.block(k)[ab];
            if (j == i) mirrored[1] = mirrored[2];
        }
    for (int i = 0; i < H.n; ++i)
        for (const int diagonal : {0, 3}) H.block(H.find(i, i))[diagonal] += 2.5 * size * (H.row[i + 1] - H.row[i]);
    return H;
}

EXERCISE("4.4", "fixing the boundary") {
    Random& random = random_inputs();
    const Mesh mesh = unit_square(0);
    const Vector x = swirled(mesh, 40, false);
    PlainEnergy energy(mesh, mesh.x, {.objective = Objective::squared});
    BlockCsr H = energy.hessian_pattern();
    energy.add_hessian(x, HessianKind::full, H);
    Vector g(x.size(), 0.0);
    energy.add_gradient(x, g);
    std::vector<char> boundary(mesh.nodes(), 0);
    for (const int i : mesh.faces) boundary[i] = 1;
    check_fixed("the boundary of a square fixed,", H, g, boundary);
    for (int k = 0; k < 8; ++k) {
        const Numbered any = random_mesh(random.integer(2, 5), random.integer(2, 5), 1);
        const double size = k < 4 ? 1 : random.scale(1e-6, 1e6);
        Vector any_g(2 * any.nodes);
        for (double& entry : any_g) entry = size * random.uniform(-1, 1);
        std::vector<char> fixed(any.nodes, k == 1);
        for (char& node : fixed)
            if (k > 1) node = random.integer(0, 2) == 0;
        check_fixed(concat(k == 0 ? "no" : k == 1 ? "every" : "any", " node of ", any.nodes, " fixed"),
                    random_system(any, size), any_g, fixed);
    }
}

// What an answer does with a function of one variable: the functions that it is given keep count. After too many calls
// the slope is 0, which ends it.
double minimum(const std::string& what, const std::function<double(double)>& f, const std::function<double(double)>& f1,
               const std::function<double(double)>& f2, double from) {
    Shared<long> of_derivatives, of_f, not_finite;
    const auto counted_f = [&](double x) { return ++of_f < 10000 ? f(x) : -INFINITY; };
    const auto derivative = [&](const std::function<double(double)>& function) {
        return [&](double x) {
            not_finite += !std::isfinite(f(x));
            return ++of_derivatives < 1000 && of_f < 10000 ? function(x) : 0;
        };
    };
    const double x = minimise(counted_f, derivative(f1), derivative(f2), from);
    expect(not_finite == 0, what, " from ", in_short(from), ": a derivative is called where f is infinite or nan: no ",
           "step may end there; every comparison with nan is false, so write !(f(x + t d) <= ...)");
    expect(of_derivatives < 1000 && of_f < 10000, what, " from ", in_short(from), ": no minimum after ", 0 + of_f,
           " calls of f and ", 0 + of_derivatives,
           " of derivatives: is -f' / |f''| your direction, or any decrease enough, where Armijo asks for more?");
    expect(std::abs(f1(x)) <= 1e-7, what, " from ", in_short(from), " ends at x = ", x, " with f' = ", f1(x),
           ", expected |f'| <= 1e-7");
    return x;
}

// One step from x: only the trial of length 1 / 2^halvings satisfies Armijo's condition, those before it do not, be it
// by a little; the slope where the step ends is 0.
void check_step(int halvings, double curvature) {
    Random& random = random_inputs();
    const bool near = halvings < 8;  // where sums keep their digits
    const double x = near ? random.uniform(-5, 5) : 0, at_x = near ? random.uniform(-1, 1) : 0;
    const double slope = random.scale(0.1, 10) * (random.integer(0, 1) ? 1 : -1);
    const double d = -slope / (curvature == 0 ? 1 : std::abs(curvature));
    const int nan_at = random.integer(0, 6), infinite_at = random.integer(0, 6);
    const auto f = [=, calls = 0](double y) mutable {
        if (++calls > 1000) return -static_cast<double>(INFINITY);  // the search has to end
        if (y == x) return at_x;
        const double t = (y - x) / d;
        const int k = t > 0 ? static_cast<int>(std::lround(-std::log2(t))) : -1;
        if (k < 0 || std::abs(std::ldexp(t, k) - 1) > 1e-3) return at_x + 1.0;  // no trial of this search
        if (k < halvings && k == nan_at) return static_cast<double>(NAN);
        if (k < halvings && k == infinite_at) return static_cast<double>(INFINITY);
        return at_x + (k < halvings ? 0.9e-4 : k == halvings ? 1.1e-4 : 0.9) * t * slope * d;
    };
    const double found = minimise(f, [=](double y) { return y == x ? slope : 0; },
                                  [=](double y) { return y == x ? curvature : 1; }, x);
    expect(std::abs(found - x - std::ldexp(d, -halvings)) <= 1e-3 * std::ldexp(std::abs(d), -halvings) + 1e-15,
           "from x = ", in_short(x), " with f' = ", in_short(slope), ", f'' = ", in_short(curvature), " the step is ",
           found - x, ", expected ", std::ldexp(d, -halvings), ", which is ", in_short(d), " times 1 / 2^", halvings,
           ": -f' / |f''| (-f' where f'' is 0) times the first of 1, 1/2, 1/4, ... that satisfies Armijo's condition "
           "with c1 = 1e-4");
}

EXERCISE("4.5", "Newton's method in one variable") {
    Random& random = random_inputs();
    // Barrier at 0, concave beyond e s: the full step from 20 s leads away, or beyond the barrier.
    for (const double ratio : {0.05, 0.9, 2.0, 20.0, 1000.0}) {
        const double s = ratio == 2 ? 1 : random.scale(0.1, 10);
        const auto log_of = [=](double x) { return std::log(x / s); };
        const auto f = [=](double x) { return x > 0 ? log_of(x) * log_of(x) : ratio == 2 ? NAN : INFINITY; };
        const auto f1 = [=](double x) { return 2 * log_of(x) / x; };
        const auto f2 = [=](double x) { return 2 * (1 - log_of(x)) / (x * x); };
        const std::string what = concat("log(x / ", in_short(s), ")^2", ratio == 2 ? ", nan for x < 0," : "");
        expect_close(concat("the minimum of ", what, " from ", in_short(ratio * s), ", by ", in_short(s), ","),
                     minimum(what, f, f1, f2, ratio * s) / s, 1, 1e-5);
    }
    // Newton's step goes from x to -0.99992 x: lower, but by less than Armijo asks for.
    const double p = 1.50002;
    const auto power = [p](double x) { return std::pow(std::abs(x), p); };
    const auto power1 = [p](double x) { return p * std::copysign(std::pow(std::abs(x), p - 1), x); };
    const auto power2 = [p](double x) { return p * (p - 1) * std::pow(std::abs(x), p - 2); };
    expect_close("the minimum of |x|^1.50002 from 1", minimum("|x|^1.50002", power, power1, power2, 1), 0, 1e-6);
    const double well = random.scale(0.3, 3);  // at +- this
    const auto wells = [=](double x) { return x * x * (x * x - 2 * well * well); };
    const auto wells1 = [=](double x) { return 4 * x * (x * x - well * well); };
    const auto wells2 = [=](double x) { return 12 * x * x - 4 * well * well; };
    const std::string of_wells = concat("x^4 - 2 (", in_short(well), " x)^2");
    for (const double side : {-0.1, 0.1})
        expect_close(concat("the minimum of ", of_wells, " from ", in_short(side * well), ", by ", in_short(well), ","),
                     minimum(of_wells, wells, wells1, wells2, side * well) / well, side < 0 ? -1 : 1, 1e-5,
                     "at 0 is a maximum: Newton's method goes there where f'' < 0 is not replaced");
    const double of_sine = minimum("sin x", [](double x) { return std::sin(x); }, [](double x) { return std::cos(x); },
                                   [](double x) { return -std::sin(x); }, 0);
    expect_close("sin at its minimum, from 0, where f'' = 0,", std::sin(of_sine), -1, 1e-12);
    for (int k = 0; k < 24; ++k)
        check_step(k < 3 ? 0 : k < 20 ? random.integer(1, 7) : random.integer(20, 40),
                   k % 3 == 0 ? random.scale(0.1, 10) : k % 3 == 1 ? -random.scale(0.1, 10) : 0);
    // Of fourth order at its minimum: each full step leaves 2/3, and where it ends tells whose steps they were.
    for (int k = 0; k < 3; ++k) {
        const double a = random.uniform(-3, 3), from = a + random.uniform(1, 3);
        double e = from - a;
        while (4 * e * e * e > 1e-7) e *= 2.0 / 3;
        const double x = minimum("(x - a)^4", [=](double y) { return std::pow(y - a, 4); },
                                 [=](double y) { return 4 * std::pow(y - a, 3); },
                                 [=](double y) { return 12 * std::pow(y - a, 2); }, from);
        expect_close(concat("x - a at the end for (x - a)^4 from a + ", in_short(from - a)), x - a, e, 1e-9,
                     "full steps of Newton's method leave 2/3 of x - a each, and |f'| <= 1e-7 is the end");
    }
}

double along(const Mat<2>& A, const Mat<2>& B) {
    return A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[1][0] * B[1][0] + A[1][1] * B[1][1];
}

// One F = U diag(s1, s2) V', one density f.
void check_curvatures(double s1, double s2, const char* density, double f1, double f2) {
    const Mat<2> U = random_rotation<2>(), V = random_rotation<2>();
    const auto turned = [&](const Mat<2>& A) { return multiply<2>(multiply<2>(U, A), transpose<2>(V)); };
    const Mat<2> F = turned({{{s1, 0}, {0, s2}}});
    const double eta = distortion<2>(F, 0), r = std::sqrt(0.5);
    // H : W_FF K by lesson 2, from those of eta^2.
    const auto second = [&](const Mat<2>& H, const Mat<2>& K) {
        const double eta_H = along(W_F(F), H) / (2 * eta), eta_K = along(W_F(F), K) / (2 * eta);
        return f2 * eta_H * eta_K + f1 * (along(H, W_FF(F, K)) - 2 * eta_H * eta_K) / (2 * eta);
    };
    const std::string of = concat(" where the singular values of ", shown<2>(F), " are ", in_short(s1), " and ",
                                  in_short(s2), ", density ", density, ",");
    const Mat<2> twist = turned({{{0, -r}, {r, 0}}}), flip = turned({{{0, r}, {r, 0}}});
    const Mat<2> first = turned({{{1, 0}, {0, 0}}}), other = turned({{{0, 0}, {0, 1}}});
    const double trace = second(first, first) + second(other, other);
    const double size = trace + second(flip, flip) + (f1 + f2) / (s1 * s2);
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
    Random& random = random_inputs();
    std::vector<Vec<2>> all = {{2, 0.5}, {3, 2.9}, {1, 0.01}, {1, 1}, {0.2, 0.2}, {1, 0.9999999}};
    for (int k = 0; k < 6; ++k) {
        const double s1 = random.scale(1e-3, 1e3);
        all.push_back({s1, s1 * random.scale(0.02, 1)});
    }
    for (const auto& [s1, s2] : all) {
        const double eta = (s1 / s2 + s2 / s1) / 2;
        check_curvatures(s1, s2, "eta", 1, 0);
        check_curvatures(s1, s2, "eta^2", 2 * eta, 2);
        check_curvatures(s1, s2, "(eta - 1)^2", 2 * (eta - 1), 2);
        check_curvatures(s1, s2, "exp(eta / 2) / 50", std::exp(eta / 2) / 100, std::exp(eta / 2) / 200);
    }
}

}  // namespace
}  // namespace almesh::lessons
