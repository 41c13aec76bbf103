// Exercises of lesson 8. Answers go into 08.cpp; `make check-lesson-08` says which hold.
#pragma once

namespace almesh::lessons {

// 8.1 The factor by which an update lambda <- lambda - step c multiplies the error of a mode of stiffness kappa, with
// sign, where the penalty has the weight `weight`: E = 1/2 kappa x^2 - lambda c + weight/2 c^2, c = x - g.
double contraction(double kappa, double weight, double step);

// 8.2 How many updates the printed pair, weight mu^2 and step mu, needs until the error of a soft mode (kappa = 0) is
// no more than 1/q of what it was, q > 1; -1 where that never happens.
int updates_as_printed(double mu, double q);

// 8.3 Line 7, corrected: whether the loop goes on.
bool goes_on(double c_squared, double gradient_norm, double epsilon_star, double omega_star);

// 8.4 Lines 9 to 21, corrected: penalty and tolerances of the next subproblem. c_squared: |c_D|^2 after this one.
struct Settings {
    double m = 10, mu = 0, omega = 0, epsilon = 0;
    bool updates_lambda = false;  // whether line 10 is executed before the next subproblem
};
Settings next(const Settings& now, double c_squared, double mu0, double omega0, double epsilon0);

}  // namespace almesh::lessons
