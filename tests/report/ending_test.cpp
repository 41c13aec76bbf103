#include "report/terminal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "deck/make_problem.hpp"
#include "problem/solve.hpp"
#include "report/results.hpp"
#include "base/interrupt.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr const char* whats[] = {"", "_boundary", "_node", "_element", "_x", "_y", "_z"};

int index_of(const std::vector<long long>& ids, const std::string& id) {
    const auto found = std::find(ids.begin(), ids.end(), parse_int(id).value());
    REQUIRE(found != ids.end());
    return static_cast<int>(found - ids.begin());
}

// Of a mesh that may be folded.
Mesh final_mesh(const std::string& folder) {
    std::vector<std::string> notes;
    return build_mesh(read_mesh(folder + "/final.msh"), notes, Folds::keep);
}

// What a run in `folder` says of its diagnosis: the same place in the summary, in final.msh, in stop.vtk and on the
// terminal.
struct Stop {
    std::map<std::string, std::string> summary;
    Mesh mesh;
    std::string vtk, out;
    int node = -1, element = -1;

    Stop(const std::string& folder, const Outcome& outcome)
        : summary(summary_of(folder)), mesh(final_mesh(folder)), vtk(text_of(folder + "/stop.vtk")), out(outcome.out) {
        element = index_of(mesh.file.element_id, summary.at("diagnosis_element"));
        if (summary.at("diagnosis_node") != "none") node = index_of(mesh.file.node_id, summary.at("diagnosis_node"));
        const std::array<double, 3> place =
            node >= 0 ? centroid(mesh, mesh.x, &node, 1) : centroid(mesh, mesh.x, mesh.element(element), mesh.dim + 1);
        for (int a = 0; a < 3; ++a)
            CHECK(number(summary, whats[4 + a]) == doctest::Approx(place[a]).epsilon(1e-4).scale(1e-3 * size()));
        const int* const of_element = mesh.element(element);
        if (node >= 0) CHECK(std::count(of_element, of_element + mesh.element_nodes(), node) == 1);
        check_vtk();
        CHECK(has(
            out,
            (node >= 0 ? "node " + summary.at("diagnosis_node") : "element " + summary.at("diagnosis_element")) + " "));
        CHECK(has(out, "boundary " + boundary()));
        CHECK(has(out, "\ntry "));
        CHECK(has(out, "the elements around it in stop.vtk"));
    }

    static double number(const std::map<std::string, std::string>& of, const std::string& what) {
        return test::number(of, "diagnosis" + what);
    }
    std::string kind() const { return summary.at("diagnosis"); }
    std::string boundary() const { return summary.at("diagnosis_boundary"); }
    double size() const { return std::abs(*std::max_element(mesh.x.begin(), mesh.x.end())); }

    bool is_on(const std::string& name, int i) const {
        for (int f = 0; f < mesh.face_count(); ++f)
            if (mesh.boundaries[mesh.face_boundary[f]] == name &&
                std::count(mesh.face(f), mesh.face(f) + mesh.face_nodes(0), i))
                return true;
        return false;
    }

    void check_vtk() const {
        const std::vector<double> of_node = scalars(vtk, "node_id"), of_element = scalars(vtk, "element_id");
        CHECK(of_element.size() >= 3);
        CHECK(of_element.size() <= static_cast<std::size_t>(mesh.element_count()));
        const auto marks =
            numbers_of(vtk.substr(vtk.find("CELL_DATA")), "SCALARS diagnosis double 1\nLOOKUP_TABLE default\n");
        REQUIRE(marks.size() == of_element.size());
        for (std::size_t k = 0; k < marks.size(); ++k)
            CHECK((marks[k] == 1) == (static_cast<long long>(of_element[k]) == mesh.file.element_id[element]));
        const auto points = numbers_of(vtk, concat("POINTS ", of_node.size(), " double\n"));
        REQUIRE(points.size() == 3 * of_node.size());
        for (std::size_t k = 0; k < of_node.size(); ++k) {
            const int i = index_of(mesh.file.node_id, std::to_string(static_cast<long long>(of_node[k])));
            for (int a = 0; a < mesh.dim; ++a) CHECK(points[3 * k + a] == point(mesh.x, i, mesh.dim)[a]);
        }
    }
};

}  // namespace

