// L-BFGS: minima that are known, functions that are not defined everywhere, surfaces that the iterates stay on.
#include "method/lbfgs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <utility>

using namespace almesh;

namespace {

struct Rosenbrock : SmoothFunction {
    int values = 0;

    double value(const std::vector<double>& z, std::vector<double>& g) override {
        ++values;
        double sum = 0;
        g.assign(z.size(), 0.0);
        for (std::size_t i = 0; i + 1 < z.size(); i += 2) {
            const double a = z[i + 1] - z[i] * z[i], b = 1 - z[i];
            sum += 100 * a * a + b * b;
            g[i] = -400 * a * z[i] - 2 * b;
            g[i + 1] = 200 * a;
        }
        return sum;
    }
};

// - log z - log (1 - z), with a minimum at 1/2, and nothing outside (0, 1).
struct Barrier : SmoothFunction {
    double value(const std::vector<double>& z, std::vector<double>& g) override {
        if (!(z[0] > 0 && z[0] < 1)) return std::numeric_limits<double>::infinity();
        g[0] = -1 / z[0] + 1 / (1 - z[0]);
        return -std::log(z[0]) - std::log(1 - z[0]);
    }
};

// The height of a point of the unit circle.
struct Height : SmoothFunction {
    double value(const std::vector<double>& z, std::vector<double>& g) override {
        g = {-z[1] * z[0], 1 - z[1] * z[1]};
        return z[1];
    }
    void retract(std::vector<double>& z) const override {
        const double r = std::hypot(z[0], z[1]);
        for (double& of : z) of /= r;
    }
};

struct Stopped : Rosenbrock {
    int accepted = 0;
    bool accept(const std::vector<double>&) override { return ++accepted < 7; }
};

// Falls by 1 with each value, whatever z is; its gradients along the first of two axes are these, one after the other.
struct Told : SmoothFunction {
    std::vector<double> gradient;
    std::vector<std::vector<double>> asked = {};

    explicit Told(std::vector<double> gradients) : gradient(std::move(gradients)) {}
    double value(const std::vector<double>& z, std::vector<double>& g) override {
        g = {gradient[asked.size()], 0};
        asked.push_back(z);
        return -static_cast<double>(asked.size());
    }
};

}  // namespace

TEST_CASE("L-BFGS forgets no difference for one along which the function is not convex") {
    Told f({1, 0.5, 0.7, 0.6});  // the slope falls by 0.5 over 0.1, then rises
    std::vector<double> z{0, 0};
    minimise(f, {.memory = 1, .max_iterations = 3, .first_step = 0.1, .largest_step = 100}, z);
    REQUIRE(f.asked.size() == 4);
    for (const auto& [k, x] : {std::pair(1, -0.1), {2, -0.2}, {3, -0.34}})
        CHECK(std::abs(f.asked[k][0] - x) < 1e-14);
}

TEST_CASE("L-BFGS finds the minimum of Rosenbrock's function, of any number of variables, with a value per step") {
    for (const std::size_t n : {2, 40}) {
        Rosenbrock f;
        std::vector<double> z(n, -1.2);
        const int steps = minimise(f, {.max_iterations = 300, .least_fall = 1e-14}, z);
        for (const double of : z) CHECK(std::abs(of - 1) < 1e-5);
        CHECK(steps > 20);
        CHECK(f.values < 1.5 * steps);
    }
}

TEST_CASE("L-BFGS stays where the function is defined, and on the surface that iterates are put back onto") {
    Barrier barrier;
    std::vector<double> z{1e-3};
    minimise(barrier, {.least_fall = 1e-14, .largest_step = 10}, z);
    CHECK(std::abs(z[0] - 0.5) < 1e-5);
    Height height;
    std::vector<double> y{0.6, 0.8};
    minimise(height, {.least_fall = 1e-14}, y);
    CHECK(std::abs(y[1] + 1) < 1e-6);
    CHECK(std::abs(std::hypot(y[0], y[1]) - 1) < 1e-15);
}

TEST_CASE("L-BFGS ends where it is told to, after its iterations, and at a minimum at once") {
    Stopped f;
    std::vector<double> z{-1.2, 1};
    CHECK(minimise(f, {}, z) == 7);
    Rosenbrock g;
    CHECK(minimise(g, {.max_iterations = 3}, z) == 3);
    z = {1, 1};
    CHECK(minimise(g, {}, z) == 0);
    CHECK(z == std::vector<double>{1, 1});
}
