#include "method/comparators.hpp"

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

const std::vector<std::string> comparators = {"penalty",     "elasticity", "harmonic",
                                              "incremental", "untangle",   "fixed_boundary"};

std::string method(const std::string& name) { return "method=" + name; }

struct Run {
    int code;
    std::string out, error;
    std::map<std::string, std::string> summary;

    Run(const RingDeck& ring, const std::vector<std::string>& settings) {
        const Outcome outcome = ring.run(settings);
        code = outcome.code;
        out = outcome.out;
        error = outcome.error;
        if (error.empty()) summary = summary_of(ring.output);
    }
    const std::string& operator[](const std::string& quantity) const { return summary.at(quantity); }
    double number(const std::string& quantity) const { return test::number(summary, quantity); }
};

// Largest distance of a node of the moved inner circle from its place.
double inner_error(const RingDeck& ring, const Mesh& ideal, double dx) {
    std::vector<std::string> notes;
    const Mesh moved = build_mesh(read_mesh(ring.output + "/final.msh"), notes, Folds::keep);
    double largest = 0;
    for (int i = 0; i < ideal.nodes(); ++i)
        if (std::hypot(ideal.x[2 * i], ideal.x[2 * i + 1]) < 1 + 1e-9)
            largest = std::max(largest, std::hypot(moved.x[2 * i] - ideal.x[2 * i] - dx,
                                                   moved.x[2 * i + 1] - ideal.x[2 * i + 1]));
    return largest;
}

}  // namespace

TEST_CASE("every comparator makes a small motion: converged, certified, the boundary in place") {
    const Mesh flat = ring_mesh(12, 3, 6);
    for (const std::string motion : {"translate 0.5 0.2", "rotate 10 about 0 0"})
        for (const char* degree : {"degree=1", "degree=3"}) {
            const RingDeck ring(flat);
            const std::string inner = "boundary inner=" + motion;
            const Run reference(ring, {inner, degree});
            CHECK(reference.code == 0);
            for (const std::string& name : comparators) {
                CAPTURE(name);
                const Run run(ring, {inner, degree, method(name)});
                CHECK(run.code == 0);
                CHECK(run["status"] == "converged");
                CHECK(run["certified_injective"] == "yes");
                CHECK(run["nodes_off_target"] == "0");
                CHECK(run["invalid_elements"] == "0");
                CHECK(run.number("newton_iterations") > 0);
                CHECK(run.number("size_skew_min") > 0);
                const bool extends = name == "elasticity" || name == "harmonic";  // the distortion is not minimised
                CHECK((run.number("gradient_norm") > 1e-3) == extends);
                if (!extends)
                    CHECK(std::abs(run.number("max_distortion") - reference.number("max_distortion")) < 1e-6);
            }
        }
}

TEST_CASE("every comparator in three dimensions, and curved onto circles") {
    const TemporaryFolder folder;
    folder.write("cube.msh", msh_of(cube_mesh(3)));
    const std::string cube = folder.write("cube.deck", "mesh = cube.msh\nboundary top = translate 0.1 0 0.1\n"
                                                       "boundary bottom = fixed\nboundary sides = expression "
                                                       "\"x + 0.1*z\" \"y\" \"z + 0.1*z\"\noutput = " +
                                                           folder.path("o"));
    const RingDeck ring(ring_mesh(12, 3, 6));
    for (const std::string& name : comparators)
        for (const char* degree : {"degree=1", "degree=2"}) {
            CAPTURE(name);
            CHECK(almesh_with({cube, method(name), degree}).code == 0);
            CHECK(summary_of(folder.path("o")).at("certified_injective") == "yes");
            const Run curved(ring,
                             {"boundary inner=circle 0 0 1", "boundary outer=circle 0 0 6", method(name), degree});
            CHECK(curved.code == 0);
            CHECK(curved.number("projected_constraint_norm") < 1e-8);
        }
}

