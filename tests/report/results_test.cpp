#include "constraint/motion.hpp"
#include "report/results.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "check/certificate.hpp"
#include "check/scaled_jacobian.hpp"
#include "problem/summary.hpp"
#include "support/msh_formats.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("a run prints its table and writes all files") {
    const RingDeck ring;
    const Outcome outcome = ring.run();
    CHECK(outcome.code == 0);
    CHECK(outcome.error.empty());
    for (const char* part : {"A ring", "48 nodes, 72 triangles of degree 1, 24 boundary faces", "|grad E|",
                             "converged: ", "certified valid"})
        CHECK(has(outcome.out, part));
    CHECK(has(outcome.out, "results in " + ring.output));
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(ring.output)) files.push_back(entry.path().filename());
    std::sort(files.begin(), files.end());
    CHECK(files == std::vector<std::string>{"boundary.vtk", "deck.txt", "expectations.csv", "final.msh", "final.vtk",
                                            "history.csv", "initial.vtk", "summary.txt"});
    for (const char* name : {"initial.vtk", "final.vtk", "boundary.vtk"}) {
        const std::string text = text_of(ring.output + "/" + name);
        CHECK(text.starts_with("# vtk DataFile Version 3.0\nA ring, "));
        CHECK(!has(text, "nan"));
        CHECK(!has(text, "inf"));
        CHECK(has(text, has(name, "boundary") ? "POINTS 24 " : "POINTS 48 "));
    }
    for (const char* field : {"distortion", "quality", "scaled_jacobian", "certified_bound", "element_id"})
        CHECK(has(text_of(ring.output + "/final.vtk"), field));
    for (const char* field : {"multipliers", "multiplier_magnitude", "constraint"})
        CHECK(has(text_of(ring.output + "/boundary.vtk"), field));
    CHECK(!has(text_of(ring.output + "/final.vtk"), "wall_distance"));
}

TEST_CASE("VTK files in binary, and none") {
    const RingDeck ring;
    REQUIRE(ring.run({"vtk=binary"}).code == 0);
    for (const char* name : {"initial.vtk", "final.vtk", "boundary.vtk"})
        CHECK(has(text_of(ring.output + "/" + name), "\nBINARY\n"));
    std::filesystem::remove_all(ring.output);
    REQUIRE(ring.run({"vtk=none"}).code == 0);
    for (const auto& entry : std::filesystem::directory_iterator(ring.output))
        CHECK(entry.path().extension() != ".vtk");
    CHECK(std::filesystem::exists(ring.output + "/final.msh"));
}

TEST_CASE("iterates: every second Newton step in a file of its own, all in a series, and gone with the next run") {
    const RingDeck ring;
    const auto iterates = [&ring] {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(ring.output))
            if (has(entry.path().filename(), "iterate")) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    };
    REQUIRE(ring.run({"iterates=2"}).code == 0);
    const auto steps = static_cast<int>(number(summary_of(ring.output), "newton_iterations"));
    REQUIRE(steps >= 2);
    std::vector<std::string> expected;
    for (int k = 0; k <= steps / 2; ++k) expected.push_back(concat("iterate-000", k, ".vtk"));
    expected.push_back("iterates.vtk.series");
    CHECK(iterates() == expected);
    const std::string series = text_of(ring.output + "/iterates.vtk.series");
    CHECK(has(series, "{\"name\": \"iterate-0001.vtk\", \"time\": 2}"));
    CHECK(has(text_of(ring.output + "/iterate-0001.vtk"), "A ring, iterate-0001"));
    const auto points = [&ring](const std::string& name) {
        const std::string text = text_of(ring.output + "/" + name + ".vtk");
        return text.substr(text.find("POINTS"), text.find("CELLS") - text.find("POINTS"));
    };
    CHECK(points("iterate-0000") == points("initial"));
    CHECK(points("iterate-0001") != points("initial"));

    REQUIRE(ring.run({"iterates=1", "vtk=none"}).code == 0);
    CHECK(iterates().empty());
}

