#include "lessons/exercises/06.hpp"

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(penalised_place, penalty_for, without_penalty_error, condition_with_penalty, penalised_minimum);

EXERCISE("6.1", "springs and a penalty") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const double unit = random.scale(1e-4, 1e4), k_1 = unit * random.scale(0.1, 10),
                     k_2 = unit * random.scale(0.1, 10);
        const double moderate = random.scale(0.05, 100), any = random.scale(1e-4, 1e6);
        const double mu = k % 6 == 5 ? 0 : unit * (k % 2 ? moderate : any), g = k == 7 ? 0 : random.uniform(-5, 5);
        const double x = penalised_place(k_1, k_2, g, mu), y = k_2 * x / (k_1 + k_2), pull = k_2 * (x - y);
        const std::string where = concat("with k_1 = ", k_1, ", k_2 = ", k_2, ", g = ", g, ", mu = ", mu, " x is ", x);
        expect(std::abs(pull + mu * (x - g)) <= 1e-9 * (unit + mu) * std::abs(g), where, ": y is then at rest at ", y,
               ", the second spring pulls x back with ", pull, " and the penalty to g with ", mu * (g - x),
               ", which should be the same", x == g ? ": a penalty never gets there" : "");
    }
}

EXERCISE("6.2", "how large a penalty") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const double kappa = random.scale(1e-3, 1e3), g = random.scale(1e-3, 1e3) * (k % 2 ? 1 : -1);
        const double part = k % 3 ? random.scale(1e-8, 0.9) : random.uniform(0.9, 0.999);
        const double tolerance = std::abs(g) * part, mu = penalty_for(kappa, g, tolerance);
        const double error = kappa * std::abs(g) / (kappa + mu);
        const std::string where = concat("with kappa = ", kappa, ", g = ", g, ", mu = ", mu, " x is off by ", error);
        expect(mu >= 0, "mu is ", mu, ", less than 0, for g = ", g, ", tolerance ", tolerance,
               ": what counts is the distance", g < 0 ? ", and g is negative here" : "");
        expect(error <= tolerance * (1 + 1e-9), where, ", which is more than ", tolerance);
        expect(error >= tolerance * (1 - 1e-9), where, ", and ", tolerance,
               " is allowed: mu is larger than it need be");
        const double loose = std::abs(g) * random.scale(1, 100), none = penalty_for(kappa, g, loose);
        expect(none == 0, "where x = 0 is near enough the penalty is ", none, ", expected 0: kappa = ", kappa,
               ", g = ", g, ", tolerance ", loose);
    }
    const double at_rest = penalty_for(2, 0, random_inputs().scale(1e-6, 1));
    expect(at_rest == 0, "where g = 0, and x = 0 without a penalty, the penalty is ", at_rest, ", expected 0");
}

EXERCISE("6.3", "the limit from two penalties") {
    for (int k = 0; k < 20; ++k) {
        Random& random = random_inputs();
        const double limit = random.uniform(-20, 20), a = random.uniform(-10, 10), mu_1 = random.scale(0.1, 1e4),
                     mu_2 = mu_1 * (k % 2 ? random.scale(1.5, 30) : 1 / random.scale(1.5, 30)), q_1 = limit + a / mu_1,
                     q_2 = limit + a / mu_2;
        const double found = without_penalty_error(mu_1, q_1, mu_2, q_2);
        expect(std::abs(found - limit) <= 1e-9 * (1 + std::abs(q_1) + std::abs(q_2)), "the limit of ", limit,
               a < 0 ? " - " : " + ", std::abs(a), "/mu from mu = ", mu_1, " and ", mu_2, " is ", found, ", expected ",
               limit, ": two equations q = q_infinity + a / mu, two unknowns");
    }
    // The distance of a spring from its wall falls like 1/mu, its extrapolated one like 1/mu^2.
    const double ratio = random_inputs().uniform(1.5, 4), order = order_of(
        [&](double h) {
            const double mu = 1 / h, kappa = 1;
            return std::abs(
                without_penalty_error(mu, mu / (kappa + mu), ratio * mu, ratio * mu / (kappa + ratio * mu)) - 1);
        },
        0.02, 6);
    expect(std::abs(order - 2) < 0.1, "the error of the place of a spring falls with order ", order,
           " in 1/mu, expected 2: the part a / mu has to cancel");
}

// In the basis a / |a| and across it the penalty is in one entry alone, so that the determinant is a difference of
// numbers that are not near each other.
double measured_condition(const Mat<2>& K, const Vec<2>& a, double mu) {
    const double squared = a[0] * a[0] + a[1] * a[1], length = std::sqrt(squared);
    const double c = length > 0 ? a[0] / length : 1, s = length > 0 ? a[1] / length : 0;
    const double along = c * c * K[0][0] + 2 * c * s * K[0][1] + s * s * K[1][1] + mu * squared,
                 across = s * s * K[0][0] - 2 * c * s * K[0][1] + c * c * K[1][1],
                 mixed = c * s * (K[1][1] - K[0][0]) + (c * c - s * s) * K[0][1];
    const double large = (along + across + std::hypot(along - across, 2 * mixed)) / 2;
    return large * large / (along * across - mixed * mixed);
}

