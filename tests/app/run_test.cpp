#include "app/commands.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "check/certificate.hpp"
#include "support/ring_deck.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

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

TEST_CASE("settings on the command line replace those of the deck") {
    const RingDeck ring;
    const std::string elsewhere = ring.folder.path("elsewhere");
    const Outcome outcome =
        ring.run({"refine=1", "output=" + elsewhere, "boundary inner=translate 1 0", "title=Another"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "Another"));
    CHECK(!std::filesystem::exists(ring.output));
    const auto summary = summary_of(elsewhere);
    CHECK(summary.at("elements") == "288");
    CHECK(has(text_of(elsewhere + "/deck.txt"), "boundary inner = translate 1 0"));
    CHECK(ring.run({"nonsense=1"}).code == 1);
    CHECK(has(ring.run({"refine=x"}).error, "command line"));
}

TEST_CASE("a curved run reaches its floor: degree 3 onto circles") {
    const RingDeck ring;
    const Outcome outcome =
        ring.run({"degree=3", "boundary inner=circle 0 0 1", "boundary outer=circle 0 0 6", "wall=inner",
                  "target=least_squares"});
    CHECK(outcome.code == 0);
    const auto summary = summary_of(ring.output);
    CHECK(summary.at("degree") == "3");
    CHECK(number(summary, "projected_constraint_norm") < 1e-6);
    CHECK(number(summary, "constraint_norm") > 1e-5);
    CHECK(number(summary, "constraint_norm") < 1e-2);
    CHECK(number(summary, "certified_bound") > 0);
    const Mesh mesh = mesh_of(ring.output + "/final.msh");
    for (int i : mesh.faces) {
        const double r = std::hypot(mesh.x[2 * i], mesh.x[2 * i + 1]);
        CHECK(std::min(std::abs(r - 1), std::abs(r - 6) / 6) < 1e-3);
    }
}

