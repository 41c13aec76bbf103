#include "method/stopping_tests.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// With these parts of its energy.
struct WithParts : AugmentedFunctional {
    double distortion_part, lost;

    WithParts(const AugmentedFunctional& E, double of_distortion, double of_error)
        : AugmentedFunctional(E), distortion_part(of_distortion), lost(of_error) {}
    double distortion_energy(const std::vector<double>&, double) const override { return distortion_part; }
    double lost_energy(const std::vector<double>&) const override { return lost; }
};

}  // namespace

TEST_CASE("out of reach: a full step gains less than a thousandth, and nine tenths of the energy are penalty") {
    const Minimisation problem(square_mesh(2), {}, Objective::squared);
    NewtonParams params{.largest_energy = 100};
    const auto found = [&](double energy, double gained, double step_length, double distortion, double lost = 0) {
        const WithParts E(problem.functional(1), distortion * energy, lost);
        NewtonStep step;
        step.has_direction = true;
        step.step_length = step_length;
        NewtonResult before, at;
        before.energy = lost + energy * (1 + gained);
        at.energy = lost + energy;
        return StoppingTests(params).after_step(step, before, at, E, problem.ideal) == Status::stalled;
    };
    CHECK(found(101, 0.9e-3, 1, 0.09));
    CHECK(found(101, 0.9e-3, 2, 0.09));
    CHECK(found(101, 0.9e-3, 1, 0.09, 50));
    CHECK_FALSE(found(99, 0.9e-3, 1, 0.09));
    CHECK_FALSE(found(99, 0.9e-3, 1, 0.09, 50));
    CHECK_FALSE(found(101, 1.1e-3, 1, 0.09));
    CHECK_FALSE(found(101, 1.1e-3, 1, 0.09, 50));
    CHECK_FALSE(found(101, 0.9e-3, 0.5, 0.09));
    CHECK_FALSE(found(101, 0.9e-3, 1, 0.11));
    params = {};
    CHECK_FALSE(found(1e300, 0, 1, 0));
}

TEST_CASE("below rounding the iteration goes on while a step halves the gradient, and until it is small enough") {
    const Minimisation problem(square_mesh(2), {}, Objective::squared);
    const AugmentedFunctional E = problem.functional(1);
    const NewtonParams params;
    const auto ends = [&](bool by_rounding, double gradient_before, double gradient) {
        NewtonStep step;
        step.has_direction = true;
        step.step_length = 1;
        step.by_rounding = by_rounding;
        NewtonResult before, at;
        before.gradient_norm = gradient_before;
        at.gradient_norm = gradient;
        at.omega = 1e-8;
        return StoppingTests(params).after_step(step, before, at, E, problem.ideal) == Status::attainable_accuracy;
    };
    CHECK(ends(true, 1e-3, 0.6e-3));
    CHECK(ends(true, 1e-3, 2e-3));
    CHECK_FALSE(ends(true, 1e-3, 0.4e-3));
    CHECK_FALSE(ends(true, 1e-3, 1e-5));
    CHECK_FALSE(ends(false, 1e-3, 2e-3));
    CHECK_FALSE(ends(true, 1e-8, 0.9e-8));
}

TEST_CASE("the last local step gains too little, or takes the work or the steps beyond their bounds") {
    const NewtonParams local{.max_iterations = 30, .least_gain = 2, .most_work = 100}, whole;
    const auto is_last = [](const NewtonParams& params, double gained, double so_far, double work, int iterations) {
        NewtonResult before, at;
        before.energy = gained;
        at.start_energy = so_far;
        at.work = work;
        at.iterations = iterations;
        return StoppingTests(params).is_last(before, at);
    };
    CHECK_FALSE(is_last(local, 2.1, 2000, 100, 29));
    CHECK(is_last(local, 2, 2000, 100, 29));
    CHECK(is_last(local, 2.1, 2101, 100, 29));
    CHECK(is_last(local, 2.1, 2000, 101, 29));
    CHECK(is_last(local, 2.1, 2000, 100, 30));
    CHECK_FALSE(is_last(whole, 0, 1, 1e300, 200));
}

