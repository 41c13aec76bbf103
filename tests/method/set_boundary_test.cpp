#include "method/set_boundary.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/interrupt.hpp"
#include "support/high_order.hpp"
#include "support/minimisation.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A ring whose inner circle moves, in so many increments.
struct SetRing {
    Minimisation of;
    std::vector<double> x;
    AlResult result;

    SetRing(const Mesh& ring, const std::string& motion, int increments)
        : of(ring, {{"inner", motion}}, Objective::deviation, TargetKind::nodal), x(of.ideal) {
        Newton newton(of.distortion.hessian_pattern(), {});
        result = minimise_with_boundary_set(of.level, newton, {}, increments, x);
    }
    double eta() const { return result.distortion.max_distortion; }
    bool is_set() const { return of.constraint.max_error(x) == 0; }
};

}  // namespace

TEST_CASE("with the boundary set, at once or in increments, the minimum is that of Algorithm 1") {
    for (const char* const motion : {"translate 2 0.3", "rotate 40 about 0 0", "scale 1.4"})
        for (const int degree : {1, 2}) {
            CAPTURE(motion);
            CAPTURE(degree);
            const Mesh ring = with_degree(ring_mesh(12, 3, 6), degree);
            const Minimisation of(ring, {{"inner", motion}}, Objective::deviation, TargetKind::nodal);
            std::vector<double> x;
            const double eta = of.solve({}, x).distortion.max_distortion;
            for (const int increments : {1, 4}) {
                const SetRing set(ring, motion, increments);
                CHECK(set.result.status == Status::converged);
                CHECK(set.is_set());
                CHECK(set.of.level.is_valid(set.x));
                CHECK(set.result.lambda == std::vector<double>(of.constraint.multipliers(), 0.0));
                CHECK(set.result.iterations.size() == 2);
                CHECK(set.eta() == doctest::Approx(eta).epsilon(1e-6));
            }
        }
}

TEST_CASE("a large motion has no valid start at once, where the mesh stays as it is, but in increments") {
    const Mesh ring = ring_mesh(24, 6, 12);
    const SetRing once(ring, "translate 9 0", 1), parts(ring, "translate 9 0", 10);
    CHECK(once.result.status == Status::invalid_start);
    CHECK(once.x == once.of.ideal);
    CHECK(parts.result.status == Status::converged);
    CHECK(parts.is_set());
}

TEST_CASE("increments are halved where none of their starts is valid, and end at the last valid mesh") {
    const SetRing two(ring_mesh(24, 6, 12), "translate 9 0", 2);
    CHECK(two.result.status == Status::converged);
    const SetRing beyond(ring_mesh(24, 6, 12), "translate 11.5 0", 2);
    CHECK(beyond.result.status != Status::converged);
    CHECK(beyond.of.level.is_valid(beyond.x));
    CHECK(!beyond.is_set());
}

TEST_CASE("increments before the last are minimised to 3 %, in two or three steps each") {
    const SetRing five(ring_mesh(24, 6, 10), "rotate 60 about 0 0", 5);
    CHECK(five.result.status == Status::converged);
    CHECK(five.result.newton_iterations <= 4 * 4 + 10);  // with a linear solve each
}

TEST_CASE("an interrupt ends the increments") {
    interrupt_flag = 1;
    const SetRing parts(ring_mesh(12, 3, 6), "translate 2 0", 4);
    clear_interrupt();
    CHECK(parts.result.status == Status::interrupted);
}

TEST_CASE("penalty: the multipliers stay zero, and |c_D| falls like 1 / mu") {
    const Minimisation of(ring_mesh(12, 3, 6), {{"inner", "translate 2 0"}}, Objective::squared);
    std::vector<double> x;
    const AlResult result = of.solve({.moving = MovingMethod::penalty}, x);
    CHECK(result.status == Status::converged);
    CHECK(result.lambda == std::vector<double>(of.constraint.multipliers(), 0.0));
    REQUIRE(result.iterations.size() > 4);
    for (std::size_t k = 2; k < result.iterations.size(); ++k) {
        const AlIteration &before = result.iterations[k - 1], &now = result.iterations[k];
        CHECK(now.mu == doctest::Approx(10 * before.mu));
        CHECK(before.update == AlUpdate::penalty);
        CHECK(now.projected_constraint_norm / before.projected_constraint_norm == doctest::Approx(0.1).epsilon(0.1));
    }
    std::vector<double> with_multipliers;
    CHECK(of.solve({}, with_multipliers).iterations.size() < result.iterations.size());
}

TEST_CASE("penalty makes whole runs: certified, from the minimum, for any number of threads; not with minimax") {
    const RingDeck ring(ring_mesh(24, 6, 12), "");
    const auto results = for_threads([&] {
        const Outcome outcome = ring.run({"boundary inner=translate 7 1", "method=penalty", "refine=1"});
        return std::tuple(outcome.code, text_of(ring.output + "/final.msh"), history_without_times(ring.output));
    });
    CHECK(std::get<0>(results[0]) == 0);
    CHECK(results[1] == results[0]);
    CHECK(results[2] == results[0]);
    CHECK(has(ring.run({"objective=minimax", "method=penalty"}).error, "minimax does not go with this method"));
    CHECK(has(ring.run({"method=penlty"}).error, "did you mean `penalty`?"));
    CHECK(ring.run({"boundary inner=rotate 5 about 0 0; slide", "method=penalty"}).code == 0);
}