EXERCISE("6.4", "the condition number") {
    const Mat<2> shown = {{{3, 1}, {1, 2}}};
    const double root = std::sqrt(5.0);
    expect_close("without a penalty the condition number of (3 1; 1 2)", condition_with_penalty(shown, {1, 0}, 0),
                 (5 + root) / (5 - root), 1e-9, "the eigenvalues are (5 + sqrt 5)/2 and (5 - sqrt 5)/2");
    for (int k = 0; k < 40; ++k) {
        Random& random = random_inputs();
        const double turn = random.uniform(0, 3.14), c = std::cos(turn), s = std::sin(turn),
                     unit = random.scale(1e-3, 1e3), l = unit * random.scale(0.1, 10), m = unit * random.scale(0.1, 10),
                     size = random.scale(0.1, 10), phi = k % 8 == 7 ? 0 : random.uniform(0, 6.28);
        const Mat<2> K = {{{c * c * l + s * s * m, c * s * (l - m)}, {c * s * (l - m), s * s * l + c * c * m}}};
        const Vec<2> a = k == 39 ? Vec<2>{} : Vec<2>{size * std::cos(phi), size * std::sin(phi)};
        const double mu = k % 5 == 0 ? 0 : k % 5 == 1 ? unit * random.scale(0.1, 10) : unit * random.scale(1, 1e15);
        const double found = condition_with_penalty(K, a, mu), expected = measured_condition(K, a, mu);
        expect(std::abs(found - expected) <= 1e-6 * expected, "the condition number with K = (", K[0][0], " ", K[0][1],
               "; ", K[1][0], " ", K[1][1], "), a = (", a[0], ", ", a[1], "), mu = ", mu, " is ", found, ", expected ",
               expected,
               mu > 1e6 * unit ? ": digits of the smallest eigenvalue are lost in differences of large numbers?"
               : mu > 0        ? ": K and the penalty both count"
                               : "");
    }
}

EXERCISE("6.5", "one penalty") {
    expect_only("once", {"mesh = ../../../meshes/circle.msh", "boundary inner = translate 8 0",
                         "boundary outer = fixed", "method = penalty", "objective = squared", "length_scale = 1",
                         "omega_star = 1e-6", "epsilon_star = 1e-8", "wall_tolerance = 1"}, {"mu0"});
    const double mu0 = parse_double(keys_of_deck("once")["mu0"]).value_or(NAN);
    expect(mu0 > 0, "once.deck has no mu0 above 0");
    const auto summary = run_deck("once");
    expect(number(summary, "al_iterations") == 1, "with mu0 = ", mu0, " it takes ", number(summary, "al_iterations"),
           " iterations: how large must mu be so that |c| is 1e-4? The lesson's table has mu |c|");
    expect(number(run_deck("once", {concat("mu0=", mu0 / 10)}), "al_iterations") > 1, "mu0 = ", mu0 / 10,
           " needs one iteration too: that is more stiffness than was asked for");
    const double exponent = std::log10(mu0);
    expect_close("log10 of mu0", exponent, std::round(exponent), 1e-9, "a power of ten is asked for");
}

// The same problem in coordinates that are turned and shifted, with f and c in other units.
struct Elsewhere {
    double c, s, force, unit;
    Vec<2> shift;

    Elsewhere() {
        Random& random = random_inputs();
        const double turn = random.uniform(0, 6.28);
        c = std::cos(turn), s = std::sin(turn), force = random.scale(0.5, 2), unit = random.scale(0.5, 2);
        shift = {random.uniform(-3, 3), random.uniform(-3, 3)};
    }
    Vec<2> turned(const Vec<2>& v) const { return {c * v[0] - s * v[1], s * v[0] + c * v[1]}; }
    Vec<2> to(const Vec<2>& x) const { return {turned(x)[0] + shift[0], turned(x)[1] + shift[1]}; }
    Vec<2> from(const Vec<2>& x) const {
        const double u = x[0] - shift[0], v = x[1] - shift[1];
        return {c * u + s * v, c * v - s * u};
    }
    Vec<2> gradient(const Vec<2>& g, double by) const { return turned({by * g[0], by * g[1]}); }
    Mat<2> hessian(const Mat<2>& H, double by) const {
        const Vec<2> columns[2] = {turned({H[0][0], H[1][0]}), turned({H[0][1], H[1][1]})};  // Q H, then (Q H) Q'
        const Vec<2> rows[2] = {turned({columns[0][0], columns[1][0]}), turned({columns[0][1], columns[1][1]})};
        return {{{by * rows[0][0], by * rows[0][1]}, {by * rows[1][0], by * rows[1][1]}}};
    }
    Constrained of(const Constrained& problem) const {
        return {[=, *this](const Vec<2>& x) { return gradient(problem.f1(from(x)), force); },
                [=, *this](const Vec<2>& x) { return hessian(problem.f2(from(x)), force); },
                [=, *this](const Vec<2>& x) { return unit * problem.c(from(x)); },
                [=, *this](const Vec<2>& x) { return gradient(problem.c1(from(x)), unit); },
                [=, *this](const Vec<2>& x) { return hessian(problem.c2(from(x)), unit); }};
    }
};

