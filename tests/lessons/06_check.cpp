#include "lessons/exercises/06.hpp"

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(penalised_place, penalty_for, without_penalty_error, condition_with_penalty, penalised_minimum);

EXERCISE("6.1", "a spring and a penalty") {
    for (const double kappa : {1.0, 7.0})
        for (const double mu : {0.5, 100.0}) {
            const double g = 3, x = penalised_place(kappa, g, mu), force = kappa * x + mu * (x - g);
            expect(std::abs(force) < 1e-9, "with kappa = ", kappa, ", g = 3, mu = ", mu, " x is ", x,
                   ", where the derivative is ", force, ", not 0", x == g ? ": a penalty never gets there" : "");
        }
}

EXERCISE("6.2", "how large a penalty") {
    for (const double tolerance : {0.1, 1e-3, 1e-6}) {
        const double kappa = 4, g = -2, mu = penalty_for(kappa, g, tolerance),
                     error = kappa * std::abs(g) / (kappa + mu);
        expect(mu >= 0, "mu is ", mu, ", less than 0, for g = -2: what counts is the distance, and g is negative here");
        expect(error <= 1.0001 * tolerance, "with mu = ", mu, " x is off by ", error, ", which is more than ",
               tolerance);
        expect(error >= 0.9999 * tolerance, "mu = ", mu, " is larger than it need be: x is off by ", error, ", and ",
               tolerance, " is allowed");
    }
    expect(penalty_for(1, 0.5, 1) == 0, "where x = 0 is near enough the penalty is ", penalty_for(1, 0.5, 1),
           ", expected 0");
}

EXERCISE("6.3", "the limit from two penalties") {
    const auto q = [](double mu) { return 12 - 5 / mu; };
    expect_close("the limit of 12 - 5/mu from mu = 2 and 6", without_penalty_error(2, q(2), 6, q(6)), 12, 1e-9,
                 "two equations q = q_infinity + a / mu, two unknowns");
    // The distance of the spring of 6.1 from its wall falls like 1/mu, its extrapolated one like 1/mu^2.
    const double order = order_of(
        [](double h) {
            const double mu = 1 / h, kappa = 1;
            return std::abs(without_penalty_error(mu, mu / (kappa + mu), 2 * mu, 2 * mu / (kappa + 2 * mu)) - 1);
        },
        0.02, 6);
    expect(std::abs(order - 2) < 0.1, "the error of the spring's place falls with order ", order,
           " in 1/mu, expected 2: the part a / mu has to cancel");
}

EXERCISE("6.4", "the condition number") {
    const Mat<2> K = {{{3, 1}, {1, 2}}};
    const double root = std::sqrt(5.0);
    expect_close("without a penalty that of (3 1; 1 2)", condition_with_penalty(K, {1, 0}, 0), (5 + root) / (5 - root),
                 1e-9, "the eigenvalues are (5 + sqrt 5)/2 and (5 - sqrt 5)/2");
    // For large mu: mu |a|^2 over b' K b, b across a and of length one.
    for (const double mu : {1e7, 1e11, 1e15})
        expect_close(concat("with mu = ", mu, ", a = (1.1, 2.3), divided by mu, "),
                     condition_with_penalty(K, {1.1, 2.3}, mu) / mu, 6.5 * 6.5 / 13.23, 1e-5,
                     "the smallest eigenvalue is lost in differences of large numbers; it is det / largest, and "
                     "det(K + mu a a') = det K + mu a' adj(K) a");
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

// From x, with at most eight steps, to forces in balance.
void check_penalised(const char* name, Constrained problem, const Vec<2>& x) {
    for (const double mu : {1.0, 100.0, 1e4, 1e8, 1e12, 1e18}) {
        const std::string of = concat(name, ", mu = ", mu);
        Shared<int> steps;
        Constrained counted = problem;
        counted.f2 = [&](const Vec<2>& at) {
            expect(++steps <= 8, of, ": more than 8 Newton steps. The force has to be an unknown of its own, not ",
                   "mu c(x), and in the matrix it multiplies the second derivative of c");
            return problem.f2(at);
        };
        const auto [end, force] = penalised_minimum(counted, mu, x);
        const Vec<2> f1 = problem.f1(end), c1 = problem.c1(end);
        const double unbalanced = std::hypot(f1[0] + force * c1[0], f1[1] + force * c1[1]), c = problem.c(end);
        expect(std::abs(c - force / mu) < 1e-9, of, ": c is ", c, " and force / mu ", force / mu,
               ", expected the same");
        expect(unbalanced < 1e-9, of, ": f' + force c' has the length ", unbalanced, " where you stop",
               std::abs(force - mu * c) < 1e-9 * std::abs(force)
                   ? "; mu c(x) is lost in the rounding of x: the force has to come from the unknown y"
                   : ", expected 0");
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