TEST_CASE("the summary has every quantity in its order, with values that belong together") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const auto lines = summary_lines(ring.output);
    std::vector<std::string> keys;
    for (const auto& line : lines) keys.push_back(line.first);
    CHECK(keys == std::vector<std::string>{"status",
                                           "run",
                                           "dimension",
                                           "degree",
                                           "nodes",
                                           "elements",
                                           "al_iterations",
                                           "newton_iterations",
                                           "earlier_newton_iterations",
                                           "coarse_newton_iterations",
                                           "linear_iterations",
                                           "local_steps",
                                           "constraint_norm",
                                           "projected_constraint_norm",
                                           "max_boundary_error",
                                           "relative_boundary_error",
                                           "nodes_off_target",
                                           "nodes_off_motion",
                                           "off_motion",
                                           "gradient_norm",
                                           "relative_quality",
                                           "max_distortion",
                                           "size_skew_mean",
                                           "size_skew_min",
                                           "power",
                                           "freed_nodes",
                                           "largest_slide",
                                           "surface_distance",
                                           "straight_faces",
                                           "boundary_distance",
                                           "relative_boundary_distance",
                                           "split_elements",
                                           "periodic_pairs",
                                           "periodic_mismatch",
                                           "refined_elements",
                                           "scaled_jacobian",
                                           "certified_bound",
                                           "invalid_elements",
                                           "certified_valid",
                                           "certified_injective",
                                           "contact_overlap",
                                           "diagnosis",
                                           "diagnosis_boundary",
                                           "diagnosis_node",
                                           "diagnosis_element",
                                           "diagnosis_x",
                                           "diagnosis_y",
                                           "diagnosis_z",
                                           "time_run",
                                           "time_setup",
                                           "time_coarse",
                                           "time_certify",
                                           "time_write",
                                           "time_total",
                                           "time_assembly",
                                           "time_linear",
                                           "time_line_search",
                                           "time_elimination",
                                           "threads",
                                           "predicted_memory_mb",
                                           "peak_memory_mb"});
    CHECK(keys == names_of(summary_quantities()));
    const auto summary = summary_of(ring.output);
    CHECK(summary.at("status") == "converged");
    CHECK(summary.at("dimension") == "2");
    CHECK(summary.at("degree") == "1");
    CHECK(summary.at("nodes") == "48");
    CHECK(summary.at("elements") == "72");
    CHECK(summary.at("threads") == "1");
    CHECK(summary.at("certified_valid") == "yes");
    CHECK(number(summary, "certified_bound") == 1);
    CHECK(number(summary, "constraint_norm") < 1e-7);
    CHECK(number(summary, "max_boundary_error") < 1e-6);
    CHECK(number(summary, "max_distortion") > 1);
    CHECK(number(summary, "relative_quality") < 1);
    CHECK(number(summary, "peak_memory_mb") > 1);
    CHECK(number(summary, "time_total") >= number(summary, "time_assembly") + number(summary, "time_linear"));
    const double phases = number(summary, "time_setup") + number(summary, "time_total") +
                          number(summary, "time_certify") + number(summary, "time_write");
    CHECK(number(summary, "time_run") == doctest::Approx(phases).epsilon(0.01).scale(1));
    CHECK(summary.at("coarse_newton_iterations") == "0");
    for (const std::string what : {"", "_boundary", "_node", "_element", "_x", "_y", "_z"})
        CHECK(summary.at("diagnosis" + what) == "none");
}

TEST_CASE("the scaled Jacobian at corners and the certified bound of the whole elements are told side by side") {
    for (const int degree : {1, 2}) {
        const RingDeck ring(raise_degree(ring_mesh(12, 2, 5), degree));
        REQUIRE(ring.run().code == 0);
        const Mesh mesh = mesh_of(ring.output + "/final.msh");
        const std::string vtk = text_of(ring.output + "/final.vtk");
        const std::vector<std::pair<std::string, std::vector<double>>> measures = {
            {"scaled_jacobian", corner_jacobians(mesh, mesh.x)},
            {"certified_bound", certify(mesh, mesh.x).certified_bound}};
        for (const auto& [name, value] : measures) {
            const std::vector<double> written = scalars(vtk, name);
            REQUIRE(written.size() == value.size());
            for (std::size_t e = 0; e < value.size(); ++e) CHECK(written[e] == doctest::Approx(value[e]).epsilon(1e-4));
            CHECK(number(summary_of(ring.output), name) ==
                  doctest::Approx(*std::min_element(value.begin(), value.end())).epsilon(1e-5));
        }
    }
}

TEST_CASE("the history belongs to the summary") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const auto rows = csv_rows(text_of(ring.output + "/history.csv"));
    const auto column = [&](const std::string& name) {
        return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
    };
    int al = -1, newton = 0, announced = 0;
    for (std::size_t k = 1; k < rows.size(); ++k) {
        REQUIRE(rows[k].size() == rows[0].size());
        if (rows[k][0] == "newton") {
            ++newton;
            CHECK(rows[k][column("al_iteration")] == std::to_string(al + 1));
            continue;
        }
        CHECK(rows[k][column("al_iteration")] == std::to_string(++al));
        if (al > 0) announced += *parse_int(rows[k][column("newton_iterations")]);  // row 0 is the initial mesh
    }
    const auto summary = summary_of(ring.output);
    CHECK(std::to_string(al) == summary.at("al_iterations"));
    CHECK(std::to_string(newton) == summary.at("newton_iterations"));
    CHECK(announced == newton);
    const auto& last = rows.back();
    for (const char* name :
         {"constraint_norm", "projected_constraint_norm", "gradient_norm", "relative_quality", "max_distortion"})
        CHECK(*parse_double(last[column(name)]) == doctest::Approx(number(summary, name)).epsilon(1e-5));
    CHECK(last[column("update")] == "lambda");
    CHECK(*parse_double(rows[1][column("constraint_norm")]) == doctest::Approx(2 * std::sqrt(0.5)).epsilon(1e-12));
}

