// Velocities and swept volumes as a solver reads them.
#include "report/mesh_velocity.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Rows of numbers; the heading is left out.
std::vector<std::vector<double>> numbers_of(const std::string& path) {
    std::vector<std::vector<double>> numbers;
    const auto rows = csv_rows(text_of(path));
    for (std::size_t k = 1; k < rows.size(); ++k) {
        numbers.emplace_back();
        for (const std::string& cell : rows[k]) numbers.back().push_back(parse_double(cell).value());
    }
    return numbers;
}

std::string file(const RingDeck& ring, int number, const char* what) {
    return concat(ring.output, "/frame-000", number, what);
}

std::map<long long, double> areas(const Mesh& mesh) {
    std::map<long long, double> area;
    for (int e = 0; e < mesh.element_count(); ++e) area[mesh.file.element_id[e]] = volume(mesh, mesh.x, e);
    return area;
}

const std::string speeds_up = "boundary inner=translate \"0.5*t^2\" \"0.25*t\"";

}  // namespace

TEST_CASE("velocities are differences of first and second order, with steps of any length") {
    const RingDeck ring;
    REQUIRE(ring.run({speeds_up, "frames=0, 0.5, 0.75, 1.25", "velocity=nodes"}).code == 0);
    CHECK(!std::filesystem::exists(file(ring, 2, "-swept.csv")));
    const double t[] = {0, 0.5, 0.75, 1.25};
    for (int k = 0; k < 4; ++k) {
        const auto table = numbers_of(file(ring, k + 1, "-velocity.csv"));
        const Mesh mesh = mesh_of(file(ring, k + 1, ".msh")), first = mesh_of(file(ring, 1, ".msh"));
        REQUIRE(table.size() == static_cast<std::size_t>(mesh.nodes()));
        for (int i = 0; i < mesh.nodes(); ++i) {
            REQUIRE(table[i].size() == 7);
            CHECK(table[i][0] == static_cast<double>(mesh.file.node_id[i]));
            CHECK(std::abs(table[i][1] - (mesh.x[2 * i] - first.x[2 * i])) < 1e-14);
        }
        const double v_1 = k == 0 ? 0 : 0.5 * (t[k] + t[k - 1]), v_2 = k < 2 ? v_1 : t[k];
        const double of_boundary[] = {1, 0.5 * t[k] * t[k], 0.25 * t[k], v_1, k == 0 ? 0 : 0.25, v_2,
                                      k == 0 ? 0 : 0.25};
        for (int c = 0; c < 7; ++c) CHECK(table[0][c] == doctest::Approx(of_boundary[c]).epsilon(1e-13));
    }
    const std::string vtk = text_of(file(ring, 3, ".vtk"));
    for (const char* field : {"displacement", "velocity_1", "velocity_2"}) CHECK(has(vtk, field));
    CHECK(has(ring.run({"velocity=faces"}).error, "velocity needs frames"));
    REQUIRE(ring.run({speeds_up, "frames=0, 1"}).code == 0);
    CHECK(!std::filesystem::exists(file(ring, 2, "-velocity.csv")));
    CHECK(!has(text_of(file(ring, 2, ".vtk")), "velocity"));
}

TEST_CASE("from the files alone: an element gains the volume that its faces sweep, to rounding") {
    const RingDeck ring;
    REQUIRE(ring.run({speeds_up, "frames=0 : 0.5 : 1.5", "velocity=faces"}).code == 0);
    CHECK(!std::filesystem::exists(file(ring, 1, "-swept.csv")));
    for (int k = 2; k <= 4; ++k) {
        std::map<long long, double> gain = areas(mesh_of(file(ring, k - 1, ".msh")));
        for (const std::vector<double>& row : numbers_of(file(ring, k, "-swept.csv"))) {
            REQUIRE(row.size() == 5);
            gain[static_cast<long long>(row[0])] += row[2];
            if (row[1] > 0) gain[static_cast<long long>(row[1])] -= row[2];
        }
        for (const auto& [id, area] : areas(mesh_of(file(ring, k, ".msh")))) CHECK(std::abs(gain[id] - area) < 2e-15);
    }
}

TEST_CASE("in space and curved, the tables have the corners of each face") {
    const TemporaryFolder folder;
    folder.write("cube.msh", msh_of(cube_mesh(1)));
    const std::string deck = folder.write("cube.deck", "mesh = cube.msh\ndegree = 2\noutput = " + folder.path("out") +
                                                           "\nboundary all = scale 1 1 \"1 + t\"\nframes = 0, 1\n"
                                                           "velocity = faces\nthreads = 1\n");
    REQUIRE(almesh_with({deck}).code == 0);
    double outward = 0;
    for (const std::vector<double>& row : numbers_of(folder.path("out/frame-0002-swept.csv"))) {
        REQUIRE(row.size() == 7);
        CHECK(row[6] == -1);
        if (row[1] == -1) outward += row[2];
    }
    CHECK(outward == doctest::Approx(1).epsilon(1e-14));
}

TEST_CASE("a run that goes on has the velocities and swept volumes of one that was not stopped") {
    const RingDeck ring;
    const std::string motion = "boundary inner=file " + ring.folder.path("wall-%d.csv") + " displacement";
    const auto write = [&](int k, const char* end) {
        std::string rows;
        for (int i = 1; i <= 12; ++i) rows += concat(i, " ", 0.1 * k * k, " 0", end, "\n");
        ring.folder.write(concat("wall-", k, ".csv"), rows);
    };
    for (int k = 1; k <= 5; ++k) write(k, "");
    const std::vector<std::string> settings = {motion, "frames=0, 0.5, 0.75, 1, 1.5", "velocity=faces"};
    const auto tables = [&] {
        std::string text;
        for (int k = 1; k <= 5; ++k) text += text_of(file(ring, k, "-velocity.csv"));
        for (int k = 2; k <= 5; ++k) text += text_of(file(ring, k, "-swept.csv"));
        return text;
    };
    REQUIRE(ring.run(settings).code == 0);
    const std::string whole = tables();
    write(4, "x");
    CHECK(ring.run(settings).code == 2);
    CHECK(!std::filesystem::exists(file(ring, 4, "-velocity.csv")));
    write(4, "");
    std::vector<std::string> resumed = settings;
    resumed.push_back("resume=1");
    CHECK(ring.run(resumed).code == 0);
    CHECK(tables() == whole);
}
