// Exercises of lesson 8. Answers go into 08.cpp; `make check-lesson-08` says which hold.
#pragma once
#include <functional>
#include <vector>

namespace almesh::lessons {

// 8.1 The best step s of the update lambda <- lambda - s c for all modes from kappa_1 to kappa_2 >= kappa_1 at once,
// where the penalty has the weight `weight`, E = 1/2 kappa x^2 - lambda c + weight/2 c^2, c = x - g, and kappa_1 +
// weight > 0: the s for which the error of that mode of which an update leaves most becomes as small as possible.
double best_step(double kappa_1, double kappa_2, double weight);

// 8.2 How many updates the printed pair, weight mu^2 and step mu, needs until the error of a soft mode (kappa = 0) is
// no more than 1/q of what it was, q > 1; -1 where that never happens.
int updates_as_printed(double mu, double q);

// 8.3 Line 7, corrected: whether the loop goes on. What is no number (NaN) is not small.
bool goes_on(double c_squared, double gradient_norm, double epsilon_star, double omega_star);

// 8.4 Lines 9 to 21, corrected: penalty and tolerances of the next subproblem. c_squared: |c_D|^2 after this one. There
// is no m among the settings: at first m = m_0 = 10, mu = mu0, and after that the other settings tell what m is.
struct Settings {
    double mu = 0, omega = 0, epsilon = 0;
    bool updates_lambda = false;  // whether line 10 is executed before the next subproblem
};
Settings next(const Settings& now, double c_squared, double mu0, double omega0, double epsilon0);

// 8.5 exercises/loose.deck: tolerances with which 14 Newton steps are enough.

// 8.6 minimise E(x) subject to c(x) = 0 by the method of multipliers and steepest descent: a step x <- x - step grad
// takes x towards the minimum of E(x) - lambda c + mu/2 c^2, and its gradient is what costs. Start from x = 0 and
// lambda = 0, end with |c| <= 1e-9 and |grad| <= 1e-9. Each subproblem only as well as it is worth: the calls of
// `gradient` are counted, and may be three times those of a simple rule for how well.
struct CostlyProblem {
    int unknowns;
    double mu, step;
    std::function<std::vector<double>(const std::vector<double>& x, double lambda)> gradient;
    std::function<double(const std::vector<double>& x)> constraint;  // c; costs nothing
};
struct ConstrainedMinimum {
    std::vector<double> x;
    double lambda = 0;
};
ConstrainedMinimum inexact_multipliers(const CostlyProblem& problem);

}  // namespace almesh::lessons
