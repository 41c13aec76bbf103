#include "method/p_norm.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "support/minimisation.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr int around = 32, layers = 12;
constexpr double outer_radius = 20;

std::string value(const RingDeck& ring, const std::string& quantity) { return summary_of(ring.output).at(quantity); }
double number(const RingDeck& ring, const std::string& quantity) { return std::stod(value(ring, quantity)); }
double steps(const RingDeck& ring) {
    return number(ring, "newton_iterations") + number(ring, "earlier_newton_iterations");
}

// The least largest distortion of a map of the ring that turns its inner circle: the logarithmic spiral has it
// everywhere. That of the mesh, whose outlines are polygons of the same angles, has about the same ratio of radii.
double least_distortion(double degrees) {
    const double twist = degrees * std::numbers::pi / 180 / std::log(outer_radius);
    return 1 + 0.5 * twist * twist;
}

}  // namespace

TEST_CASE("objective = minimax comes near to the least possible worst element, in at most five times the steps") {
    const RingDeck ring(ring_mesh(around, layers, outer_radius));
    for (const double degrees : {30, 90, 180}) {
        const std::string motion = "boundary inner=rotate " + std::to_string(degrees);
        CHECK(ring.run({motion}).code == 0);
        const double usual = number(ring, "max_distortion"), usual_steps = steps(ring);
        CHECK(ring.run({motion, "objective=minimax"}).code == 0);
        const double worst = number(ring, "max_distortion"), least = least_distortion(degrees);
        CHECK(value(ring, "certified_injective") == "yes");
        CHECK(number(ring, "nodes_off_target") == 0);
        CHECK(worst < usual);
        CHECK(worst - 1 < 1.35 * (least - 1));  // of which the coarse mesh takes the most
        CHECK(steps(ring) <= 5 * usual_steps);
        CHECK(number(ring, "power") >= 8);
    }
}

TEST_CASE("a higher last power has a better worst element; power 2 is the deviation with equal weights") {
    const RingDeck ring(ring_mesh(around, layers, outer_radius));
    const std::string motion = "boundary inner=translate 8 0";
    CHECK(ring.run({motion, "weight_exponent=0"}).code == 0);
    double before = number(ring, "max_distortion");
    CHECK(ring.run({motion, "objective=minimax", "power=2"}).code == 0);
    CHECK(number(ring, "max_distortion") == doctest::Approx(before).epsilon(1e-6));
    CHECK(value(ring, "power") == "2");
    for (const char* power : {"4", "8", "24", "64"}) {
        CHECK(ring.run({motion, "objective=minimax", std::string("power=") + power}).code == 0);
        CHECK(value(ring, "power") == power);
        const double worst = number(ring, "max_distortion");
        CHECK(worst < before);
        before = worst;
    }
}

TEST_CASE("the powers on the way are rows of the report") {
    const RingDeck ring(ring_mesh(around, layers, outer_radius));
    const Outcome outcome = ring.run({"boundary inner=translate 8 0", "objective=minimax", "power=16"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "(eta - 1)^2\n"));
    CHECK(has(outcome.out, "(eta - 1)^8\n"));
    CHECK_FALSE(has(outcome.out, "(eta - 1)^16\n"));
    CHECK(has(outcome.out, " more with earlier powers) in "));
    const auto rows = csv_rows(text_of(ring.output + "/history.csv"));
    CHECK(rows[1][0] == "power");
    CHECK(rows[0][29] == "power");
    CHECK(rows[1][29] == "2");
    CHECK(rows[2][29] == "4");
}

TEST_CASE("nothing is sharpened where nothing moves, and curved elements are sharpened too") {
    const RingDeck ring(ring_mesh(around, layers, outer_radius));
    CHECK(ring.run({"boundary inner=fixed", "objective=minimax"}).code == 0);
    CHECK(value(ring, "power") == "2");
    CHECK(ring.run({"boundary inner=rotate 60", "degree=2"}).code == 0);
    const double usual = number(ring, "max_distortion");
    CHECK(ring.run({"boundary inner=rotate 60", "degree=2", "objective=minimax"}).code == 0);
    CHECK(number(ring, "max_distortion") - 1 < 0.8 * (usual - 1));
    CHECK(value(ring, "certified_injective") == "yes");
}

TEST_CASE("a subproblem that fails leaves the power before it") {
    const RingDeck ring(ring_mesh(around, layers, outer_radius));
    const Outcome outcome =
        ring.run({"boundary inner=translate 18 0", "objective=minimax", "max_newton_iterations=6"});
    if (outcome.code == 0) CHECK(number(ring, "power") < 64);
    else CHECK(outcome.code == 3);
    CHECK(value(ring, "certified_injective") == "yes");
}

TEST_CASE("power 64 takes most of what the worst element has, in steps of each power") {
    const RingDeck ring(ring_mesh(around, layers, outer_radius));
    const auto powers = [&](const std::string& motion) {
        CHECK(ring.run({"boundary inner=" + motion, "objective=minimax"}).code == 0);
        auto rows = csv_rows(text_of(ring.output + "/history.csv"));
        std::erase_if(rows, [](const auto& row) { return row[0] != "power"; });
        return rows;
    };
    const auto far = powers("translate 15 0");
    REQUIRE(far.size() == 5);
    CHECK(number(ring, "max_distortion") - 1 < 0.45 * (std::stod(far[0][11]) - 1));
    for (const auto& row : powers("rotate 30")) CHECK(std::stoi(row[12]) > 0);
}
