// The quality of elements before and after, as a table and as quality.csv.
#include "report/mesh_quality.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "check/certificate.hpp"
#include "check/quality.hpp"
#include "check/scaled_jacobian.hpp"
#include "support/high_order.hpp"
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

TEST_CASE("quality of one mesh: a row for each measure, the certified bound, and the worst elements with all three") {
    const TemporaryFolder folder;
    for (const int degree : {1, 2}) {
        Mesh mesh = with_degree(square_mesh(4), degree);
        mesh.x = mapped(mesh, [](double* p) { p[0] += 0.3 * p[1] * p[1]; });
        const std::vector<double> corner = corner_jacobians(mesh, mesh.x);
        const Certificate certificate = certify(mesh, mesh.x);
        const std::string out = almesh_with({"quality", folder.write("mesh.msh", msh_of(mesh))}).out;
        const std::string least = rounded_down(*std::min_element(corner.begin(), corner.end()), 4);
        for (const std::string row : {degree == 1 ? "scaled Jacobian" : "scaled Jacobian*", "quality 1/eta"})
            REQUIRE(has(out, "\n" + row + "  "));
        CHECK(words(std::string_view(out).substr(out.find("\nscaled Jacobian") + 1))[2] == least);
        CHECK(has(out, "\n* corners of the straight cells; the certified bound is that of the curved ones\n") ==
              (degree == 2));
        CHECK(has(out, "\ncertified valid: certified bound " +
                           rounded_down(certificate.min_certified_bound, 6) + "\n"));
        const std::vector<double>& measure = degree == 1 ? corner : certificate.certified_bound;
        const auto worst = std::min_element(measure.begin(), measure.end()) - measure.begin();
        const auto list = out.find("\nworst elements (id, centre, scaled Jacobian");
        REQUIRE(list != std::string::npos);
        const std::string first = pieces(out.substr(list + 1), '\n').at(1);
        const auto row = words(first);
        CHECK(row[0] == std::to_string(mesh.file.element_id[worst]));
        CHECK(std::vector<std::string>(row.begin() + 3, row.end()) ==
              std::vector<std::string>{rounded_down(corner[worst], 4),
                                       rounded_down(certificate.certified_bound[worst], 4),
                                       rounded_down(mesh_quality(mesh, mesh.x).quality[worst], 4)});
    }
}

TEST_CASE("the table of a curved mesh says that its corners are those of straight cells") {
    const Mesh mesh = with_degree(square_mesh(1), 2);
    const std::string table = quality_table(Output(nullptr), quality_change(mesh, mesh.x, mesh.x), 2);
    CHECK(has(table, "\nscaled Jacobian* before  "));
    CHECK(has(table, "\n* corners of the straight cells"));
    CHECK(!has(quality_table(Output(nullptr), quality_change(mesh, mesh.x, mesh.x), 1), "straight"));
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
