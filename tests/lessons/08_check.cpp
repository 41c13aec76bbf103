#include "lessons/exercises/08.hpp"

#include <algorithm>
#include <cmath>

#include "lessons/exercise.hpp"
#include "method/schedule.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(best_step, updates_as_printed, goes_on, next, inexact_multipliers);

// By doing it: x is the minimum for lambda, the error of lambda is its distance from kappa g.
double measured(double kappa, double weight, double step) {
    const double g = 2, lambda = 0.3, x = (lambda + weight * g) / (kappa + weight);
    return (lambda - step * (x - g) - kappa * g) / (lambda - kappa * g);
}

EXERCISE("8.1", "the best step") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const double weight = random.scale(1e-3, 1e4), kappa_1 = k % 4 == 0 ? 0 : weight * random.uniform(-0.9, 3),
                     kappa_2 = kappa_1 + (k == 1 ? 0 : weight * random.scale(0.01, 100));
        const double step = best_step(kappa_1, kappa_2, weight), soft = measured(kappa_1, weight, step),
                     stiff = measured(kappa_2, weight, step);
        expect(std::abs(soft + stiff) < 1e-8, "for kappa = ", kappa_1, " to ", kappa_2, " and the weight ", weight,
               " you say ", step, ": the error of the softest mode is multiplied by ", soft,
               ", that of the stiffest by ", stiff, ". A ", soft + stiff > 0 ? "longer" : "shorter",
               " step leaves less of the one of which most is left");
    }
}

// Enough updates, by logarithms; 0 where rounding could decide.
int updates_needed(double mu, double q) {
    const double updates = std::log(q) / -std::log(std::abs(1 - 1 / mu));
    return std::abs(updates - std::round(updates)) < 1e-6 * updates ? 0 : static_cast<int>(std::ceil(updates));
}

EXERCISE("8.2", "how many updates as printed") {
    for (int k = 0; k < 24;) {
        const double mu = k == 0   ? 0.5 + random_inputs().scale(1e-4, 1e-3)  // thousands of updates
                          : k == 1 ? random_inputs().scale(2e3, 2e4)
                          : k < 6  ? random_inputs().uniform(0.51, 0.99)
                                   : 1 + random_inputs().scale(0.01, 200),
                     q = 1 + random_inputs().scale(0.1, 1e6);
        const int expected = updates_needed(mu, q);
        if (expected == 0) continue;
        ++k;
        const int found = updates_as_printed(mu, q);
        expect(found == expected, "with mu = ", mu, " there are ", found, " updates until 1/", q,
               " of the error is left, ", "expected ", expected,
               ": every one leaves |1 - 1/mu| of it, and a whole number is asked for");
    }
    for (const double mu : {0.4, 0.5, random_inputs().uniform(0.05, 0.5)}) {
        const int found = updates_as_printed(mu, 10);
        expect(found == -1, "with mu = ", mu, " there are ", found, " updates, expected -1: the update goes too far, ",
               "|1 - 1/mu| = ", std::abs(1 - 1 / mu));
    }
    for (const double q : {1.5, random_inputs().scale(2, 1e6)})
        expect(updates_as_printed(1, q) == 1, "mu = 1 is consistent, mu^2 = mu: one update is enough");
}

EXERCISE("8.3", "when to stop") {
    for (int k = 0; k < 16; ++k) {
        Random& random = random_inputs();
        const double epsilon_star = random.scale(1e-18, 1), omega_star = random.scale(1e-12, 1);
        const double above = random.scale(1.01, 1e8), below = 1 / random.scale(1.01, 1e8);
        const std::string with = concat(" with epsilon* = ", epsilon_star, " and omega* = ", omega_star);
        const auto on = [&](double c, double g) {
            return goes_on(c * epsilon_star, g * omega_star, epsilon_star, omega_star);
        };
        expect(on(above, below), "the loop ends with |c|^2 = ", above * epsilon_star, with,
               " because |grad E| is small");
        expect(on(below, above), "the loop ends with |grad E| = ", above * omega_star, with, " because |c| is small");
        expect(on(above, 1.01), "the loop ends although neither test holds", with);
        expect(!on(below, 1 / above), "the loop goes on although both tests hold", with);
        expect(!on(1, below) && !on(below, 1) && !on(0, 0),
               "the loop goes on where |c|^2 or |grad E| is just the tolerance", with, ": at most that is asked for");
    }
    for (const bool of_c : {true, false})
        expect(goes_on(of_c ? NAN : 0, of_c ? 0 : NAN, 1e-14, 1e-6), "the loop ends with ", of_c ? "|c|^2" : "|grad E|",
               " = NaN, as if that were small: no comparison with NaN is true");
    expect(goes_on(NAN, NAN, 1e-14, 1e-6), "the loop ends with |c|^2 = |grad E| = NaN, as if these were small");
}

