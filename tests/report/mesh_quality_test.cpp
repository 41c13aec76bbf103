// The quality of elements before and after, as a table and as quality.csv.
#include "report/mesh_quality.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "check/quality.hpp"
#include "check/scaled_jacobian.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Two right triangles of a square; before, a vertex of one alone is pushed through the middle of the opposite side.
struct Pushed {
    Mesh mesh = square_mesh(1);
    std::vector<double> before = mesh.x;
    Pushed() {
        int i = 0;
        while (std::count(mesh.elements.begin(), mesh.elements.end(), i) > 1) ++i;
        for (double* x : {&before[2 * i], &before[2 * i + 1]}) *x += 1.5 * (0.5 - *x);
    }
};

std::vector<std::vector<double>> rows_of(const std::string& csv) {
    std::vector<std::vector<double>> rows;
    for (const std::string& line : pieces(csv, '\n')) {
        if (line.empty() || line.starts_with("low")) continue;
        rows.emplace_back();
        for (const std::string& cell : pieces(line, ',')) rows.back().push_back(parse_double(cell).value());
    }
    return rows;
}

}  // namespace

TEST_CASE("quality.csv counts every element once in each column, those that are not positive in its first row") {
    const Pushed pushed;
    const QualityChange change = quality_change(pushed.mesh, pushed.before, pushed.mesh.x);
    const std::string csv = quality_csv(change);
    CHECK(csv.starts_with("low,high,scaled_jacobian_before,scaled_jacobian_after,quality_before,quality_after\n"));
    const auto rows = rows_of(csv);
    REQUIRE(rows.size() == 21);
    for (std::size_t column = 2; column < 6; ++column) {
        double sum = 0;
        for (const auto& row : rows) sum += row[column];
        CHECK(sum == 2);
    }
    for (std::size_t k = 1; k < rows.size(); ++k) CHECK(rows[k][0] == rows[k - 1][1]);
    CHECK(rows[0][1] == 0);
    CHECK(rows.back()[1] == 1);
    CHECK(std::vector<double>(rows[0].begin() + 2, rows[0].end()) == std::vector<double>{1, 0, 1, 0});
    // Right triangles: sin 45 / sin 60 degrees, and sqrt(3) / 2.
    CHECK(rows[1 + 16][3] == 2);
    CHECK(rows[1 + 17][5] == 2);
}

TEST_CASE("quality with before= and improve print the same table of the same two meshes") {
    const TemporaryFolder folder;
    const Pushed pushed;
    Mesh mesh = pushed.mesh;
    const std::string after = folder.write("after.msh", msh_of(mesh));
    mesh.x = pushed.before;
    const std::string before = folder.write("before.msh", msh_of(mesh));
    const Outcome outcome = almesh_with({"quality", after, "before=" + before});
    const auto table = outcome.out.find("\nelements   ");
    REQUIRE(table != std::string::npos);
    const std::vector<std::string> lines = pieces(outcome.out.substr(table + 1), '\n');
    CHECK(words(lines[1])[3] == rounded_down(least_corner_jacobian(mesh, pushed.before), 4));
    CHECK(words(lines[1])[5] == "1");  // <= 0
    CHECK(words(lines[2])[1] == rounded_down(least_corner_jacobian(mesh, pushed.mesh.x), 4));
    CHECK(words(lines[2])[3] == "0");
    CHECK(words(lines[4])[1] == rounded_down(mesh_quality(mesh, pushed.mesh.x).min, 4));
}