TEST_CASE("extensions of a large motion end as inverted: code 3, how many, and the mesh that they came to") {
    const Mesh mesh = ring_mesh(24, 6, 12);
    const RingDeck ring(mesh);
    for (const char* name : {"elasticity", "harmonic"}) {
        CAPTURE(name);
        const Run run(ring, {"boundary inner=translate 9 0", method(name)});
        CHECK(run.code == 3);
        CHECK(run["status"] == "inverted");
        CHECK(run["certified_valid"] == "no");
        CHECK(run.number("invalid_elements") > 0);
        CHECK(run["max_distortion"] == "inf");
        CHECK(run["relative_quality"] == "0");
        CHECK(run["size_skew_min"] == "0");
        CHECK(run["diagnosis"] == "invalid");
        CHECK(run["newton_iterations"] == "1");
        CHECK(run["nodes_off_target"] == "0");
        CHECK(has(run.out, "inverted: the method leaves elements that are not valid: 1 linear solve in "));
        CHECK(has(run.out, "try method = augmented_lagrangian"));
        CHECK(inner_error(ring, mesh, 9) < 1e-12);
    }
}

TEST_CASE("increments: more of them reach farther, and the run ends at the part that inverts an element") {
    const RingDeck ring(ring_mesh(24, 6, 12));
    const std::string inner = "boundary inner=translate 7 0";
    CHECK(Run(ring, {inner, "method=elasticity"})["status"] == "inverted");
    const Run ten(ring, {inner, "method=elasticity", "increments=10"});
    CHECK(ten.code == 0);
    CHECK(ten["newton_iterations"] == "1");
    CHECK(ten["earlier_newton_iterations"] == "9");
    const Run harmonic(ring, {"boundary inner=translate 9.5 0", "method=harmonic", "increments=10"});
    CHECK(harmonic["status"] == "inverted");
    const auto rows = csv_rows(text_of(ring.output + "/history.csv"));
    REQUIRE(rows.size() >= 4);
    CHECK(rows[2][0] == "part");
    CHECK(rows[2][28] == "0.1");
    CHECK(rows.back()[0] == "al");
    CHECK(harmonic.number("earlier_newton_iterations") < 9);
    CHECK(harmonic.number("nodes_off_target") > 0);
    CHECK(has(harmonic.out, "a smaller motion (0."));
}

TEST_CASE("fixed_boundary: no valid start is told, with the mesh that has the fewest inverted elements") {
    const Mesh mesh = ring_mesh(24, 6, 12);
    const RingDeck ring(mesh);
    const Run run(ring, {"boundary inner=translate 9 0", "method=fixed_boundary"});
    CHECK(run.code == 3);
    CHECK(run["status"] == "invalid_start");
    CHECK(run["newton_iterations"] == "2");
    CHECK(inner_error(ring, mesh, 9) < 1e-12);
    const double inverted = run.number("invalid_elements");
    CHECK(inverted > 0);
    for (const char* name : {"elasticity", "harmonic"})
        CHECK(inverted <= Run(ring, {"boundary inner=translate 9 0", method(name)}).number("invalid_elements"));
    CHECK(has(run.out, "with the boundary set, no valid mesh to start from"));
}

TEST_CASE("incremental halves a part without a valid start, and comes to the minimum of the others") {
    const RingDeck ring(ring_mesh(24, 6, 12));
    const std::string inner = "boundary inner=translate 9 0";
    const Run reference(ring, {inner}), run(ring, {inner, "method=incremental", "increments=1"});
    CHECK(run.code == 0);
    const auto rows = csv_rows(text_of(ring.output + "/history.csv"));
    CHECK(rows[2][0] == "part");
    CHECK(std::stod(rows[2][28]) < 1);
    CHECK(run.number("max_distortion") == doctest::Approx(reference.number("max_distortion")).epsilon(1e-6));
    const Run untangled(ring, {inner, "method=untangle"});
    CHECK(untangled.code == 0);
    CHECK(untangled.number("max_distortion") == doctest::Approx(reference.number("max_distortion")).epsilon(1e-6));
}

