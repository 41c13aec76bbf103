#include "app/run.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "certify/certificate.hpp"
#include "io/expectation.hpp"
#include "support/ring_deck.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::vector<std::string> result_files = {"boundary.vtk", "deck.txt",  "final.msh",  "final.vtk",
                                               "history.csv",  "initial.vtk", "summary.txt"};

double number(const std::map<std::string, std::string>& summary, const std::string& key) {
    const auto value = parse_double(summary.at(key));
    REQUIRE(value);
    return *value;
}

std::vector<double> final_positions(const RingDeck& ring) { return mesh_of(ring.output + "/final.msh").x; }

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

Mesh scaled_mesh(Mesh mesh, double factor) {
    for (double& v : mesh.x) v *= factor;
    return mesh;
}

}  // namespace

TEST_CASE("a run prints its table and writes all files") {
    const RingDeck ring;
    const Outcome outcome = ring.run();
    CHECK(outcome.code == 0);
    CHECK(outcome.error.empty());
    for (const char* part : {"A ring", "48 nodes, 72 triangles of degree 1, 24 boundary faces", "|grad E|", "converged: ", "certified valid"})
        CHECK(has(outcome.out, part));
    CHECK(has(outcome.out, "results in " + ring.output));
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(ring.output)) files.push_back(entry.path().filename());
    std::sort(files.begin(), files.end());
    CHECK(files == result_files);
    for (const char* name : {"initial.vtk", "final.vtk", "boundary.vtk"}) {
        const std::string text = text_of(ring.output + "/" + name);
        CHECK(text.starts_with("# vtk DataFile Version 3.0\nA ring, "));
        CHECK(!has(text, "nan"));
        CHECK(!has(text, "inf"));
        CHECK(has(text, has(name, "boundary") ? "POINTS 24 " : "POINTS 48 "));
    }
    for (const char* field : {"distortion", "quality", "min_scaled_jacobian", "element_id"})
        CHECK(has(text_of(ring.output + "/final.vtk"), field));
    for (const char* field : {"multipliers", "multiplier_magnitude", "constraint"})
        CHECK(has(text_of(ring.output + "/boundary.vtk"), field));
    CHECK(!has(text_of(ring.output + "/final.vtk"), "wall_distance"));
}

TEST_CASE("the summary has every quantity in its order, with values that belong together") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const auto lines = summary_lines(ring.output);
    std::vector<std::string> keys;
    for (const auto& line : lines) keys.push_back(line.first);
    CHECK(keys == std::vector<std::string>{"status", "dimension", "degree", "nodes", "elements", "al_iterations",
                                           "newton_iterations", "linear_iterations", "constraint_norm",
                                           "projected_constraint_norm", "max_boundary_error", "gradient_norm",
                                           "relative_quality", "max_distortion", "min_scaled_jacobian", "certified_valid",
                                           "time_total", "time_assembly", "time_linear", "time_line_search", "threads",
                                           "peak_memory_mb"});
    CHECK(keys == summary_quantities());
    const auto summary = summary_of(ring.output);
    CHECK(summary.at("status") == "converged");
    CHECK(summary.at("dimension") == "2");
    CHECK(summary.at("degree") == "1");
    CHECK(summary.at("nodes") == "48");
    CHECK(summary.at("elements") == "72");
    CHECK(summary.at("threads") == "1");
    CHECK(summary.at("certified_valid") == "yes");
    CHECK(number(summary, "min_scaled_jacobian") == 1);
    CHECK(number(summary, "constraint_norm") < 1e-7);
    CHECK(number(summary, "max_boundary_error") < 1e-6);
    CHECK(number(summary, "max_distortion") > 1);
    CHECK(number(summary, "relative_quality") < 1);
    CHECK(number(summary, "peak_memory_mb") > 1);
    CHECK(number(summary, "time_total") >= number(summary, "time_assembly") + number(summary, "time_linear"));
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
        announced += *parse_int(rows[k][column("newton_iterations")]);
    }
    const auto summary = summary_of(ring.output);
    CHECK(std::to_string(al) == summary.at("al_iterations"));
    CHECK(std::to_string(newton) == summary.at("newton_iterations"));
    CHECK(announced == newton);
    const auto& last = rows.back();
    for (const char* name : {"constraint_norm", "projected_constraint_norm", "gradient_norm", "relative_quality", "max_distortion"})
        CHECK(*parse_double(last[column(name)]) == doctest::Approx(number(summary, name)).epsilon(1e-5));
    CHECK(last[column("update")] == "-");
    CHECK(*parse_double(rows[1][column("constraint_norm")]) == doctest::Approx(2 * std::sqrt(0.5)).epsilon(1e-12));
}

