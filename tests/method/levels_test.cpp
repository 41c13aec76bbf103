#include "method/levels.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/mesh.hpp"
#include "support/endless.hpp"
#include "support/minimisation.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Of a mesh moved to x, with multipliers on its boundary (trace nodes x dim).
CoarseSolution solution_of(const Minimisation& from, const std::vector<double>& x, const std::vector<double>& lambda) {
    auto level = std::make_unique<Level>();
    level->mesh = from.mesh;
    level->ideal = from.ideal;
    level->constraint =
        std::make_unique<Dirichlet>(level->mesh, level->ideal, target_of(level->mesh, {}), TargetKind::least_squares);
    CoarseSolution solution{std::move(level), x, std::vector<double>(x.size(), 0.0), 50};
    for (std::size_t i = 0; i < x.size(); ++i) solution.displacement[i] -= from.ideal[i];
    const std::size_t dim = from.mesh.dim;
    for (std::size_t k = 0; k < lambda.size(); ++k)
        solution.multipliers[from.constraint.nodes()[k / dim] * dim + k % dim] = lambda[k];
    return solution;
}

double dot_product(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

int count_of(const std::string& folder, const std::string& key) {
    return static_cast<int>(number(summary_of(folder), key));
}

std::vector<std::vector<std::string>> rows_of_kind(const std::string& folder, const std::string& kind) {
    auto rows = csv_rows(text_of(folder + "/history.csv"));
    std::erase_if(rows, [&](const auto& row) { return row[0] != kind; });
    return rows;
}

}  // namespace

// E_fine of an interpolated map is E_coarse of the map, so its derivative along interpolated motions is that on the
// coarse mesh, if the multipliers put the same forces on the boundary.
TEST_CASE("distortion and multipliers do the same work on both meshes along every motion of the coarse one") {
    for (const Mesh& mesh : {ring_mesh(12, 3, 6), cube_mesh(2)}) {
        const Minimisation coarse(mesh, {}, Objective::squared), fine(refine(mesh, 1), {}, Objective::squared);
        const std::vector<double> x = wavy(coarse.ideal, mesh.dim, 0.1);
        AugmentedFunctional E = coarse.functional(0);
        for (std::size_t k = 0; k < E.lambda.size(); ++k) E.lambda[k] = 3 * std::sin(1.0 + k);
        std::vector<double> g(x.size()), fine_x, fine_g(fine.ideal.size());
        E.gradient(x, g);

        const AlStart start = start_from(solution_of(coarse, x, E.lambda), fine.level, fine_x);
        CHECK(start.mu == 5000);
        AugmentedFunctional fine_E = fine.functional(0);
        REQUIRE(start.lambda.size() == fine_E.lambda.size());
        fine_E.lambda = start.lambda;
        fine_E.gradient(fine_x, fine_g);
        for (int k = 0; k < 5; ++k) {
            std::vector<double> v(x.size());
            for (std::size_t i = 0; i < v.size(); ++i) v[i] = std::cos(k + 0.7 * static_cast<double>(i));
            const std::vector<double> fine_v = prolong(coarse.mesh, coarse.ideal, fine.mesh, fine.ideal, v);
            CHECK(dot_product(fine_g, fine_v) == doctest::Approx(dot_product(g, v)).epsilon(1e-11));
        }
    }
}

TEST_CASE("without a coarse solution, or with one that inverts an element, the start is the identity map") {
    const Minimisation coarse(ring_mesh(12, 3, 6), {}, Objective::squared),
        fine(refine(coarse.mesh, 1), {}, Objective::squared);
    const std::vector<double> lambda(coarse.constraint.multipliers(), 1.0);
    std::vector<double> inverted = coarse.ideal;
    for (std::size_t i = 0; i < inverted.size(); i += 2) inverted[i] *= -1;
    const CoarseSolution none, folded = solution_of(coarse, inverted, lambda);
    for (const CoarseSolution* solution : {&none, &folded}) {
        std::vector<double> x;
        const AlStart start = start_from(*solution, fine.level, x);
        CHECK(x == fine.ideal);
        CHECK(start.lambda.empty());
        CHECK(start.mu == 0);
        CHECK_FALSE(start.from_coarser);
    }
    std::vector<double> x;
    const AlStart start = start_from(solution_of(coarse, coarse.ideal, lambda), fine.level, x);
    CHECK(!start.lambda.empty());
    CHECK(start.from_coarser);
}