TEST_CASE("a motion that no valid mesh follows: every comparator fails truthfully") {
    const RingDeck ring(ring_mesh(8, 2, 3));
    const std::string inner = "boundary inner=rotate 170 about 0 0";
    const std::map<std::string, std::vector<std::string>> endings = {
        {"elasticity", {"inverted"}}, {"harmonic", {"inverted"}}, {"fixed_boundary", {"invalid_start"}},
        {"incremental", {"invalid_start", "line_search_failed", "attainable_accuracy"}},
        {"untangle", {"inverted"}}, {"penalty", {"stalled"}}};
    for (const std::string& name : comparators) {
        CAPTURE(name);
        const Run run(ring, {inner, "continuation=always", method(name)});
        const std::vector<std::string>& may = endings.at(name);
        CAPTURE(run["status"]);
        CHECK(run.code == 3);
        CHECK(std::find(may.begin(), may.end(), run["status"]) != may.end());
        const bool valid = name == "incremental" || name == "penalty";  // the last valid mesh on the way
        CHECK(run["certified_valid"] == (valid ? "yes" : "no"));
        CHECK((run["nodes_off_target"] == "0") == !valid);
    }
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

TEST_CASE("the same files of every comparator for any number of threads") {
    const RingDeck ring(ring_mesh(24, 6, 12), "");
    for (const std::string& name : comparators) {
        CAPTURE(name);
        const auto results = for_threads([&] {
            const Outcome outcome = ring.run({"boundary inner=translate 7 1", method(name), "refine=1"});
            return std::tuple(outcome.code, text_of(ring.output + "/final.msh"), history_without_times(ring.output));
        });
        CHECK(results[1] == results[0]);
        CHECK(results[2] == results[0]);
    }
}

TEST_CASE("keys that do not go with a method are refused, naming their place") {
    const RingDeck ring;
    const auto error = [&](const std::vector<std::string>& settings) {
        const Outcome outcome = ring.run(settings);
        CHECK(outcome.code == 1);
        return outcome.error;
    };
    CHECK(has(error({"increments=3"}), "command line: increments does not go with this method"));
    CHECK(has(error({"increments=3", "method=untangle"}), "increments does not go with this method"));
    CHECK(has(error({"objective=minimax", "method=penalty"}), "objective = minimax does not go with this method"));
    CHECK(has(error({"start=coarse", "method=harmonic"}), "start = coarse does not go with this method"));
    CHECK(has(error({"delta=0.1", "method=untangle"}), "delta > 0 does not go with this method"));
    CHECK(has(error({"boundary inner=slide", "method=elasticity"}), "some boundary slides or is free"));
    CHECK(has(error({"method=elastic"}), "did you mean `elasticity`?"));
    CHECK(ring.run({"boundary inner=rotate 5 about 0 0; slide", "method=penalty"}).code == 0);
}

TEST_CASE("an interrupt ends a comparator after the part at hand") {
    const RingDeck ring;
    for (const char* name : {"elasticity", "incremental", "untangle"}) {
        interrupt_flag = 1;
        const Outcome outcome = ring.run({method(name)});
        clear_interrupt();
        CHECK(outcome.code == 3);
        CHECK(summary_of(ring.output).at("status") == "interrupted");
    }
}

TEST_CASE("untangling: from the largest regularisation that is needed to the least, in parts, each with its steps") {
    const RingDeck ring(ring_mesh(24, 6, 10));
    for (const std::vector<std::string>& settings : std::vector<std::vector<std::string>>{
             {"boundary inner=translate 8 0", "degree=1", method("untangle")},
             {"boundary inner=rotate 120", "degree=2", method("untangle")},
             {"boundary inner=rotate 180", "degree=2", method("untangle")}}) {
        CAPTURE(settings[0]);
        const Run run(ring, settings);
        CHECK(run.code == 0);
        CHECK(run["status"] == "converged");
        CHECK(run.number("newton_iterations") <= 80);
    }
}

TEST_CASE("increments before the last are minimised to 3 %, in two or three steps each") {
    const RingDeck ring(ring_mesh(24, 6, 10));
    const Run run(ring, {"boundary inner=rotate 120", method("incremental"), "increments=5"});
    CHECK(run.code == 0);
    auto rows = csv_rows(text_of(ring.output + "/history.csv"));
    std::erase_if(rows, [](const auto& row) { return row[0] != "part"; });
    CHECK(rows.size() == 4);
    CHECK(run.number("earlier_newton_iterations") >= 10);
    CHECK(run.number("earlier_newton_iterations") <= 13);
}
