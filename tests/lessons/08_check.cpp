#include "lessons/exercises/08.hpp"

#include "lessons/exercise.hpp"
#include "method/schedule.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(contraction, updates_as_printed, goes_on, next, inexact_multipliers);

// By doing it: x is the minimum for lambda, the error of lambda is its distance from kappa g.
double measured(double kappa, double weight, double step) {
    const double g = 2, lambda = 0.3, x = (lambda + weight * g) / (kappa + weight);
    return (lambda - step * (x - g) - kappa * g) / (lambda - kappa * g);
}

EXERCISE("8.1", "the factor of an update") {
    for (const double kappa : {0.5, 10.0, -2.0})
        for (const double weight : {4.0, 100.0})
            for (const double step : {2.0, 4.0, 100.0})
                expect_close(concat("the factor for kappa = ", kappa, ", weight ", weight, ", step ", step),
                             contraction(kappa, weight, step), measured(kappa, weight, step), 1e-9,
                             step == weight ? "of lesson 7: kappa / (kappa + mu)"
                                            : "c at the minimum is (lambda - kappa g) / (kappa + weight)");
}

EXERCISE("8.2", "how many updates as printed") {
    for (const double mu : {2.0, 20.0, 100.0, 0.6}) {
        int expected = 0;
        for (double error = 1; std::abs(error) > 0.01; error *= measured(1e-13, mu * mu, mu)) ++expected;
        const int found = updates_as_printed(mu, 100);
        expect(std::abs(found - expected) <= (expected > 100 ? 1 : 0), "with mu = ", mu, " there are ", found,
               " updates for a hundredth of the error, expected ", expected, ": every one leaves |1 - 1/mu| of it");
    }
    expect(updates_as_printed(0.4, 10) == -1, "with mu = 0.4 there are ", updates_as_printed(0.4, 10),
           " updates, expected -1: the update goes too far, |1 - 1/mu| = 1.5");
    expect(updates_as_printed(1, 10) == 1, "mu = 1 is consistent, mu^2 = mu: one update is enough");
}

EXERCISE("8.3", "when to stop") {
    expect(goes_on(1e-4, 1e-9, 1e-14, 1e-6), "the loop ends with |c|^2 = 1e-4 because |grad E| is small: as printed");
    expect(goes_on(1e-16, 1e-2, 1e-14, 1e-6), "the loop ends with |grad E| = 1e-2 because |c| is small: as printed");
    expect(goes_on(1e-4, 1e-2, 1e-14, 1e-6), "the loop ends although neither test holds");
    expect(!goes_on(1e-16, 1e-9, 1e-14, 1e-6), "the loop goes on although both tests hold");
}

EXERCISE("8.4", "penalty and tolerances") {
    AugmentedLagrangianParams params;
    params.algorithm = Algorithm::paper;
    params.mu0 = 30, params.omega0 = 0.2, params.epsilon0 = 1e-3;
    Schedule library(params, 0, 1, 1);
    Settings s = {10, params.mu0, params.omega0, params.epsilon0};
    int k = 1;
    for (const double c_squared : {1.0, 1e-2, 1e-9, 1e-14, 1e-1, 1e-11}) {
        const bool updates = c_squared <= library.epsilon;
        if (updates) library.tighten(c_squared, 0);
        else library.raise_penalty();
        s = next(s, c_squared, params.mu0, params.omega0, params.epsilon0);
        const std::string where = concat(" after subproblem ", k++, " with |c|^2 = ", c_squared);
        expect(s.updates_lambda == updates, "lambda is ", updates ? "not " : "", "updated", where,
               ": line 9 asks whether |c|^2 <= epsilon");
        expect_close("mu" + where, s.mu / library.mu, 1, 1e-9, "ratio to what it should be; it grows with m, line 18");
        expect_close("epsilon" + where, s.epsilon / library.epsilon, 1, 1e-9,
                     "ratio to what it should be: divided by m^0.9 after an update, else by (m/m0)^0.1 from epsilon0");
        expect_close("omega" + where, s.omega / library.omega, 1, 1e-9,
                     "ratio to what it should be: divided by m after an update, else omega0 by m/m0");
    }
}