// With a soft penalty and one iteration all nodes are on their way. Their targets are known, and all cells at the inner
// circle have one height, all at the outer one another.
TEST_CASE("the boundary node farthest off is named, and how far it has come") {
    for (const char* const setting : {"degree=1", "degree=2", "refine=1"}) {
        const RingDeck ring(ring_mesh(12, 3, 6),
                            "algorithm = paper\nmu0 = 0.01\nmax_al_iterations = 1\nthreads = 1\n"
                            "target = nodal\n");
        const Outcome outcome = ring.run({setting});
        CHECK(outcome.code == 3);
        const Stop stop(ring.output, outcome);
        CHECK(stop.summary.at("status") == "max_al_iterations");
        CHECK(stop.kind() == "off_target");
        CHECK(stop.boundary() == "inner");
        CHECK(stop.is_on("inner", stop.node));
        // Vertices are where the file has them, other nodes of the inner circle on its edges.
        const Mesh before = mesh_of(ring.folder.path("ring.msh"));
        const auto off = [&](int i) {
            const auto known =
                std::find(before.file.node_id.begin(), before.file.node_id.end(), stop.mesh.file.node_id[i]);
            if (known == before.file.node_id.end()) return -1.0;
            const double* const from = point(before.x, static_cast<int>(known - before.file.node_id.begin()), 2);
            return std::hypot(point(stop.mesh.x, i, 2)[0] - from[0] - 2, point(stop.mesh.x, i, 2)[1] - from[1]);
        };
        if (off(stop.node) < 0) continue;
        for (int i = 0; i < stop.mesh.nodes(); ++i)
            if (stop.is_on("inner", i)) CHECK(off(i) <= (1 + 1e-9) * off(stop.node));
        char way[64];
        std::snprintf(way, sizeof way, "it has gone %.4g %% of its way", 100 * (1 - off(stop.node) / 2));
        CHECK(has(outcome.out, way));
        // The arrow at that node ends at its target.
        const auto ids = scalars(stop.vtk, "node_id"), arrows = numbers_of(stop.vtk, "VECTORS to_target double\n");
        const auto k = std::find(ids.begin(), ids.end(), stop.mesh.file.node_id[stop.node]) - ids.begin();
        CHECK(std::hypot(arrows[3 * k], arrows[3 * k + 1]) == doctest::Approx(off(stop.node)).epsilon(1e-6));
    }
}

TEST_CASE("a target out of reach of two layers: stalled, at a boundary node, and what to try") {
    for (const char* const algorithm : {"algorithm=adaptive", "algorithm=paper"}) {
        const RingDeck ring(ring_mesh(16, 2, 3));
        const Outcome outcome = ring.run({"boundary inner=rotate 175", algorithm});
        CHECK(outcome.code == 3);
        const Stop stop(ring.output, outcome);
        CHECK(stop.summary.at("status") == "stalled");
        CHECK(stop.kind() == "off_target");
        CHECK(stop.is_on(stop.boundary(), stop.node));
        CHECK(has(outcome.out, "a smaller motion"));
    }
}

TEST_CASE("too few Newton steps: the node with most of the gradient, and twice as many to try") {
    const RingDeck ring;
    const Outcome outcome = ring.run({"max_newton_iterations=1", "continuation=never"});
    const Stop stop(ring.output, outcome);
    CHECK(stop.summary.at("status") == "max_newton_iterations");
    CHECK(stop.kind() == "unbalanced");
    CHECK(has(outcome.out, "has the largest part of |grad E|, "));
    CHECK(has(outcome.out, "try max_newton_iterations = 2; "));
    CHECK(has(outcome.out, "continuation = always"));
}

TEST_CASE("the attainable accuracy with the penalty of algorithm = adaptive: the tolerance named helps") {
    const RingDeck ring;
    Outcome outcome = ring.run({"omega_star=1e-20", "omega0=1e-20"});
    CHECK(Stop(ring.output, outcome).summary.at("status") == "attainable_accuracy");
    CHECK(!has(outcome.out, "mu0"));
    const std::string advice = "try a larger omega_star, such as ";
    const auto at = outcome.out.find(advice);
    REQUIRE(at != std::string::npos);
    const auto from = at + advice.size();
    outcome = ring.run({"omega_star=" + outcome.out.substr(from, outcome.out.find('\n', from) - from), "omega0=1e-20"});
    CHECK(outcome.code == 0);
}

TEST_CASE("converged is said of a boundary that slides where |grad E| is below omega_star, and not before") {
    const RingDeck ring;
    for (const char* shape : {"refine=0", "degree=2", "refine=1"})
        for (const char* motion : {"rotate 50", "translate 3 1", "scale 2 1"})
            for (const char* objective : {"deviation", "minimax"}) {
                const std::string keys_of_case = concat(shape, ", ", motion, ", ", objective);
                if (keys_of_case == "refine=0, rotate 50, minimax") continue;  // the next test
                CAPTURE(keys_of_case);
                const Outcome outcome =
                    ring.run({shape, "boundary outer=slide", concat("boundary inner=", motion),
                              concat("objective=", objective), "length_scale=1", "omega_star=1e-6"});
                CHECK(outcome.code == 0);
                const auto summary = summary_of(ring.output);
                CHECK((summary.at("status") == "converged") == has(outcome.out, "converged: "));
                CHECK((summary.at("status") == "no_visible_gain") == has(outcome.out, "settled: "));
                // High powers may end there.
                if (std::string(objective) == "minimax" && has(outcome.out, "settled: ")) continue;
                CHECK(summary.at("status") == "converged");
                const bool is_rounded = has(outcome.out, "what steps would gain is below the rounding of E");
                CHECK(number(summary, "gradient_norm") <= (is_rounded ? 1e-5 : 1e-6));
                CHECK(has(outcome.out, "above omega_star") == is_rounded);
            }
}