// From near x, with at most eight steps, to forces in balance.
void check_penalised(const char* name, const Constrained& here, const Vec<2>& x) {
    for (const double exponent : {0.0, random_inputs().uniform(0, 4), random_inputs().uniform(4, 12), 18.0}) {
        const Elsewhere elsewhere;
        const double mu = std::pow(10, exponent) * elsewhere.force / (elsewhere.unit * elsewhere.unit);
        const Vec<2> start =
            elsewhere.to({x[0] + random_inputs().uniform(-0.1, 0.1), x[1] + random_inputs().uniform(-0.1, 0.1)});
        const Constrained problem = elsewhere.of(here);
        const std::string of = concat(name, ", turned and shifted, mu = ", mu);
        Shared<int> steps;
        Constrained counted = problem;
        counted.f2 = [&](const Vec<2>& at) {
            expect(++steps <= 8, of, ": more than 8 Newton steps. The force has to be an unknown of its own, not ",
                   "mu c(x), and in the matrix it multiplies the second derivative of c");
            return problem.f2(at);
        };
        const auto [end, force] = penalised_minimum(counted, mu, start);
        const Vec<2> f1 = problem.f1(end), c1 = problem.c1(end);
        expect(steps >= 1, of, ": f2 is never called: Newton's method calls it once in each step");
        const double unbalanced = std::hypot(f1[0] + force * c1[0], f1[1] + force * c1[1]), c = problem.c(end);
        expect(std::abs(c - force / mu) < 1e-9, of, ": c is ", c, " and force / mu ", force / mu,
               ", expected the same");
        expect(unbalanced < 1e-9, of, ": f' + force c' has the length ", unbalanced, " where you stop",
               std::abs(force - mu * c) < 1e-9 * std::abs(force)
                   ? "; mu c(x) is lost in the rounding of x: the force has to come from the unknown y"
                   : ", expected 0");
        // Of (f'' + y c'', c'; c', -1/mu), whose eigenvalues are two positive ones and a negative one at a minimum.
        const Mat<2> f2 = problem.f2(end), c2 = problem.c2(end);
        Mat<2> A;
        for (int i = 0; i < 4; ++i) A[i / 2][i % 2] = f2[i / 2][i % 2] + force * c2[i / 2][i % 2];
        const double across = c1[1] * c1[1] * A[0][0] - c1[0] * c1[1] * (A[0][1] + A[1][0]) + c1[0] * c1[0] * A[1][1];
        expect(across + determinant(A) / mu > 0, of, ": where you stop is no minimum: is the first step one of "
               "Newton's, from the x that is given?");
    }
}

EXERCISE("6.6", "an hour: the force as an unknown") {
    using V = Vec<2>;
    using M = Mat<2>;
    const Constrained circle = {[](const V&) { return V{1, 1}; }, [](const V&) { return M{}; },
                                [](const V& x) { return x[0] * x[0] + x[1] * x[1] - 2; },
                                [](const V& x) { return V{2 * x[0], 2 * x[1]}; },
                                [](const V&) { return M{{{2, 0}, {0, 2}}}; }};
    check_penalised("x + y, circle of lesson 6", circle, {-1.5, -0.3});
    check_penalised("x + y, circle of lesson 6", circle, {-0.4, -1.8});
    const Constrained parabola = {[](const V& x) { return V{2 * x[0] - 4, 2 * x[1]}; },
                                  [](const V&) { return M{{{2, 0}, {0, 2}}}; },
                                  [](const V& x) { return x[1] - x[0] * x[0]; },
                                  [](const V& x) { return V{-2 * x[0], 1}; },
                                  [](const V&) { return M{{{-2, 0}, {0, 0}}}; }};
    check_penalised("(x - 2)^2 + y^2, parabola y = x^2", parabola, {2, 0});
    const Constrained hyperbola = {[](const V& x) { return V{std::exp(x[0]), 2 * x[1]}; },
                                   [](const V& x) { return M{{{std::exp(x[0]), 0}, {0, 2}}}; },
                                   [](const V& x) { return x[0] * x[1] - 3; },
                                   [](const V& x) { return V{x[1], x[0]}; },
                                   [](const V&) { return M{{{0, 1}, {1, 0}}}; }};
    check_penalised("exp x + y^2, hyperbola x y = 3", hyperbola, {2, 1});
}

}  // namespace
}  // namespace almesh::lessons