TEST_CASE("the penalty carried over has a limit, but never falls") {
    const Minimisation coarse(ring_mesh(12, 3, 6), {}, Objective::squared),
        fine(refine(coarse.mesh, 1), {}, Objective::squared);
    const std::vector<double> no_multipliers(coarse.constraint.multipliers(), 0.0);
    CoarseSolution solution = solution_of(coarse, coarse.ideal, no_multipliers);
    std::vector<double> x;
    for (const auto& [before, after] : {std::pair(1e3, 1e5), std::pair(3e5, 1e7), std::pair(1e8, 1e8)}) {
        solution.mu = before;
        CHECK(start_from(solution, fine.level, x).mu == after);
    }
}

TEST_CASE("refined twice, a coarse start takes at most 5 steps on the deck's mesh, and reaches the same mesh") {
    for (const char* objective : {"objective=squared", "objective=deviation"}) {
        const RingDeck ring;
        REQUIRE(ring.run({"refine=2", "weight_exponent=1", objective, "start=identity"}).code == 0);
        const int from_identity = count_of(ring.output, "newton_iterations");
        CHECK(count_of(ring.output, "coarse_newton_iterations") == 0);
        CHECK(rows_of_kind(ring.output, "coarse").empty());
        const Mesh expected = mesh_of(ring.output + "/final.msh");

        const Outcome outcome = ring.run({"refine=2", "weight_exponent=1", objective});
        REQUIRE(outcome.code == 0);
        CHECK(count_of(ring.output, "newton_iterations") <= 5);
        CHECK(count_of(ring.output, "newton_iterations") <= from_identity - 3);
        const auto coarse = rows_of_kind(ring.output, "coarse");
        REQUIRE(coarse.size() == 2);
        CHECK(std::stoi(coarse[0][12]) + std::stoi(coarse[1][12]) == count_of(ring.output, "coarse_newton_iterations"));
        CHECK(coarse[0][27] == "48");
        CHECK(coarse[0][14] == "finer mesh");
        CHECK(has(outcome.out, "48 nodes\n"));
        CHECK(has(outcome.out, " on coarser meshes) in "));
        CHECK(number(summary_of(ring.output), "time_coarse") <= number(summary_of(ring.output), "time_total"));
        const Mesh mesh = mesh_of(ring.output + "/final.msh");
        double largest = 0;
        for (std::size_t i = 0; i < mesh.x.size(); ++i)
            largest = std::max(largest, std::abs(mesh.x[i] - expected.x[i]));
        CHECK(largest < 1e-6);
    }
}

TEST_CASE("a coarse start in 3D, and with curved elements") {
    const TemporaryFolder folder;
    folder.write("cube.msh", msh_of(cube_mesh(2)));
    const std::string deck = folder.write("cube.deck",
                                          "mesh = cube.msh\nthreads = 1\nrefine = 1\nboundary bottom = scale 1 1 1.5\n"
                                          "boundary top = scale 1 1 1.5\nboundary sides = scale 1 1 1.5\n"
                                          "output = " +
                                              folder.path("out") + "\n");
    REQUIRE(almesh_with({deck}).code == 0);
    CHECK(count_of(folder.path("out"), "newton_iterations") <= 4);
    const RingDeck ring;
    REQUIRE(ring.run({"degree=2", "refine=1", "start=identity"}).code == 0);
    const int from_identity = count_of(ring.output, "newton_iterations");
    REQUIRE(ring.run({"degree=2", "refine=1"}).code == 0);
    CHECK(count_of(ring.output, "newton_iterations") < from_identity);
    CHECK(count_of(ring.output, "coarse_newton_iterations") > 0);
}

TEST_CASE("coarse meshes are solved with the deck's forcing") {
    const RingDeck ring;
    const std::vector<std::string> settings = {"refine=1", "solver=gmres"};
    std::vector<std::string> energy;
    for (const char* forcing : {"forcing=fixed", "forcing=auto"}) {
        std::vector<std::string> all = settings;
        all.push_back(forcing);
        REQUIRE(ring.run(all).code == 0);
        energy.push_back(rows_of_kind(ring.output, "coarse")[0][3]);
    }
    CHECK(std::stod(energy[0]) == doctest::Approx(std::stod(energy[1])).epsilon(1e-4));
    CHECK(energy[0] != energy[1]);
}