// The ring turns as a whole, and a high power has next to no curvature along that.
TEST_CASE("where the gain is no longer seen and |grad E| stays above omega_star, the run does not count as converged") {
    const RingDeck ring;
    const std::vector<std::string> keys = {"boundary outer=slide", "boundary inner=rotate 50", "objective=minimax"};
    const Outcome outcome = ring.run(keys);
    CHECK(outcome.code == 0);
    CHECK(summary_of(ring.output).at("status") == "no_visible_gain");
    CHECK(number(summary_of(ring.output), "gradient_norm") > AugmentedLagrangianParams().omega_star);
    CHECK(has(outcome.out, "settled: the last steps gained next to nothing, with |grad E| above omega_star: "));
    CHECK(!has(outcome.out, "converged"));
}

TEST_CASE("a rounding floor, a loop that ends as printed, an overflow and an interrupt say what to change") {
    const RingDeck ring;
    Outcome outcome = ring.run({"algorithm=paper", "mu0=1e14", "omega0=1e-12"});
    CHECK(Stop(ring.output, outcome).summary.at("status") == "attainable_accuracy");
    CHECK(Stop(ring.output, outcome).kind() == "unbalanced");
    CHECK(has(outcome.out, "try a smaller mu0, such as 1e+11"));

    outcome = ring.run({"algorithm=literal", "mu0=1", "omega0=1e-8"});
    CHECK(Stop(ring.output, outcome).summary.at("status") == "ended_as_printed");
    CHECK(Stop(ring.output, outcome).kind() == "off_target");
    CHECK(has(outcome.out, "try algorithm = paper"));

    outcome = ring.run({"algorithm=paper", "mu0=1e307"});
    CHECK(summary_of(ring.output).at("status") == "overflow");
    CHECK(has(outcome.out, "try a smaller mu0, such as 1000"));

    interrupt_flag = 1;
    outcome = ring.run();
    clear_interrupt();
    CHECK(Stop(ring.output, outcome).summary.at("status") == "interrupted");
    CHECK(Stop(ring.output, outcome).boundary() == "inner");
    CHECK(has(outcome.out, "it has gone 0 % of its way"));

    outcome = ring.run({"max_seconds=1e-9"});
    CHECK(outcome.code == 3);
    CHECK(Stop(ring.output, outcome).summary.at("status") == "interrupted");
    CHECK(summary_of(ring.output).at("certified_valid") == "yes");
    CHECK(has(outcome.out, "interrupted: max_seconds have passed: "));
    CHECK(has(outcome.out, "try max_seconds = 4e-09"));
    CHECK(ring.run({"max_seconds=1e9"}).code == 0);
}

TEST_CASE("converged but not certified: the worst element, beside its boundary") {
    const RingDeck ring(ring_mesh(16, 2, 3));
    const Outcome outcome = ring.run({"delta=1", "boundary inner=rotate 175"});
    CHECK(outcome.code == 4);
    const Stop stop(ring.output, outcome);
    CHECK(stop.kind() == "invalid");
    CHECK(has(outcome.out, "try delta = 0"));
    const auto least = scalars(stop.vtk, "certified_bound");
    CHECK(*std::min_element(least.begin(), least.end()) ==
          doctest::Approx(test::number(stop.summary, "certified_bound")));
}

