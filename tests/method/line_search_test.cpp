#include "method/line_search.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace almesh;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// From x = 0 along d = 1. The way is valid up to `wall`.
LineSearchResult search(const std::function<double(double)>& E, double slope, double& x, double wall = infinity,
                        double rounding_error = 0) {
    std::vector<double> at = {0}, trial = {0};
    const auto energy = [&](const std::vector<double>& y) { return E(y[0]); };
    const auto valid_fraction = [wall](const std::vector<double>& from, const std::vector<double>& to) {
        return to[0] <= wall ? 1 : (wall - from[0]) / (to[0] - from[0]);
    };
    const LineSearchResult result =
        line_search(energy, valid_fraction, E(0), slope, {1}, at, trial, {}, rounding_error);
    x = at[0];
    return result;
}

}  // namespace

TEST_CASE("an exact model takes the full step, and asks for one energy") {
    double x;
    int energies = -1;  // that at 0 is the caller's
    const auto r = search([&](double t) { return ++energies, t * t - 2 * t + 5; }, -2, x);
    CHECK(r.step_length == 1);
    CHECK(r.energy == 4);
    CHECK(r.cuts_inverted + r.cuts_decrease == 0);
    CHECK(!r.by_rounding);
    CHECK(energies == 1);
    CHECK(x == 1);
}

TEST_CASE("a step that inverts is halved, one that does not decrease goes to the minimum of the parabola") {
    double x;
    const auto inverted = search([](double t) { return t > 0.3 ? infinity : -t; }, -1, x);
    CHECK(inverted.step_length == 0.25);
    CHECK(inverted.cuts_inverted == 2);
    CHECK(inverted.cuts_decrease == 0);
    CHECK(x == 0.25);
    const auto longer = search([](double t) { return 2 * t * t - t; }, -1, x);  // minimum at 1/4
    CHECK(longer.step_length == 0.25);
    CHECK(longer.cuts_decrease == 1);
    CHECK(longer.energy == -0.125);
}

TEST_CASE("a step that stops short of the minimum is doubled while that pays, and not into an inverted element") {
    double x;
    const auto far = search([](double t) { return 0.5 * t * t / 5 - t; }, -1, x);  // minimum at 5
    CHECK(far.step_length == 4);
    CHECK(x == 4);
    CHECK(far.energy == doctest::Approx(0.5 * 16 / 5 - 4));
    const auto wall = search([](double t) { return t > 3 ? infinity : -t; }, -1, x);
    CHECK(wall.step_length == 2);
    CHECK(wall.cuts_inverted == 0);  // the step is not cut
    CHECK(x == 2);
    const auto endless = search([](double t) { return -t; }, -1, x);
    CHECK(endless.step_length == 64);
}

TEST_CASE(
    "below rounding the full step is taken where the energy stays the same; without a decrease there is no step") {
    double x;
    const auto flat = search([](double) { return 1.0; }, -1e-16, x);
    CHECK(flat.by_rounding);
    CHECK(flat.step_length == 1);
    // The terms of the energy err by more than their sum would.
    const auto noisy = [](double t) { return t > 0 ? 1 + 1e-13 : 1.0; };
    const auto lost = search(noisy, -6e-15, x);
    CHECK(lost.step_length == 0);
    const auto known = search(noisy, -6e-15, x, infinity, 2e-13);
    CHECK(known.by_rounding);
    CHECK(known.step_length == 1);
    CHECK_FALSE(search([](double t) { return 1 - t + 0.5 * t * t; }, -1, x, infinity, 2e-13).by_rounding);
    const auto uphill = search([](double t) { return 1 + t; }, -1, x);
    CHECK(uphill.step_length == 0);
    CHECK(x == 0);
    CHECK(uphill.cuts_decrease > 0);
}

TEST_CASE("a step that passes through an inversion is cut to half of what is valid, and not lengthened through one") {
    double x;
    const auto beyond = [](double t) { return t > 0.4 && t < 0.6 ? infinity : -t; };  // lower on the other side
    const auto cut = search(beyond, -1, x, 0.4);
    CHECK(cut.step_length == 0.2);
    CHECK(cut.cuts_inverted == 1);
    CHECK(x == 0.2);
    const auto longer = search([](double t) { return -t; }, -1, x, 5);
    CHECK(longer.step_length == 4);
    const auto none = search([](double t) { return -t; }, -1, x, 0);  // nothing is valid
    CHECK(none.step_length == 0);
    CHECK(x == 0);
}

TEST_CASE("a slope beyond the range of numbers ends the search, whatever the energy does") {
    double x;
    for (const double slope : {-infinity, -1e308 * 10, std::numeric_limits<double>::quiet_NaN()})
        for (const double end : {0.5, 2.0, 1e308}) {
            const auto r = search([end](double t) { return t == 0 ? 1 : end; }, slope, x);
            CHECK(r.step_length == 0);
            CHECK(x == 0);
        }
}

TEST_CASE("a decrease counts from a ten-thousandth of what the slope promises") {
    double x;
    const auto ending = [](double gain) { return [gain](double t) { return (1 - gain) * t * t - t; }; };
    const auto too_little = search(ending(0.5e-4), -1, x);
    CHECK(too_little.cuts_decrease == 1);
    CHECK(x == 0.5);
    const auto enough = search(ending(2e-4), -1, x);
    CHECK(enough.cuts_decrease == 0);
    CHECK(x == 1);
}

TEST_CASE("rounding begins where a step promises a hundredth of a millionth of a millionth of the energy") {
    double x;
    for (const double energy : {1.0, -300.0}) {
        const double size = std::abs(energy);
        const auto rising_by = [energy](double part) {
            return [energy, part](double t) { return energy + part * std::abs(energy) * t; };
        };
        const auto noisy = search(rising_by(4e-15), -8e-15 * size, x);
        CHECK(noisy.by_rounding);
        CHECK(x == 1);
        const auto uphill = search(rising_by(4e-14), -8e-15 * size, x);  // more than rounding
        CHECK(uphill.by_rounding);
        CHECK(x < 1);
        const auto promising = search(rising_by(4e-15), -4e-14 * size, x);
        CHECK_FALSE(promising.by_rounding);
        CHECK(x < 1);
    }
}

TEST_CASE("short steps: a millionth before elements invert, or along what is valid, in few trials") {
    double x;
    const auto halved = search([](double t) { return t > 1e-6 ? infinity : -t; }, -1, x);
    CHECK(halved.cuts_inverted == 20);
    CHECK(x == std::ldexp(1, -20));
    const auto along = search([](double t) { return -t; }, -1, x, 1e-5);
    CHECK(along.cuts_inverted == 2);
    CHECK(x == doctest::Approx(0.5e-5));
    const auto steep = search([](double t) { return t > 0.5 ? 1e6 : -t; }, -1, x);  // a parabola that is far off
    CHECK(steep.cuts_decrease == 1);
    CHECK(x == 0.1);
}

TEST_CASE("a step is lengthened where it gives more than two thirds of what the slope promises") {
    double x;
    int energies = 0;
    const auto giving = [&energies](double gain) {
        return [&energies, gain](double t) { return ++energies, (1 - gain) * t * t - t; };
    };
    search(giving(0.6), -1, x);
    CHECK(x == 1);
    CHECK(energies == 2);  // at 0, by the caller, and at 1
    search(giving(0.7), -1, x);
    CHECK(x == 2);
}