TEST_CASE("final.msh is the mesh of the input with new positions") {
    for (int version : {22, 41}) {
        Mesh mesh = raise_degree(ring_mesh(10, 2, 5), 2);
        mesh.msh_version = version;
        for (int i = 0; i < mesh.nodes(); ++i) mesh.node_id[i] = 1000 + 7 * i;
        const RingDeck ring(mesh);
        REQUIRE(ring.run().code == 0);
        const Mesh before = mesh_of(ring.folder.path("ring.msh")), after = mesh_of(ring.output + "/final.msh");
        CHECK(after.msh_version == version);
        CHECK(after.degree == 2);
        CHECK(std::is_permutation(after.node_id.begin(), after.node_id.end(), before.node_id.begin(), before.node_id.end()));
        CHECK(std::is_permutation(after.element_id.begin(), after.element_id.end(), before.element_id.begin(), before.element_id.end()));
        CHECK(std::is_permutation(after.face_id.begin(), after.face_id.end(), before.face_id.begin(), before.face_id.end()));
        CHECK(after.element_physical == before.element_physical);
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

TEST_CASE("deck.txt repeats the run: same final mesh to the bit") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\ndegree = 2\nobjective = squared\nexpect status = converged\n");
    REQUIRE(ring.run().code == 0);
    const std::string first = text_of(ring.output + "/final.msh"), deck = text_of(ring.output + "/deck.txt");
    const Outcome again = almesh_with({ring.output + "/deck.txt"});
    CHECK(again.code == 0);
    CHECK(text_of(ring.output + "/final.msh") == first);
    const auto settings = [](const std::string& text) { return text.substr(text.find("# Every key")); };
    CHECK(settings(text_of(ring.output + "/deck.txt")) == settings(deck));
    for (const char* part : {"# almesh ", "commit ", "# compiled by ", "threads 1", "mesh hash ", "boundary inner = translate 2 0", "expect status = converged"})
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

TEST_CASE("settings on the command line replace those of the deck") {
    const RingDeck ring;
    const std::string elsewhere = ring.folder.path("elsewhere");
    const Outcome outcome = ring.run({"refine=1", "output=" + elsewhere, "boundary inner=translate 1 0", "title=Another"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "Another"));
    CHECK(!std::filesystem::exists(ring.output));
    const auto summary = summary_of(elsewhere);
    CHECK(summary.at("elements") == "288");
    CHECK(has(text_of(elsewhere + "/deck.txt"), "boundary inner = translate 1 0"));
    CHECK(ring.run({"nonsense=1"}).code == 1);
    CHECK(has(ring.run({"refine=x"}).error, "command line"));
}

TEST_CASE("a wall adds its distance to the final mesh") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\nwall = inner\n");
    CHECK(ring.run().code == 0);
    CHECK(has(text_of(ring.output + "/final.vtk"), "wall_distance"));
}

TEST_CASE("a curved run reaches its floor: degree 3 onto circles") {
    const RingDeck ring;
    const Outcome outcome = ring.run({"degree=3", "boundary inner=circle 0 0 1", "boundary outer=circle 0 0 6", "wall=inner"});
    CHECK(outcome.code == 0);
    const auto summary = summary_of(ring.output);
    CHECK(summary.at("degree") == "3");
    CHECK(number(summary, "projected_constraint_norm") < 1e-6);
    CHECK(number(summary, "constraint_norm") > 1e-5);
    CHECK(number(summary, "constraint_norm") < 1e-2);
    CHECK(number(summary, "min_scaled_jacobian") > 0);
    const Mesh mesh = mesh_of(ring.output + "/final.msh");
    for (int i : mesh.faces) {
        const double r = std::hypot(mesh.x[2 * i], mesh.x[2 * i + 1]);
        CHECK(std::min(std::abs(r - 1), std::abs(r - 6) / 6) < 1e-3);
    }
}

TEST_CASE("a 3D run") {
    const TemporaryFolder folder;
    folder.write("cube.msh", msh_of(cube_mesh(2)));
    const std::string deck = folder.write("cube.deck", "mesh = cube.msh\nthreads = 1\noutput = " + folder.path("out") +
                                                           "\nboundary bottom = scale 1 1 1.5\nboundary top = scale 1 1 1.5\n"
                                                           "boundary sides = scale 1 1 1.5\n");
    CHECK(almesh_with({deck}).code == 0);
    const auto summary = summary_of(folder.path("out"));
    CHECK(summary.at("dimension") == "3");
    CHECK(number(summary, "max_boundary_error") < 1e-6);
    CHECK(has(text_of(folder.path("out") + "/history.csv"), "cholesky"));
}

TEST_CASE("all linear solvers give the same positions") {
    const RingDeck ring(raise_degree(ring_mesh(12, 3, 6), 2));
    std::vector<std::vector<double>> x;
    for (const char* solver : {"solver=auto", "solver=cholesky", "solver=gmres"}) {
        CHECK(ring.run({solver}).code == 0);
        x.push_back(final_positions(ring));
    }
    CHECK(largest_difference(x[0], x[1]) < 1e-7);
    CHECK(largest_difference(x[0], x[2]) < 1e-7);
    CHECK(number(summary_of(ring.output), "linear_iterations") > 0);
}

TEST_CASE("the same files for any number of threads") {
    const int before = max_threads();
    const RingDeck ring(ring_mesh(8, 2, 4), "");
    std::string mesh;
    std::vector<std::vector<std::string>> history;
    for (int threads : {1, 2, 3}) {
        CHECK(ring.run({"threads=" + std::to_string(threads), "boundary inner=translate 1 0"}).code == 0);
        if (threads == 1) {
            mesh = text_of(ring.output + "/final.msh");
            history = history_without_times(ring.output);
        }
        CHECK(text_of(ring.output + "/final.msh") == mesh);
        CHECK(history_without_times(ring.output) == history);
#ifdef _OPENMP
        CHECK(summary_of(ring.output).at("threads") == std::to_string(threads));
#endif
    }
    set_threads(before);
}

TEST_CASE("the unit of length does not matter: same iterations, same mesh but for the scale") {
    for (const char* objective : {"objective=squared", "objective=deviation"})
        for (const char* algorithm : {"algorithm=adaptive", "algorithm=paper"}) {
            const Mesh mesh = ring_mesh(12, 4, 6);
            const RingDeck one(mesh);
            REQUIRE(one.run({objective, algorithm, "boundary inner=rotate 15; translate 3 1"}).code == 0);
            const auto expected = summary_of(one.output);
            const std::vector<double> x = final_positions(one);
            for (const auto& [scale, shift] : {std::pair(1e-3, "3e-3 1e-3"), std::pair(1e3, "3000 1000")}) {
                const RingDeck other(scaled_mesh(mesh, scale));
                CAPTURE(scale);
                CHECK(other.run({objective, algorithm, std::string("boundary inner=rotate 15; translate ") + shift}).code == 0);
                const auto summary = summary_of(other.output);
                CHECK(summary.at("al_iterations") == expected.at("al_iterations"));
                CHECK(summary.at("newton_iterations") == expected.at("newton_iterations"));
                CHECK(summary.at("relative_quality") == expected.at("relative_quality"));
                std::vector<double> y = final_positions(other);
                for (double& v : y) v /= scale;
                CHECK(largest_difference(x, y) < 1e-9);
            }
        }
}

TEST_CASE("expectations that hold end with code 0, the first that fails with 5 and its line") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\nexpect status = converged\nexpect nodes = 48\nexpect max_distortion <= 9\n");
    const Outcome good = ring.run();
    CHECK(good.code == 0);
    CHECK(has(good.out, "all 3 expectations of the deck hold"));
    const Outcome bad = ring.run({"expect nodes = 49"});
    CHECK(bad.code == 5);
    CHECK(has(bad.out, "expected nodes = 49, got 48: fails"));
    CHECK(!has(bad.out, "expectations of the deck hold"));
    const RingDeck wrong(ring_mesh(12, 3, 6), "threads = 1\nexpect max_distortion <= 1\n");
    const Outcome from_deck = wrong.run();
    CHECK(from_deck.code == 5);
    CHECK(has(from_deck.out, "ring.deck:7: expected max_distortion <= 1, got "));
    CHECK(std::filesystem::exists(wrong.output + "/final.msh"));
}

