#include "method/continuation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "base/interrupt.hpp"
#include "support/endless.hpp"
#include "support/minimisation.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr int around = 24, layers = 8;

std::string value(const RingDeck& ring, const std::string& quantity) { return summary_of(ring.output).at(quantity); }

int count(const RingDeck& ring, const std::string& quantity) { return std::stoi(value(ring, quantity)); }

// Degrees by which the mesh has turned from the outer circle to the inner one, along nodes that were on a ray.
double winding(const std::string& path) {
    const Mesh mesh = mesh_of(path);
    double degrees = 0;
    for (int layer = layers; layer > 0; --layer) {
        const double *from = &mesh.x[2 * layer * around], *to = &mesh.x[2 * (layer - 1) * around];
        const double turned = std::atan2(to[1], to[0]) - std::atan2(from[1], from[0]);
        degrees += std::remainder(turned, 2 * std::numbers::pi) * 180 / std::numbers::pi;
    }
    return degrees;
}

}  // namespace

TEST_CASE("half a turn winds the whole mesh one way, in two parts") {
    const RingDeck ring(ring_mesh(around, layers, 20));
    for (const char* objective : {"objective=squared", "objective=deviation"})
        for (const char* refine : {"refine=0", "refine=2"}) {
            const Outcome outcome = ring.run({"boundary inner=rotate 180", objective, refine, "start=identity"});
            CHECK(outcome.code == 0);
            CHECK(value(ring, "status") == "converged");
            CHECK(count(ring, "earlier_newton_iterations") > 0);
            CHECK(count(ring, "newton_iterations") + count(ring, "earlier_newton_iterations") <= 70);
            CHECK(has(outcome.out, "  0.5 of the motion\n"));
            CHECK(has(outcome.out, " more in earlier load increments) in "));
            const auto rows = csv_rows(text_of(ring.output + "/history.csv"));
            CHECK(rows[1][0] == "part");
            CHECK(rows[0][28] == "fraction");
            CHECK(rows[1][28] == "0.5");
            CHECK(rows[2][28] == "");
            CHECK(std::abs(winding(ring.output + "/final.msh")) == doctest::Approx(180));
        }
}

TEST_CASE("turns of up to 90 degrees are made at once, larger ones by the shorter way, or as they are written") {
    const RingDeck ring(ring_mesh(around, layers, 20));
    const auto winding_after = [&](const std::string& motion, const std::string& continuation) {
        REQUIRE(ring.run({"boundary inner=" + motion, "continuation=" + continuation}).code == 0);
        return winding(ring.output + "/final.msh");
    };
    CHECK(winding_after("rotate 90", "auto") == doctest::Approx(90));
    CHECK(count(ring, "earlier_newton_iterations") == 0);
    CHECK(winding_after("rotate 270", "auto") == doctest::Approx(-90));
    CHECK(count(ring, "earlier_newton_iterations") == 0);
    CHECK(winding_after("rotate 150", "never") == doctest::Approx(150));
    CHECK(count(ring, "earlier_newton_iterations") == 0);
    CHECK(winding_after("rotate 270", "always") == doctest::Approx(270));
    CHECK(winding_after("rotate -270", "always") == doctest::Approx(-270));
    CHECK(winding_after("rotate 360", "always") == doctest::Approx(360));
    CHECK(winding_after("rotate 360", "auto") == doctest::Approx(0));
    winding_after("translate 3 1", "always");
    CHECK(count(ring, "earlier_newton_iterations") == 0);
}

TEST_CASE("both boundaries turn, in another unit and far from the origin, curved") {
    const RingDeck ring(ring_mesh(around, layers, 20));
    REQUIRE(ring.run({"boundary inner=rotate 170 about 0 0; translate 2 0", "degree=2"}).code == 0);
    const double distortion = number(summary_of(ring.output), "max_distortion");
    Mesh moved = ring_mesh(around, layers, 20);
    for (std::size_t i = 0; i < moved.x.size(); ++i) moved.x[i] = 1e-3 * moved.x[i] + (i % 2 ? -5 : 7);
    const RingDeck other(moved);
    REQUIRE(other.run({"boundary inner=rotate 170 about 7 -5; translate 0.002 0", "degree=2"}).code == 0);
    CHECK(number(summary_of(other.output), "max_distortion") == doctest::Approx(distortion).epsilon(1e-3));
    CHECK(count(other, "newton_iterations") == count(ring, "newton_iterations"));
}