TEST_CASE("a 3D run") {
    const TemporaryFolder folder;
    folder.write("cube.msh", msh_of(cube_mesh(2)));
    const std::string deck =
        folder.write("cube.deck", "mesh = cube.msh\nthreads = 1\noutput = " + folder.path("out") +
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
    for (const char* solver : {"solver=auto", "solver=cholesky", "solver=cg", "solver=gmres"}) {
        CHECK(ring.run({solver, "forcing=fixed"}).code == 0);
        x.push_back(final_positions(ring));
    }
    CHECK(largest_difference(x[0], x[1]) < 1e-7);
    CHECK(largest_difference(x[0], x[2]) < 1e-7);
    CHECK(largest_difference(x[0], x[3]) < 1e-7);
    CHECK(number(summary_of(ring.output), "linear_iterations") > 0);
}

TEST_CASE("objective = size_shape keeps the sizes of elements too, from a deck") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\nobjective = size_shape\n");
    // Largest factor by which an element has grown or shrunk.
    const auto change_of_size = [&] {
        const Mesh ideal = mesh_of(ring.folder.path("ring.msh")), moved = mesh_of(ring.output + "/final.msh");
        double most = 1;
        for (int e = 0; e < moved.element_count(); ++e) {
            const auto area = [e](const Mesh& mesh) {
                const auto at = [&](int k, int a) { return mesh.x[2 * mesh.element(e)[k] + a]; };
                return (at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(2, 0) - at(0, 0)) * (at(1, 1) - at(0, 1));
            };
            most = std::max({most, area(moved) / area(ideal), area(ideal) / area(moved)});
        }
        return most;
    };
    const Outcome outcome = ring.run();
    CHECK(outcome.code == 0);
    CHECK(has(text_of(ring.output + "/deck.txt"), "\nobjective = size_shape"));
    CHECK(summary_of(ring.output).at("certified_valid") == "yes");
    double change[2];
    for (int k = 0; k < 2; ++k) {
        const char* const objective = k ? "objective=size_shape" : "objective=deviation";
        REQUIRE(ring.run({objective, "boundary inner=scale 0.5"}).code == 0);
        change[k] = change_of_size();
    }
    CHECK(change[1] < 0.9 * change[0]);

    // Scaled by 2 every element has eta = (4 + 1/4)/2, but for deviation the mesh is as good as before.
    const auto energy_over_volume = [&](const std::string& objective) {
        REQUIRE(ring.run({"boundary inner=scale 2", "boundary outer=scale 2", "weight_exponent=1", objective}).code ==
                0);
        const auto rows = csv_rows(text_of(ring.output + "/history.csv"));
        REQUIRE(rows[0][3] == "energy");
        const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
        return *parse_double(rows.back()[3]) / volume(mesh, mesh.x);
    };
    CHECK(energy_over_volume("objective=size_shape") == doctest::Approx(1.125 * 1.125).epsilon(1e-3));
    CHECK(std::abs(energy_over_volume("objective=deviation")) < 1e-8);
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
            for (double scale : {1e-3, 1e3}) {
                const RingDeck other(scaled_mesh(mesh, scale));
                const std::string shift = scale < 1 ? "3e-3 1e-3" : "3000 1000";
                CAPTURE(scale);
                CHECK(other.run({objective, algorithm, "boundary inner=rotate 15; translate " + shift}).code == 0);
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
    const RingDeck ring(ring_mesh(12, 3, 6),
                        "threads = 1\nexpect status = converged\nexpect nodes = 48\nexpect max_distortion <= 9\n");
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
    const auto rows = csv_rows(text_of(wrong.output + "/expectations.csv"));
    REQUIRE(rows.size() == 2);
    CHECK(rows[0] == std::vector<std::string>{"quantity", "expected", "got", "holds", "run"});
    CHECK(rows[1] == std::vector<std::string>{"max_distortion", "<= 1",
                                              summary_of(wrong.output).at("max_distortion"), "no",
                                              summary_of(wrong.output).at("run")});
}

TEST_CASE("a motion that no valid mesh can follow: code 3, and a valid mesh is written") {
    for (const char* objective : {"objective=squared", "objective=deviation"})
        for (const char* algorithm : {"algorithm=adaptive", "algorithm=paper"}) {
            const RingDeck ring(ring_mesh(32, 2, 3));  // two layers: they cannot be turned that far
            const Outcome outcome = ring.run({"boundary inner=rotate 90", "boundary outer=rotate -90", objective,
                                              algorithm, "expect status = converged"});
            CHECK(outcome.code == 3);
            CHECK(has(outcome.out, "\nstalled: "));
            CHECK(summary_of(ring.output).at("status") == "stalled");
            CHECK(summary_of(ring.output).at("certified_valid") == "yes");
            const Mesh mesh = mesh_of(ring.output + "/final.msh");
            CHECK(certify(mesh, mesh.x).valid);
            CHECK(has(text_of(ring.output + "/final.vtk"), "POINTS 96 "));
        }
}

// delta > 0 regularises: inverted elements have a finite distortion, and the target is reached through them.
TEST_CASE("converged but not certified: code 4, and the worst ten elements by id and centre") {
    const RingDeck ring(ring_mesh(16, 2, 3));
    const Outcome outcome = ring.run({"delta=1", "boundary inner=rotate 175"});
    CHECK(outcome.code == 4);
    CHECK(has(outcome.out, "NOT certified valid"));
    CHECK(has(outcome.out, "; the worst (id, centre, certified bound)"));
    CHECK(summary_of(ring.output).at("status") == "converged");
    CHECK(summary_of(ring.output).at("certified_valid") == "no");
    CHECK(number(summary_of(ring.output), "certified_bound") < 0);
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

TEST_CASE("a mesh far from the origin takes the same steps as one at it, to the last bit of its targets") {
    Mesh mesh = ring_mesh(24, 6, 3);
    std::string steps;
    for (const double far : {0.0, 1e4, 1e6, 1e8}) {
        CAPTURE(far);
        Mesh moved = mesh;
        for (std::size_t k = 0; k < moved.x.size(); ++k) moved.x[k] += k % 2 ? -far : far;
        const std::string about = concat(" about ", far, " ", -far);
        for (const char* more : {"", "degree = 3\n"}) {
            const RingDeck ring(moved, std::string("threads = 1\n") + more);
            const Outcome outcome = ring.run({concat("boundary inner=rotate 40", about, "; translate 0.5 0")});
            CHECK(outcome.code == 0);
            const auto summary = summary_of(ring.output);
            CHECK(summary.at("nodes_off_target") == "0");
            CHECK(number(summary, "max_distortion") < 2);
        }
        const RingDeck slid(moved);  // along the circle that it is on
        CHECK(slid.run({concat("boundary inner=rotate 40", about, "; slide")}).code == 0);
        const RingDeck far_off(moved);  // places are those of the file
        const Outcome stopped =
            far_off.run({"max_al_iterations=1", "boundary inner=translate 1 0", "continuation=never"});
        CHECK(stopped.code == 3);
        if (far > 0) CHECK(std::abs(number(summary_of(far_off.output), "diagnosis_x") - far) <= 1e-5 * far + 4);
    }
}

TEST_CASE("what is certified far from the origin is the mesh that is written, not one with more digits") {
    Mesh mesh = ring_mesh(24, 6, 3);
    for (double& x : mesh.x) x = 1e-6 * x + 1;  // a ring of 1e-6 at (1, 1): ten digits are left
    const RingDeck ring(mesh);
    const auto summary_at = [&](const char* motion) {
        ring.run({concat("boundary inner=", motion)});
        return summary_of(ring.output);
    };
    const auto summary = summary_at("rotate 40 about 1 1; translate 1e-6 0");
    CHECK(summary.at("certified_injective") == "yes");
    CHECK(summary.at("nodes_off_target") == "0");
    const Mesh written = mesh_of(ring.output + "/final.msh");
    CHECK(number(summary, "certified_bound") <= certify(written, written.x).min_certified_bound + 1e-6);
}