EXERCISE("8.4", "penalty and tolerances") {
    for (int run = 0; run < 6; ++run) {
        Random& random = random_inputs();
        AugmentedLagrangianParams params;
        params.algorithm = Algorithm::paper;
        params.mu0 = random.scale(0.1, 1e4), params.omega0 = random.scale(1e-3, 10),
        params.epsilon0 = random.scale(1e-6, 1);
        Schedule library(params, 0, 1, 1);
        Settings s = {params.mu0, params.omega0, params.epsilon0};
        for (int k = 1; k <= 8; ++k) {
            const double c_squared =
                library.epsilon * (random.integer(0, 2) ? random.scale(1e-3, 0.9) : random.scale(1.1, 1e3));
            const bool updates = c_squared <= library.epsilon;
            if (updates) library.tighten(c_squared, 0);
            else library.raise_penalty();
            s = next(s, c_squared, params.mu0, params.omega0, params.epsilon0);
            const std::string where =
                concat(" after subproblem ", k, " with |c|^2 = ", c_squared, ", mu0 = ", params.mu0,
                       ", omega0 = ", params.omega0, ", epsilon0 = ", params.epsilon0);
            expect(s.updates_lambda == updates, "lambda is ", updates ? "not " : "", "updated", where,
                   ": line 9 asks whether |c|^2 <= epsilon");
            expect_close("mu" + where, s.mu / library.mu, 1, 1e-9,
                         "ratio to what it should be; it grows with m, line 18");
            expect_close(
                "epsilon" + where, s.epsilon / library.epsilon, 1, 1e-9,
                "ratio to what it should be: tightened by line 13 after an update, else started anew by line 19");
            expect_close(
                "omega" + where, s.omega / library.omega, 1, 1e-9,
                "ratio to what it should be: tightened by line 14 after an update, else started anew by line 20");
        }
    }
    const Settings exact = next({7, 0.1, 1e-5}, 1e-5, 7, 0.1, 1e-3);
    expect(exact.updates_lambda,
           "lambda is not updated with |c|^2 = epsilon = 1e-5: line 9 asks whether |c|^2 <= epsilon");
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

// A chain of springs: E = 1/2 x' K x + 1/2 sum log cosh x_i - b' x with K = tridiag(-1, 2 + ground, -1), c = a' x - 3.
// The second term is not quadratic: no line through two gradients foretells a third.
struct Chain {
    double mu, ground;
    std::vector<double> a, b;

    int size() const { return static_cast<int>(a.size()); }
    double step() const {  // below 2 / (largest eigenvalue of the Hessian), that of K + mu a a' and 1/2
        double aa = 0;
        for (const double a_i : a) aa += a_i * a_i;
        return 1 / (4.5 + ground + mu * aa);
    }
    double constraint(const std::vector<double>& x) const {
        double c = -3;
        for (int i = 0; i < size(); ++i) c += a[i] * x[i];
        return c;
    }
    // K x + 1/2 tanh x - b - factor a; factor = lambda - mu c: the gradient.
    std::vector<double> residual(const std::vector<double>& x, double factor) const {
        std::vector<double> r(a.size());
        for (int i = 0; i < size(); ++i)
            r[i] =
                (2 + ground) * x[i] - (i > 0 ? x[i - 1] : 0) - (i + 1 < size() ? x[i + 1] : 0) + 0.5 * std::tanh(x[i]) -
                b[i] - factor * a[i];
        return r;
    }
};

double norm(const std::vector<double>& v) {
    double squared = 0;
    for (const double v_i : v) squared += v_i * v_i;
    return std::sqrt(squared);
}

// Gradients where each subproblem is solved until half of what the update has put into the gradient is left.
int gradients_enough(const Chain& chain) {
    std::vector<double> x(chain.a.size());
    double lambda = 0;
    for (int count = 0;;) {
        double end = 0;
        for (bool first = true;; first = false) {
            const std::vector<double> g = chain.residual(x, lambda - chain.mu * chain.constraint(x));
            ++count;
            if (first) end = std::max(1e-9, 0.5 * norm(g));
            if (norm(g) <= end) break;
            for (std::size_t i = 0; i < x.size(); ++i) x[i] -= chain.step() * g[i];
        }
        if (std::abs(chain.constraint(x)) <= 1e-9 && end <= 1e-9) return count;
        lambda -= chain.mu * chain.constraint(x);
    }
}

void expect_solved(const Chain& chain) {
    const int most = 3 * gradients_enough(chain);
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
    // The multiplier may have had its last update, or not.
    const double c = chain.constraint(found.x), updated = norm(chain.residual(found.x, found.lambda)),
                 r = std::min(updated, norm(chain.residual(found.x, found.lambda - chain.mu * c)));
    expect(std::abs(c) <= 1e-9, where, "at the end |c| is ", std::abs(c), ", expected at most 1e-9");
    expect(r <= 1.001e-9, where, "at the end |grad| is ", r,
           ", expected at most 1e-9: |c| is small, and this has to be too; ", "line 7");
    expect(count <= most, where, count, " gradients, ", most, " should do: while lambda is wrong by much, an exact ",
           "minimum for it is worth nothing");
}

EXERCISE("8.6", "an hour: inexact subproblems") {
    for (int k = 0; k < 6; ++k) {
        Random& random = random_inputs();
        Chain chain{random.scale(0.7, 5), random.uniform(0.1, 0.3), {}, {}};
        for (int i = random.integer(4, 17); i > 0; --i) {
            chain.a.push_back(k % 2 ? i == 1 : random.uniform(-0.5, 0.5));  // the last one, or all
            chain.b.push_back(random.uniform(-1, 1));
        }
        expect_solved(chain);
    }
}

}  // namespace
}  // namespace almesh::lessons