TEST_CASE("the schedules of the paper do not follow, unless they are told to") {
    const RingDeck ring(ring_mesh(around, layers, 20));
    ring.run({"boundary inner=rotate 130", "algorithm=paper"});
    CHECK(count(ring, "earlier_newton_iterations") == 0);
    CHECK(ring.run({"boundary inner=rotate 180", "algorithm=paper", "continuation=always"}).code == 0);
    CHECK(count(ring, "earlier_newton_iterations") > 0);
}

TEST_CASE("a motion that fails at once is followed in halves, and one out of reach stalls") {
    const RingDeck ring(ring_mesh(around, layers, 20));
    // Three steps are too few for the whole way.
    const Outcome outcome = ring.run({"boundary inner=translate 6 0", "max_newton_iterations=3"});
    CHECK(count(ring, "earlier_newton_iterations") > 0);
    CHECK(outcome.code == 0);
    const RingDeck thin(ring_mesh(32, 2, 3));
    CHECK(thin.run({"boundary inner=rotate 90", "boundary outer=rotate -90", "objective=squared"}).code == 3);
    CHECK(value(thin, "status") == "stalled");
    CHECK(count(thin, "earlier_newton_iterations") > 0);
}

// By formulas, the way to the target is straight: half of it collapses the bar onto its axis.
TEST_CASE("a twist that jams at once, and a valid target: in increments, or from the target") {
    const TemporaryFolder folder;
    folder.write("bar.msh", msh_of(cube_mesh(1, 10)));
    const std::string turned = "(0.9*(x - 5))";
    const std::string formulas = "expression \"x\" \"(y-0.5)*cos" + turned + "-(z-0.5)*sin" + turned +
                                 "\" \"(y-0.5)*sin" + turned + "+(z-0.5)*cos" + turned + "\"";
    for (const std::string& motion : {formulas, std::string("twist 54 axis 1 0 0 about 5 0.5 0.5")}) {
        const std::string deck = folder.write("bar.deck", "mesh = bar.msh\noutput = " + folder.path("out") +
                                                              "\nboundary all = " + motion + "\n");
        CHECK(almesh_with({deck, "continuation=never"}).code == 3);
        CHECK(summary_of(folder.path("out")).at("status") == "stalled");
        CHECK(almesh_with({deck}).code == 0);
        CHECK(summary_of(folder.path("out")).at("earlier_newton_iterations") != "0");
    }
}

TEST_CASE("where boundaries with common nodes agree on the whole motion only, it is made at once") {
    for (const char* setting : {"continuation=auto", "continuation=always"}) {
        const TemporaryFolder folder;
        folder.write("cube.msh", msh_of(cube_mesh(2)));
        const std::string about = " axis 0 0 1 about 0.5 0.5 0.5\n";
        const std::string path = folder.write("cube.deck", "mesh = cube.msh\noutput = " + folder.path("out") +
                                                               "\nboundary bottom = rotate 180" + about +
                                                               "boundary top = rotate -180" + about +
                                                               "boundary sides = rotate 180" + about);
        const Outcome outcome = almesh_with({path, setting});
        CHECK(outcome.error.empty());
        CHECK(outcome.code == 0);
        CHECK(summary_of(folder.path("out")).at("earlier_newton_iterations") == "0");
    }
}

TEST_CASE("what cannot be followed is tried at once at last, with all the steps it may take") {
    const RingDeck ring(ring_mesh(16, 2, 2));  // two layers: they cannot be turned that far
    CHECK(ring.run({"boundary inner=rotate 170"}).code == 3);
    CHECK(count(ring, "earlier_newton_iterations") > 0);
    const auto summary = summary_of(ring.output);
    CHECK(number(summary, "constraint_norm") > 0.01);
    CHECK(number(summary, "relative_boundary_error") > 0.01);
    CHECK(summary.at("certified_valid") == "yes");
}

TEST_CASE("a turn beyond half of one that cannot be followed is not made the shorter way instead") {
    const RingDeck ring(ring_mesh(12, 2, 1.5));  // two layers: 30 degrees of winding are much
    const Outcome outcome = ring.run({"boundary inner=rotate 720", "continuation=always", "weight_exponent=1"});
    CHECK(outcome.code == 3);
    CHECK(value(ring, "status") != "converged");
    CHECK(std::stod(value(ring, "max_distortion")) > 2);  // it is not the mesh as it was
}