TEST_CASE("which decks start coarse") {
    const RingDeck ring;
    const auto coarse_rows = [&](const std::vector<std::string>& settings) {
        REQUIRE(ring.run(settings).code == 0);
        return rows_of_kind(ring.output, "coarse").size();
    };
    CHECK(coarse_rows({}) == 0);  // not refined
    CHECK(coarse_rows({"refine=1"}) == 1);
    CHECK(coarse_rows({"refine=1", "algorithm=paper"}) == 0);  // the paper's tables
    CHECK(coarse_rows({"refine=1", "algorithm=paper", "start=coarse"}) == 1);
    CHECK(coarse_rows({"refine=1", "start=identity"}) == 0);
    CHECK(coarse_rows({"degree=3"}) == 2);
    CHECK(coarse_rows({"degree=3", "refine=2"}) == 4);
    CHECK(coarse_rows({"degree=4"}) == 2);  // 1 and 2
    CHECK(coarse_rows({"degree=3", "start=identity"}) == 0);
}

TEST_CASE("the algorithm as printed does not start coarse") {
    const RingDeck ring;
    const Outcome outcome = ring.run({"refine=1", "algorithm=literal", "start=coarse"});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.error, "command line: start = coarse does not go with algorithm = literal"));
}

TEST_CASE("where the coarse mesh fails, the next one starts from the identity map") {
    const RingDeck ring;
    const Outcome outcome = ring.run({"refine=1", "max_newton_iterations=1", "continuation=never"});
    CHECK(outcome.code == 3);
    CHECK(has(outcome.out, "48 nodes, not used\n"));
    CHECK(rows_of_kind(ring.output, "coarse")[0][14] == "dropped");
    const auto al = rows_of_kind(ring.output, "al");
    CHECK(std::stod(al[0][11]) == doctest::Approx(1).epsilon(1e-14));  // max eta of the start
}

TEST_CASE("a coarse start gives the same files for any number of threads") {
    const int before = max_threads();
    const RingDeck ring(ring_mesh(16, 4, 6), "refine = 3\n");
    std::vector<std::string> mesh;
    std::vector<std::vector<std::vector<std::string>>> history;
    for (int threads : {1, 2, 3, 8}) {
        REQUIRE(ring.run({"threads=" + std::to_string(threads)}).code == 0);
        mesh.push_back(text_of(ring.output + "/final.msh"));
        history.push_back(history_without_times(ring.output));
        CHECK(mesh.back() == mesh[0]);
        CHECK(history.back() == history[0]);
    }
    set_threads(before);
}

TEST_CASE("from a lower degree, a start is taken that is nearer to the target than halfway") {
    const Mesh mesh = ring_mesh(12, 3, 6);
    const Minimisation coarse(mesh, {}, Objective::squared),
        fine(raise_degree(mesh, 2), {{"inner", "translate 1 0"}}, Objective::squared);
    const std::vector<double> lambda(coarse.constraint.multipliers(), 0.0);
    for (const double way : {0.3, 0.45, 0.55, 0.7}) {
        std::vector<double> x, reached = coarse.ideal;
        for (int i = 0; i < mesh.nodes(); ++i)
            if (std::hypot(mesh.x[2 * i], mesh.x[2 * i + 1]) < 1.5) reached[2 * i] += way;
        const AlStart start = start_from(solution_of(coarse, reached, lambda), fine.level, x);
        CHECK((x == fine.ideal) == (way < 0.5));
        CHECK(start.lambda.empty() == (way < 0.5));
    }
}

TEST_CASE("a coarser mesh that is worth little is given up after 20 steps, at once") {
    std::vector<Stage> stages;
    Timings time;
    MethodParams params;
    params.schedule.max_newton_iterations = 50;
    solve_coarser(
        2,
        [](int k) {
            std::unique_ptr<Level> level = endless_level();
            level->is_worth_little = k == 0;
            level->constraint_at = {};
            return level;
        },
        params, time, [&](const Stage& stage) { stages.push_back(stage); });
    REQUIRE(stages.size() == 2);
    CHECK(stages[0].newton_iterations == 20);
    CHECK(stages[1].newton_iterations == 50);
}