TEST_CASE("before a step: converged, overflow, or no more steps") {
    const NewtonParams params{.max_iterations = 5};
    const StoppingTests tests(params);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto before_step = [&](int iterations, double energy, double gradient_norm) {
        NewtonResult at;
        at.iterations = iterations;
        at.energy = energy;
        at.gradient_norm = gradient_norm;
        at.omega = 1e-8;
        return tests.before_step(at);
    };
    CHECK(before_step(4, 1, 1e-7) == std::nullopt);
    CHECK(before_step(5, 1, 1e-8) == Status::converged);
    CHECK(before_step(5, 1, 1e-7) == Status::max_newton_iterations);
    CHECK(before_step(5, 1, infinity) == Status::overflow);
    CHECK(before_step(4, 1, std::numeric_limits<double>::quiet_NaN()) == Status::overflow);
}

TEST_CASE("three full steps, or twelve short ones, that together gain less than can be seen are the last") {
    const Minimisation problem(square_mesh(2), {}, Objective::squared);
    const AugmentedFunctional E = problem.functional(1);
    bool of_power = false;
    const auto ends_at = [&](double visible_gain, double step_length, double of_early_step, double of_late_step) {
        NewtonParams params;
        params.visible_gain = of_power ? 1 : visible_gain;
        if (of_power) params.visible_part = visible_gain / E.distortion_energy(problem.ideal, 1);
        StoppingTests tests(params);
        NewtonStep step;
        step.has_direction = true;
        step.step_length = step_length;
        NewtonResult at;
        at.energy = at.gradient_norm = 1;
        while (at.iterations < 30) {
            const NewtonResult before = at;
            at.energy -= ++at.iterations <= 10 ? of_early_step : of_late_step;
            if (tests.after_step(step, before, at, E, problem.ideal) == Status::no_visible_gain) break;
        }
        return at.iterations;
    };
    CHECK(ends_at(1e-6, 1, 3e-7, 3e-7) == 3);
    CHECK(ends_at(1e-6, 4, 3e-7, 3e-7) == 3);
    CHECK(ends_at(1e-6, 1, 1.1e-6, 3e-7) == 13);   // the first ten are seen one by one,
    CHECK(ends_at(1e-6, 1, 0.6e-6, 3e-7) == 13);   // or two by two,
    CHECK(ends_at(1e-6, 1, 0.4e-6, 2e-7) == 12);   // or three by three: one of these and two later ones are not
    CHECK(ends_at(1e-6, 0.5, 1.1e-6, 1e-7) == 16);
    CHECK(ends_at(1e-6, 0.01, 1.1e-6, 0.8e-7) == 22);
    CHECK(ends_at(1e-6, 0.01, 1.1e-6, 0.9e-7) == 30);  // twelve of these are seen
    CHECK(ends_at(0, 1, 0.9e-7, 1e-14) == 30);
    of_power = true;
    CHECK(ends_at(1e-6, 1, 3e-7, 3e-7) == 3);
    CHECK(ends_at(1e-6, 1, 1.1e-6, 3e-7) == 13);
}

TEST_CASE("after a step: failures, and the third in a row that leads nowhere") {
    const Minimisation problem(square_mesh(2), {}, Objective::squared);
    const AugmentedFunctional E = problem.functional(1);
    const NewtonParams params;
    StoppingTests tests(params);
    NewtonResult before;
    before.energy = before.gradient_norm = 1;
    const auto after_step = [&](bool has_direction, double step_length, double gained) {
        NewtonStep step;
        step.has_direction = has_direction;
        step.step_length = step_length;
        NewtonResult at = before;
        at.energy -= gained;
        return tests.after_step(step, before, at, E, problem.ideal);
    };
    CHECK(after_step(false, 0, 0) == Status::linear_solver_failed);
    CHECK(after_step(true, 0, 0) == Status::line_search_failed);
    for (int times = 0; times < 2; ++times) {
        CHECK(after_step(true, 1e-9, 0) == std::nullopt);
        CHECK(after_step(true, 1e-9, 1e-15) == std::nullopt);
        CHECK(after_step(true, times == 0 ? 1 : 1e-9, times == 0 ? 0 : 1e-13) == std::nullopt);  // not in a row
    }
    CHECK(after_step(true, 1e-9, 0) == std::nullopt);
    CHECK(after_step(true, 1e-9, 0) == std::nullopt);
    CHECK(after_step(true, 1e-9, 0) == Status::line_search_failed);
}