TEST_CASE("a motion that no valid mesh can follow: code 3, and a valid mesh is written") {
    for (const char* objective : {"objective=squared", "objective=deviation"})
        for (const char* algorithm : {"algorithm=adaptive", "algorithm=paper"}) {
            const RingDeck ring;
            const Outcome outcome = ring.run({"boundary inner=translate 40 0", objective, algorithm, "expect status = converged"});
            CHECK(outcome.code == 3);
            CHECK(has(outcome.out, "infeasible"));
            CHECK(summary_of(ring.output).at("status") == "infeasible");
            CHECK(summary_of(ring.output).at("certified_valid") == "yes");
            const Mesh mesh = mesh_of(ring.output + "/final.msh");
            CHECK(certify(mesh, mesh.x).valid);
            CHECK(has(text_of(ring.output + "/final.vtk"), "POINTS 48 "));
        }
}

// delta > 0 regularises: inverted elements have a finite distortion, and the target is reached through them.
TEST_CASE("converged but not certified: code 4, and the worst ten elements by id and centre") {
    const RingDeck ring;
    const Outcome outcome = ring.run({"delta=1", "boundary inner=translate 40 0"});
    CHECK(outcome.code == 4);
    CHECK(has(outcome.out, "NOT certified valid"));
    CHECK(has(outcome.out, "elements are not certified valid; the worst ten"));
    CHECK(summary_of(ring.output).at("status") == "converged");
    CHECK(summary_of(ring.output).at("certified_valid") == "no");
    CHECK(number(summary_of(ring.output), "min_scaled_jacobian") < 0);
    const auto lines = pieces(outcome.out, '\n');
    CHECK(std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
              return line.starts_with("  ") && has(line, "  (") && has(line, ")  -");
          }) == 10);
    CHECK(!has(text_of(ring.output + "/final.vtk"), "nan"));
}

TEST_CASE("too few iterations: code 3 with the reason, and a valid mesh is written") {
    const RingDeck ring;
    for (const auto& [setting, status] : {std::pair("max_al_iterations=1", "max_al_iterations"),
                                          std::pair("max_newton_iterations=1", "max_newton_iterations")}) {
        const Outcome outcome = ring.run({setting});
        CHECK(outcome.code == 3);
        CHECK(has(outcome.out, status));
        CHECK(summary_of(ring.output).at("status") == status);
        const Mesh mesh = mesh_of(ring.output + "/final.msh");
        CHECK(certify(mesh, mesh.x).valid);
    }
}