TEST_CASE("an interrupted part reports how far the boundary is from the target of the whole motion") {
    Minimisation problem(ring_mesh(around, layers, 20), {{"inner", "rotate 180"}}, Objective::deviation);
    Level& level = problem.level;
    level.turn = 360;  // four parts
    level.constraint_at = [&level](double fraction) {
        const std::string part = "rotate " + std::to_string(180 * fraction);
        return std::make_unique<Dirichlet>(level.mesh, level.ideal, target_of(level.mesh, {{"inner", part}}),
                                           TargetKind::least_squares);
    };
    Newton newton(level.energy->hessian_pattern(), {});
    std::vector<double> x = level.ideal;
    const AlResult result =
        minimise_in_increments(level, newton, {}, x, {}, {}, [](const Stage&) { interrupt_flag = 1; });
    clear_interrupt();
    CHECK(result.status == Status::interrupted);
    CHECK(result.earlier_newton_iterations > 0);
    CHECK(result.iterations.back().projected_constraint_norm == level.constraint->projected_norm(x));
    CHECK(result.iterations.back().projected_constraint_norm > 0.1);
}

TEST_CASE("a minimisation that does not end takes 100 steps, and a part of a motion is halved down to 1/32") {
    const std::unique_ptr<Level> level = endless_level();
    Newton newton(level->energy->hessian_pattern(), {});
    MethodParams params;
    params.schedule.max_newton_iterations = 250;
    std::vector<double> x = level->ideal, fractions;
    const AlResult result = minimise_in_increments(*level, newton, params, x, {}, {}, [&](const Stage& part) {
        fractions.push_back(part.fraction);
        CHECK(part.status == Status::max_newton_iterations);
        CHECK(part.newton_iterations == 100);
    });
    CHECK(fractions == std::vector<double>{0.5, 0.25, 0.125, 0.0625, 0.03125});
    CHECK(result.earlier_newton_iterations == 818);  // the motion at once, and from three meshes with the boundary set
    CHECK(result.status == Status::max_newton_iterations);
    CHECK(result.newton_iterations == 250);  // the last resort
}

TEST_CASE("parts of a motion are followed for 500 steps") {
    const std::unique_ptr<Level> level = endless_level();
    level->turn = 360;  // four parts, tried first
    Newton newton(level->energy->hessian_pattern(), {});
    MethodParams params;
    params.schedule.max_newton_iterations = 70;
    std::vector<double> x = level->ideal;
    int steps = 0, parts = 0;
    minimise_in_increments(*level, newton, params, x, {}, {}, [&](const Stage& part) {
        steps += part.newton_iterations;
        ++parts;
    });
    CHECK(parts == 4);  // 1/4, 1/8, 1/16, 1/32
    CHECK(steps == 280);
}

TEST_CASE("a solution that is only a start is solved to a thousandth of the motion, and its gradient to 3 %") {
    for (const double unit : {1.0, 100.0}) {
        Mesh mesh = ring_mesh(around, layers, 6);
        for (double& v : mesh.x) v *= unit;
        const std::string motion = "translate " + std::to_string(unit) + " 0";
        const Minimisation problem(mesh, {{"inner", motion}}, Objective::deviation);
        const double whole = problem.constraint.projected_norm(problem.ideal);
        Newton newton(problem.distortion.hessian_pattern(), {});
        std::vector<double> x = problem.ideal;
        const AlStart weak = {.lambda = {}, .mu = 0.1};  // each subproblem leaves much of the constraint
        const AlResult result =
            minimise(problem.distortion, problem.constraint, newton, loosened({}, problem.level), x, {}, weak);
        CHECK(loosened({}, problem.level).omega_star == doctest::Approx(0.03 * whole));  // as |grad E| scales in 2D
        REQUIRE(result.status == Status::converged);
        const auto& rows = result.iterations;
        REQUIRE(rows.size() > 3);
        CHECK(rows.back().projected_constraint_norm <= 1e-3 * whole);
        CHECK(rows.back().projected_constraint_norm > 1e-5 * whole);
        CHECK(rows.back().gradient_norm <= 0.03 * whole);
        CHECK(rows[rows.size() - 2].projected_constraint_norm > 1e-3 * whole);
    }
}
