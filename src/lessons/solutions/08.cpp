// Solutions of the exercises of lesson 8.
#include "lessons/exercises/08.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace almesh::lessons {

double contraction(double kappa, double weight, double step) { return 1 - step / (kappa + weight); }

int updates_as_printed(double mu, double q) {
    const double factor = std::abs(1 - 1 / mu);  // 8.1 with kappa = 0, weight mu^2 and step mu
    if (factor >= 1) return -1;
    int updates = 0;
    for (double error = 1; error > 1 / q; error *= factor) ++updates;
    return updates;
}

bool goes_on(double c_squared, double gradient_norm, double epsilon_star, double omega_star) {
    return c_squared > epsilon_star || gradient_norm > omega_star;
}

Settings next(const Settings& now, double c_squared, double mu0, double omega0, double epsilon0) {
    Settings s = now;
    s.updates_lambda = c_squared <= now.epsilon;  // 9
    if (s.updates_lambda) {
        s.epsilon /= std::pow(s.m, 0.9);  // 13
        s.omega /= s.m;                   // 14
    } else {
        const double m0 = 10;
        s.m *= 100;                                      // 17
        s.mu = mu0 * (s.m / m0);                         // 18
        s.epsilon = epsilon0 / std::pow(s.m / m0, 0.1);  // 19
        s.omega = omega0 / (s.m / m0);                   // 20
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