// These endings are made: no small deck comes to them otherwise.
TEST_CASE("a line search that fails is told at the most distorted element, an overlap at its node or face") {
    const RingDeck ring;
    const Deck deck = read_deck(ring.deck, {"weight_exponent=1", "boundary inner=fixed"});
    Problem problem = make_problem(deck);
    set_functional(deck, problem);
    const Mesh& mesh = problem.mesh();
    Solution solution;
    solution.x = problem.ideal();
    solution.al.iterations.resize(2);
    solution.al.lambda.assign(problem.level->constraint->multipliers(), 0.0);
    solution.al.distortion.element_max.assign(mesh.element_count(), 1.0);
    solution.al.distortion.element_max[40] = 12.5;
    solution.certificate = certify(mesh, solution.x);
    const auto print = [&] {
        solution.diagnosis = diagnose(deck, problem, solution);
        std::FILE* const out = std::tmpfile();
        print_ending(out, deck, problem, solution, 0);
        return take_contents(out);
    };

    solution.al.status = Status::line_search_failed;
    solution.reached = 0.375;
    std::string text = print();
    CHECK(solution.diagnosis.kind == DiagnosisKind::distorted);
    CHECK(solution.diagnosis.element == 40);
    CHECK(has(text, concat("element ", mesh.file.element_id[40])));
    CHECK(has(text, " is the most distorted: eta 12.5, certified bound 1\n"));
    CHECK(has(text, "try weight_exponent = 0.5 or 0; refine = 1; a smaller motion (0.375 of this one was reached)\n"));

    solution.al.status = Status::stalled;  // all is fixed, but one node is not in its place
    const int outer = mesh.face(mesh.boundary_index("outer") == mesh.face_boundary[0] ? 0 : mesh.face_count() - 1)[0];
    point(solution.x, outer, 2)[0] += 0.01;
    text = print();
    CHECK(solution.diagnosis.kind == DiagnosisKind::off_target);
    CHECK(solution.diagnosis.node == outer);
    CHECK(!has(text, "of its way"));
    CHECK(has(text, "try boundary outer = slide or free, if its nodes need not keep their positions; "));
    solution.x = problem.ideal();

    solution.al.status = Status::converged;
    solution.injectivity.node = 5;
    solution.injectivity.reason = "the elements around node 6 overlap";
    solution.injectivity.position = centroid(mesh, solution.x, &solution.injectivity.node, 1);
    text = print();
    CHECK(solution.diagnosis.kind == DiagnosisKind::overlap);
    CHECK(solution.diagnosis.node == 5);
    CHECK(has(text, "the elements around node 6 overlap at " +
                        position_text(problem.frame.to_file(solution.injectivity.position).data(), 2) +
                        ": node 6 of boundary inner\n"));
    CHECK(has(text, "all elements valid, but NOT certified injective: certified bound "));

    solution.injectivity = {.certified = false, .reason = "face 1 crosses face 2, in the initial mesh too,"};
    text = print();
    CHECK(solution.diagnosis.kind == DiagnosisKind::none);
    CHECK(has(text, "NOT certified injective: face 1 crosses face 2, in the initial mesh too,:"));
    CHECK(has(text, "try another mesh file, where elements of this one lie over each other"));
    solution.injectivity.face = solution.injectivity.other_face = 0;
    CHECK(has(print(), concat("try contact = ", mesh.boundaries[mesh.face_boundary[0]], ", where two sides lie on")));
    solution.injectivity = {.certified = true, .reason = "", .overlap = 0.5};
    CHECK(has(print(), "certified valid and injective, but that boundaries in contact overlap by "));
}

TEST_CASE("stop.vtk goes when the run converges, and is not written with vtk = none") {
    const RingDeck ring;
    const std::string file = ring.output + "/stop.vtk";
    REQUIRE(ring.run({"max_al_iterations=1"}).code == 3);
    CHECK(std::filesystem::exists(file));
    const Outcome silent = ring.run({"max_al_iterations=1", "vtk=none"});
    CHECK(silent.code == 3);
    CHECK(!std::filesystem::exists(file));
    CHECK(!has(silent.out, "stop.vtk"));
    CHECK(summary_of(ring.output).at("diagnosis") == "off_target");
    REQUIRE(ring.run({"max_al_iterations=1"}).code == 3);
    const Outcome good = ring.run();
    CHECK(good.code == 0);
    CHECK(!std::filesystem::exists(file));
    CHECK(!has(good.out, "\ntry "));
    for (const std::string what : whats) CHECK(summary_of(ring.output).at("diagnosis" + what) == "none");
}

TEST_CASE("numbers beyond the range of double precision end a run as overflow, and no nan is written") {
    const RingDeck ring;
    for (const char* mu0 : {"1e290", "1e300", "1.7e308"})
        for (const char* algorithm : {"paper", "adaptive", "literal"}) {
            CAPTURE(mu0);
            CAPTURE(algorithm);
            const Outcome outcome = ring.run({concat("mu0=", mu0), concat("algorithm=", algorithm)});
            const std::string summary = text_of(ring.output + "/summary.txt");
            CHECK(!has(summary, "nan"));
            CHECK(!has(summary, "inf\n"));
            CHECK(!has(text_of(ring.output + "/history.csv"), "nan"));
            if (outcome.code == 0) continue;
            CHECK(outcome.code == 3);
            CHECK(has(summary, "status = overflow\n"));
            CHECK(has(outcome.out, "try a smaller mu0"));
        }
}
