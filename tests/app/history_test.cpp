#include "app/history.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "base/text.hpp"
#include "method/continuation.hpp"
#include "support/rows.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

AlIteration al_row() {
    AlIteration row;
    row.iteration = 3;
    row.constraint_norm = 0.5;
    row.projected_constraint_norm = 0.25;
    row.energy = 7;
    row.gradient_norm = 3;
    row.mu = 300;
    row.omega = 0.01;
    row.epsilon = 0.001;
    row.relative_quality = 0.9365;
    row.max_distortion = 2.75;
    row.newton_iterations = 4;
    row.newton_status = NewtonStatus::rounding_floor;
    row.update = AlUpdate::both;
    row.seconds = 1.5;
    return row;
}

NewtonStep newton_row() {
    NewtonStep step;
    step.iteration = 2;
    step.energy = 7;
    step.gradient_norm = 3;
    step.step_length = 0.25;
    step.local = {40, 3};
    step.cuts_inverted = 2;
    step.hessian = HessianKind::full;
    step.linear_iterations = 17;
    step.solver = SolverKind::gmres;
    step.ilu_shift = 0.01;
    return step;
}

// Column name -> cell of the last row.
std::map<std::string, std::string> last_row(const History& history) {
    const auto rows = csv_rows(history.csv());
    REQUIRE(rows.back().size() == rows[0].size());
    std::map<std::string, std::string> cells;
    for (std::size_t k = 0; k < rows[0].size(); ++k) cells[rows[0][k]] = rows.back()[k];
    return cells;
}

}  // namespace

TEST_CASE("an augmented Lagrangian row, in the mesh's units") {
    for (int dim : {2, 3}) {
        History history(dim, 2);  // the run's unit is two of the mesh's
        history.add(al_row());
        auto cells = last_row(history);
        const double energy = dim == 2 ? 4 : 8;
        CHECK(cells["kind"] == "al");
        CHECK(cells["al_iteration"] == "3");
        CHECK(cells["energy"] == to_text(7 * energy));
        CHECK(cells["gradient_norm"] == to_text(3 * energy / 2));
        CHECK(cells["constraint_norm"] == "1");
        CHECK(cells["projected_constraint_norm"] == "0.5");
        CHECK(cells["mu"] == to_text(300 * energy / 4));
        CHECK(cells["omega"] == to_text(0.01 * energy / 2));
        CHECK(cells["epsilon"] == "0.004");
        CHECK(cells["relative_quality"] == "0.9365");
        CHECK(cells["max_distortion"] == "2.75");
        CHECK(cells["newton_iterations"] == "4");
        CHECK(cells["newton_status"] == "rounding_floor");
        CHECK(cells["update"] == "lambda+mu");
        CHECK(cells["seconds"] == "1.5");
        for (const char* name : {"newton_iteration", "step_length", "cuts_inverted", "cut_reason", "hessian", "solver"})
            CHECK(cells[name].empty());
    }
}

TEST_CASE("a coarser mesh gives one row: its last iteration, all its Newton steps, its nodes") {
    History history(2, 2);
    CoarseStage stage{841, AlStatus::converged, al_row(), 9};
    history.add(stage);
    auto cells = last_row(history);
    CHECK(cells["kind"] == "coarse");
    CHECK(cells["al_iteration"] == "3");
    CHECK(cells["constraint_norm"] == "1");
    CHECK(cells["mu"] == "300");
    CHECK(cells["newton_iterations"] == "9");
    CHECK(cells["update"] == "finer mesh");
    CHECK(cells["nodes"] == "841");
    CHECK(cells["seconds"] == "1.5");
    CHECK(history.newton_steps() == 0);  // they count those on the deck's own mesh
    stage.status = AlStatus::infeasible;
    history.add(stage);
    CHECK(last_row(history)["update"] == "dropped");
}

TEST_CASE("a Newton row, in the mesh's units, says why its step was cut") {
    History history(3, 2);
    NewtonStep step = newton_row();
    history.add(5, step);
    auto cells = last_row(history);
    CHECK(cells["kind"] == "newton");
    CHECK(cells["al_iteration"] == "5");
    CHECK(cells["newton_iteration"] == "2");
    CHECK(cells["energy"] == "56");
    CHECK(cells["gradient_norm"] == "12");
    CHECK(cells["step_length"] == "0.25");
    CHECK(cells["local_nodes"] == "40");
    CHECK(cells["ilu_shift"] == "0.01");
    CHECK(cells["local_steps"] == "3");
    CHECK(cells["cuts_inverted"] == "2");
    CHECK(cells["cuts_decrease"] == "0");
    CHECK(cells["cut_reason"] == "inverted element");
    CHECK(cells["hessian"] == "full");
    CHECK(cells["solver"] == "gmres");
    CHECK(cells["linear_iterations"] == "17");
    for (const char* name : {"constraint_norm", "mu", "relative_quality", "newton_status", "update", "seconds"})
        CHECK(cells[name].empty());

    step.cuts_decrease = 1;
    history.add(5, step);
    CHECK(last_row(history)["cut_reason"] == "inverted element; insufficient decrease");
    step.cuts_inverted = 0;
    history.add(5, step);
    CHECK(last_row(history)["cut_reason"] == "insufficient decrease");
    step.cuts_decrease = 0;
    history.add(5, step);
    CHECK(last_row(history)["cut_reason"] == "none");
}

TEST_CASE("rows stand in the order they were added, below one header, all of its length") {
    History history(2, 1);
    CHECK(csv_rows(history.csv()).size() == 1);
    history.add(AlIteration{});
    history.add(1, newton_row());
    history.add(1, newton_row());
    history.add(al_row());
    const auto rows = csv_rows(history.csv());
    REQUIRE(rows.size() == 5);
    for (const auto& row : rows) CHECK(row.size() == 28);
    CHECK(rows[1][0] == "al");
    CHECK(rows[2][0] == "newton");
    CHECK(rows[3][0] == "newton");
    CHECK(rows[4][0] == "al");
    CHECK(history.csv().ends_with('\n'));
}

TEST_CASE("numbers keep all their digits") {
    History history(2, 1);
    AlIteration row = al_row();
    row.constraint_norm = 0.1 + 0.2;
    history.add(row);
    CHECK(*parse_double(last_row(history)["constraint_norm"]) == 0.1 + 0.2);
}
