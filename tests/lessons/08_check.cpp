#include "lessons/exercises/08.hpp"

#include "lessons/exercise.hpp"
#include "method/schedule.hpp"

namespace almesh::lessons {
namespace {

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
    const auto library = make_schedule(params, 0, 1, 1);
    Settings s = {10, params.mu0, params.omega0, params.epsilon0};
    int k = 1;
    for (const double c_squared : {1.0, 1e-2, 1e-9, 1e-14, 1e-1, 1e-11}) {
        const bool updates = c_squared <= library->epsilon;
        if (updates) library->tighten(c_squared, 0);
        else library->raise_penalty();
        s = next(s, c_squared, params.mu0, params.omega0, params.epsilon0);
        const std::string where = concat(" after subproblem ", k++, " with |c|^2 = ", c_squared);
        expect(s.updates_lambda == updates, "lambda is ", updates ? "not " : "", "updated", where,
               ": line 9 asks whether |c|^2 <= epsilon");
        expect_close("mu" + where, s.mu / library->mu, 1, 1e-9, "ratio to what it should be; it grows with m, line 18");
        expect_close("epsilon" + where, s.epsilon / library->epsilon, 1, 1e-9,
                     "ratio to what it should be: divided by m^0.9 after an update, else by (m/m0)^0.1 from epsilon0");
        expect_close("omega" + where, s.omega / library->omega, 1, 1e-9,
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

}  // namespace
}  // namespace almesh::lessons