TEST_CASE("final.msh is the mesh of the input with new positions") {
    for (int version : {22, 41}) {
        Mesh mesh = raise_degree(ring_mesh(10, 2, 5), 2);
        for (int i = 0; i < mesh.nodes(); ++i) mesh.file.node_id[i] = 1000 + 7 * i;
        const RingDeck ring(mesh);
        ring.folder.write("ring.msh", msh_text(mesh, mesh.x, {.msh_version = version}));
        REQUIRE(ring.run().code == 0);
        const Mesh before = mesh_of(ring.folder.path("ring.msh")), after = mesh_of(ring.output + "/final.msh");
        CHECK(after.file.format.msh_version == version);
        CHECK(after.degree == 2);
        CHECK(std::is_permutation(after.file.node_id.begin(), after.file.node_id.end(), before.file.node_id.begin(),
                                  before.file.node_id.end()));
        CHECK(std::is_permutation(after.file.element_id.begin(), after.file.element_id.end(),
                                  before.file.element_id.begin(), before.file.element_id.end()));
        CHECK(std::is_permutation(after.file.face_id.begin(), after.file.face_id.end(), before.file.face_id.begin(),
                                  before.file.face_id.end()));
        CHECK(after.file.element_physical == before.file.element_physical);
        CHECK(after.boundaries == before.boundaries);
        CHECK(certify(after, after.x).valid);
        for (int f = 0; f < after.face_count(); ++f) {
            const bool inner = after.boundaries[after.face_boundary[f]] == "inner";
            for (int i = 0; i < 3; ++i) {
                const double* p = &after.x[2 * after.face(f)[i]];
                const double r = std::hypot(p[0] - (inner ? 2 : 0), p[1]), radius = inner ? 1 : 5;
                CHECK(r > radius * std::cos(std::numbers::pi / 10) - 1e-6);
                CHECK(r < radius + 1e-6);
            }
        }
    }
}

TEST_CASE("the final mesh is in the format of the input or of the deck") {
    const FileFormat binary{.msh_version = 41, .binary = true};
    const Mesh mesh = ring_mesh(12, 3, 6);
    const RingDeck ring;
    ring.folder.write("ring.msh", msh_text(mesh, mesh.x, binary));
    const auto format_with = [&](const std::string& final_format) {
        std::filesystem::remove_all(ring.output);
        CHECK(ring.run({"vtk=none", "final=" + final_format}).code == 0);
        CHECK(std::filesystem::exists(ring.output + "/final.su2") == (final_format == "both"));
        return to_string(mesh_of(ring.output + "/final.msh").file.format);
    };
    CHECK(format_with("input") == "MSH 4.1, binary");
    CHECK(format_with("msh") == "MSH 2.2, ASCII");
    CHECK(format_with("both") == "MSH 2.2, ASCII");
}

TEST_CASE("deck.txt repeats the run: same final mesh to the bit") {
    const RingDeck ring(ring_mesh(12, 3, 6),
                        "threads = 1\ndegree = 2\nobjective = squared\nexpect status = converged\n");
    REQUIRE(ring.run().code == 0);
    const std::string first = text_of(ring.output + "/final.msh"), deck = text_of(ring.output + "/deck.txt");
    const Outcome again = almesh_with({ring.output + "/deck.txt"});
    CHECK(again.code == 0);
    CHECK(text_of(ring.output + "/final.msh") == first);
    const auto settings = [](const std::string& text) { return text.substr(text.find("# Every key")); };
    CHECK(settings(text_of(ring.output + "/deck.txt")) == settings(deck));
    for (const char* part : {"# almesh ", "commit ", "# compiled by ", "threads 1", "mesh hash ",
                             "boundary inner = translate 2 0", "expect status = converged"})
        CHECK(has(deck, part));
}

TEST_CASE("without the key output, results go to outputs/ and the deck's name in the current folder") {
    const RingDeck ring;
    ring.folder.write("other.deck", "mesh = ring.msh\nboundary inner = fixed\nboundary outer = fixed\nthreads = 1\n");
    const CurrentFolder here(ring.folder.path());
    CHECK(almesh_with({"other.deck"}).code == 0);
    CHECK(std::filesystem::exists("outputs/other/summary.txt"));
    CHECK(almesh_with({"outputs/other/deck.txt"}).code == 0);
}

TEST_CASE("a wall adds its distance to the final mesh") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\nwall = inner\n");
    CHECK(ring.run().code == 0);
    CHECK(has(text_of(ring.output + "/final.vtk"), "wall_distance"));
}
