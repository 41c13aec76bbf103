#include "app/terminal.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <string>

#include "method/continuation.hpp"
#include "support/rows.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

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

NewtonStep newton_step() {
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

TEST_CASE("a coarser mesh has a row with its nodes, and says where it was not used") {
    std::FILE* file = std::tmpfile();
    REQUIRE(file);
    Terminal terminal(file, 2, 1);
    CoarseStage stage{841, AlStatus::converged, row_after(2), 9};
    terminal.row(stage);
    stage.status = AlStatus::infeasible;
    terminal.row(stage);
    const auto lines = pieces(contents(file), '\n');
    REQUIRE(lines.size() == 2);
    CHECK(lines[0] ==
          "  2  5.000e-01   3.00e-03  1.000000          1  3.20e+02  coarse          9     1.25s  841 nodes");
    CHECK(lines[1] == lines[0] + ", not used");
    std::fclose(file);
}

TEST_CASE("redirected output is plain rows below a header, without live lines or control characters") {
    std::FILE* file = std::tmpfile();
    REQUIRE(file);
    Terminal terminal(file, 2, 1);
    terminal.header();
    terminal.row(initial_row());
    terminal.live(1, newton_step());
    terminal.row(row_after(1));
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
    Terminal terminal(file, 3, 10);
    terminal.row(row_after(1));
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
    Terminal terminal(file, 2, 1);
    terminal.live(3, newton_step());
    terminal.row(row_after(3));
    std::fflush(file);
    std::string text;
    while (text.find('\n') == std::string::npos) {  // each flush may arrive on its own
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
    CHECK(text.find('\n') > live);
}