EXERCISE("8.5", "loose tolerances first") {
    expect_only("loose", {"mesh = ../../../meshes/circle.msh", "boundary inner = translate 12 0",
                          "boundary outer = fixed", "objective = squared", "algorithm = paper", "length_scale = 1",
                          "mu0 = 24", "omega_star = 1e-6", "epsilon_star = 1e-14"}, {"omega0", "epsilon0"});
    const auto summary = run_deck("loose");
    expect(summary.at("status") == "converged", "the run ends as ", summary.at("status"));
    expect(number(summary, "newton_iterations") <= 14, "it takes ", number(summary, "newton_iterations"),
           " Newton steps in ", number(summary, "al_iterations"), " iterations: exact minima for multipliers that are ",
           "wrong anyway are work for nothing, and so are updates with a soft penalty");
}

// A chain of springs: E = 1/2 x' K x - b' x with K = tridiag(-1, 2 + ground, -1), c = a' x - 3.
struct Chain {
    double mu, ground;
    std::vector<double> a, b;

    int size() const { return static_cast<int>(a.size()); }
    double step() const {  // below 2 / (largest eigenvalue of K + mu a a')
        double aa = 0;
        for (const double a_i : a) aa += a_i * a_i;
        return 1 / (4 + ground + mu * aa);
    }
    double constraint(const std::vector<double>& x) const {
        double c = -3;
        for (int i = 0; i < size(); ++i) c += a[i] * x[i];
        return c;
    }
    // K x - b - factor a; factor = lambda - mu c: the gradient.
    std::vector<double> residual(const std::vector<double>& x, double factor) const {
        std::vector<double> r(a.size());
        for (int i = 0; i < size(); ++i)
            r[i] = (2 + ground) * x[i] - (i > 0 ? x[i - 1] : 0) - (i + 1 < size() ? x[i + 1] : 0) - b[i] - factor * a[i];
        return r;
    }
};

double norm(const std::vector<double>& v) {
    double squared = 0;
    for (const double v_i : v) squared += v_i * v_i;
    return std::sqrt(squared);
}

void expect_solved_with_at_most(int most, const Chain& chain) {
    Shared<int> count;
    const auto gradient = [&](const std::vector<double>& x, double lambda) {
        expect(x.size() == chain.a.size(), "gradient was asked for ", x.size(), " unknowns of ", chain.a.size());
        expect(++count < 20 * most, "after ", count, " gradients there is no end. |c| = ", chain.constraint(x),
               ", lambda = ", lambda, ": lambda - mu c is the update, and tolerances have to go down to 1e-9");
        return chain.residual(x, lambda - chain.mu * chain.constraint(x));
    };
    const ConstrainedMinimum found =
        inexact_multipliers({chain.size(), chain.mu, chain.step(), gradient,
                             [&](const std::vector<double>& x) { return chain.constraint(x); }});
    const std::string where = concat(chain.size(), " springs, mu = ", chain.mu, ": ");
    expect(found.x.size() == chain.a.size(), where, "x has ", found.x.size(), " entries");
    const double c = std::abs(chain.constraint(found.x)), r = norm(chain.residual(found.x, found.lambda));
    expect(c <= 1e-9, where, "at the end |c| is ", c, ", expected at most 1e-9");
    expect(r <= 1e-8 * (1 + chain.mu), where, "at the end |grad E - lambda grad c| is ", r,
           ": |c| is small, and this has to be too; line 7");
    expect(count <= most, where, count, " gradients, ", most, " should do: while lambda is wrong by much, an exact ",
           "minimum for it is worth nothing. |grad| need not be smaller than what the next update puts there, mu |c|");
}

EXERCISE("8.6", "an hour: inexact subproblems") {
    std::vector<double> end(10), mean(16, 0.25), b(16);
    end[9] = 1;
    for (int i = 0; i < 16; ++i) b[i] = std::sin(i);
    const std::vector<double> b_10(b.begin(), b.begin() + 10);
    expect_solved_with_at_most(1500, {1, 0.1, end, b_10});
    expect_solved_with_at_most(1300, {4, 0.1, end, b_10});
    expect_solved_with_at_most(600, {2, 0.2, mean, b});
}

}  // namespace
}  // namespace almesh::lessons
