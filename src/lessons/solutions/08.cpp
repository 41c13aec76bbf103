// Solutions of the exercises of lesson 8.
#include "lessons/exercises/08.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace almesh::lessons {

double best_step(double kappa_1, double kappa_2, double weight) {
    // The factors 1 - s / (kappa + weight) of the softest and the stiffest mode, with signs that differ.
    const double soft = kappa_1 + weight, stiff = kappa_2 + weight;
    return 2 / (1 / soft + 1 / stiff);
}

int updates_as_printed(double mu, double q) {
    const double factor = std::abs(1 - 1 / mu);  // 1 - s / (kappa + w) with kappa = 0, w = mu^2 and s = mu
    if (factor >= 1) return -1;
    int updates = 0;
    for (double error = 1; error > 1 / q; error *= factor) ++updates;
    return updates;
}

bool goes_on(double c_squared, double gradient_norm, double epsilon_star, double omega_star) {
    return !(c_squared <= epsilon_star && gradient_norm <= omega_star);  // true for NaN, too
}

Settings next(const Settings& now, double c_squared, double mu0, double omega0, double epsilon0) {
    Settings s = now;
    s.updates_lambda = c_squared <= now.epsilon;  // 9
    if (s.updates_lambda) {
        const double m = 10 * now.mu / mu0;  // by line 18
        s.epsilon /= std::pow(m, 0.9);       // 13
        s.omega /= m;                        // 14
    } else {
        s.mu *= 100;                                       // 17, 18
        s.epsilon = epsilon0 / std::pow(s.mu / mu0, 0.1);  // 19
        s.omega = omega0 / (s.mu / mu0);                   // 20
    }
    return s;
}

ConstrainedMinimum inexact_multipliers(const CostlyProblem& problem) {
    const double tolerance = 1e-9;
    const auto norm = [](const std::vector<double>& v) {
        return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
    };
    ConstrainedMinimum found = {std::vector<double>(problem.unknowns), 0};
    while (true) {
        std::vector<double> g = problem.gradient(found.x, found.lambda);
        // As good as the multiplier allows: half of what its last update has put there.
        const double omega = std::max(tolerance, 0.5 * norm(g));
        while (norm(g) > omega) {
            for (std::size_t i = 0; i < g.size(); ++i) found.x[i] -= problem.step * g[i];
            g = problem.gradient(found.x, found.lambda);
        }
        const double c = problem.constraint(found.x);
        if (std::abs(c) <= tolerance && norm(g) <= tolerance) return found;
        found.lambda -= problem.mu * c;
    }
}

}  // namespace almesh::lessons
