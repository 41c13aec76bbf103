#include "report/iteration_table.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <map>

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
    row.newton_status = Status::attainable_accuracy;
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

// A report whose table nobody reads.
struct History : IterationTable {
    History(int dim, double length) : IterationTable(nowhere(), {dim, length}, "id") {}
    static std::FILE* nowhere() {
        static std::FILE* const file = std::fopen("/dev/null", "w");
        return file;
    }
};

// Column name -> cell of the last row.
std::map<std::string, std::string> last_row(const IterationTable& report) {
    const auto rows = csv_rows(report.csv());
    REQUIRE(rows.back().size() == rows[0].size());
    std::map<std::string, std::string> cells;
    for (std::size_t k = 0; k < rows[0].size(); ++k) cells[rows[0][k]] = rows.back()[k];
    return cells;
}

AlIteration initial_row() {
    AlIteration row;
    row.constraint_norm = 7.155;
    row.relative_quality = 1;
    row.max_distortion = 1;
    return row;
}

AlIteration row_after(int iteration) {
    AlIteration row = initial_row();
    row.iteration = iteration;
    row.constraint_norm = 0.5;
    row.gradient_norm = 3e-3;
    row.mu = 320;
    row.newton_iterations = 7;
    row.update = AlUpdate::multipliers;
    row.seconds = 1.25;
    return row;
}

NewtonStep live_step() {
    NewtonStep step;
    step.iteration = 4;
    step.gradient_norm = 2e-3;
    step.step_length = 0.5;
    return step;
}

std::string contents(std::FILE* file) {
    std::fflush(file);
    std::rewind(file);
    std::string text;
    for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
    return text;
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
        CHECK(cells["newton_status"] == "attainable_accuracy");
        CHECK(cells["update"] == "lambda+mu");
        CHECK(cells["seconds"] == "1.5");
        for (const char* name : {"newton_iteration", "step_length", "cuts_inverted", "cut_reason", "hessian", "solver"})
            CHECK(cells[name].empty());
    }
}

TEST_CASE("a coarser mesh gives one row: its last iteration, all its Newton steps, its nodes") {
    History history(2, 2);
    Stage stage{841, Status::converged, al_row(), 9};
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
    stage.status = Status::stalled;
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
    for (const auto& row : rows) CHECK(row.size() == 33);
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

TEST_CASE("a coarser mesh has a row with its nodes, and says where it was not used") {
    std::FILE* file = std::tmpfile();
    REQUIRE(file);
    IterationTable report(file, {2, 1}, "id");
    Stage stage{841, Status::converged, row_after(2), 9};
    report.add(stage);
    stage.status = Status::stalled;
    report.add(stage);
    const auto lines = pieces(contents(file), '\n');
    REQUIRE(lines.size() == 3);  // below the header
    CHECK(lines[1] ==
          "  2  5.000e-01   3.00e-03  1.000000          1  3.20e+02  coarse          9     1.25s  841 nodes");
    CHECK(lines[2] == lines[1] + ", not used");
    std::fclose(file);
}

TEST_CASE("redirected output is plain rows below a header, without live lines or control characters") {
    std::FILE* file = std::tmpfile();
    REQUIRE(file);
    IterationTable report(file, {2, 1}, "id");
    report.add(initial_row());
    report.add(1, live_step());
    report.add(row_after(1));
    const std::string text = contents(file);
    std::fclose(file);
    CHECK(text.find_first_of("\r\033") == std::string::npos);
    const auto lines = pieces(text, '\n');
    REQUIRE(lines.size() == 3);
    for (const std::string& line : lines) CHECK(line.size() == lines[0].size());
    for (const char* column : {"AL", "|c_D|", "|grad E|", "max eta", "mu", "update", "Newton", "time"})
        CHECK(lines[0].find(column) != std::string::npos);
    CHECK(lines[1].find("7.155e+00") != std::string::npos);
    for (const char* cell : {"  1 ", "5.000e-01", "3.00e-03", "3.20e+02", "lambda", " 7 ", "1.25s"})
        CHECK(lines[2].find(cell) != std::string::npos);
}

TEST_CASE("norms are printed in the mesh's units") {
    std::FILE* file = std::tmpfile();
    REQUIRE(file);
    IterationTable report(file, {3, 10}, "id");
    report.add(row_after(1));
    const std::string text = contents(file);
    std::fclose(file);
    CHECK(text.find("5.000e+00") != std::string::npos);  // a length
    CHECK(text.find("3.00e-01") != std::string::npos);   // an area
    CHECK(text.find("3.20e+03") != std::string::npos);   // an energy over a squared length
}

TEST_CASE("on a terminal one line follows the Newton steps and gives way to the row") {
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) {
        MESSAGE("no pseudo-terminal here: not tested");
        return;
    }
    std::FILE* file = std::fopen(ptsname(master), "w");
    REQUIRE(file);
    IterationTable report(file, {2, 1}, "id");
    report.add(3, live_step());
    report.add(row_after(3));
    std::fflush(file);
    std::string text;
    while (std::count(text.begin(), text.end(), '\n') < 2) {  // each flush may arrive on its own
        char buffer[4096];
        const auto count = read(master, buffer, sizeof buffer);
        REQUIRE(count > 0);
        text.append(buffer, static_cast<std::size_t>(count));
    }
    std::fclose(file);
    close(master);
    const auto live = text.find("Newton 4"), row = text.find("5.000e-01");
    REQUIRE(live != std::string::npos);
    REQUIRE(row != std::string::npos);
    CHECK(text.find("2.00e-03") < row);
    CHECK(text.find('\r', live) < row);  // the row starts on the live line, cleared
    CHECK(text.find('\n', live) > row);
}
