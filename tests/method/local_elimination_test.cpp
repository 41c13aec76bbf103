#include "method/local_elimination.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "method/newton.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Of Newton's method over the whole mesh: local minimisations have no bound.
LocalElimination after_much_work() {
    LocalElimination elimination;
    elimination.work_of_newton += 1e12;
    return elimination;
}

// A minimum with one node pushed out of its place.
struct Disturbed {
    Minimisation problem;
    AugmentedFunctional E = problem.functional(100);
    std::vector<double> minimum = problem.ideal, x, g;
    BlockCsr H = problem.distortion.hessian_pattern();
    double energy = 0;
    int node = problem.mesh.nodes() / 2;

    explicit Disturbed(const Mesh& mesh = cube_mesh(6), double push = 0.05)
        : problem(mesh, {{"top", "scale 1 1 1.2"}, {"sides", "scale 1 1 1.2"}}, Objective::squared) {
        Newton newton(problem.distortion.hessian_pattern(), {});
        newton.minimise(E, {.omega = 1e-9}, minimum);
        x = minimum;
        x[node * 3] += push;
        energy = E.energy(x);
        g.resize(x.size());
        E.gradient(x, g);
        E.hessian(x, HessianKind::projected, H);
    }
};

// At the identity map, where nothing is to be gained: which nodes move for a gradient that is made up.
int nodes_for(const Mesh& mesh, const std::vector<std::pair<int, double>>& gradient_at, bool from_coarser = false) {
    const Minimisation problem(mesh, {}, Objective::squared);
    const AugmentedFunctional E = problem.functional(100);
    std::vector<double> x = problem.ideal, g(x.size(), 0.0);
    for (const auto& [node, size] : gradient_at) g[node * mesh.dim] = size;
    BlockCsr H = problem.distortion.hessian_pattern();
    E.hessian(x, HessianKind::projected, H);
    double energy = E.energy(x);
    LocalElimination elimination;
    elimination.from_coarser = from_coarser;
    return elimination.eliminate(E, H, g, 0, x, energy).nodes;
}

// Nodes of a square or cube of k cells, `spacing` cells from each other and from the boundary.
std::vector<std::pair<int, double>> lattice(const Mesh& mesh, int k, int spacing) {
    std::vector<std::pair<int, double>> nodes;
    for (int i = 0; i < mesh.nodes(); ++i) {
        bool chosen = true;
        for (int a = 0; a < mesh.dim; ++a) {
            const double cell = mesh.x[i * mesh.dim + a] * k;
            const int whole = static_cast<int>(std::lround(cell));
            chosen = chosen && std::abs(cell - whole) < 1e-9 && whole % spacing == 0 && whole > 0 && whole < k;
        }
        if (chosen) nodes.emplace_back(i, 1.0);
    }
    return nodes;
}

}  // namespace

TEST_CASE("a node out of its place goes back, and nodes far away stay where they are") {
    Disturbed at;
    const double disturbed = at.energy, least = at.E.energy(at.minimum);
    std::vector<double> x = at.x;
    const LocalElimination::Result relaxed = after_much_work().eliminate(at.E, at.H, at.g, 0, x, at.energy);
    CHECK(relaxed.steps > 0);
    CHECK(relaxed.nodes > 1);
    CHECK(relaxed.nodes < at.problem.mesh.nodes());
    CHECK(at.energy == at.E.energy(x));
    CHECK(at.energy - least < 1e-6 * (disturbed - least));
    int still = 0;
    for (std::size_t i = 0; i < x.size(); i += 3) still += x[i] == at.x[i] && x[i + 1] == at.x[i + 1];
    CHECK(still >= at.problem.mesh.nodes() - relaxed.nodes);
}

TEST_CASE("the energy never grows, and little is done where nothing is to be gained") {
    Disturbed at;
    std::vector<double> x = at.x;
    const double before = at.energy;
    // No step is worth another.
    const LocalElimination::Result once = after_much_work().eliminate(at.E, at.H, at.g, 1e3, x, at.energy);
    CHECK(once.steps == 1);
    CHECK(at.energy < before);
    std::vector<double> g(x.size());
    at.E.gradient(at.minimum, g);
    double energy = at.E.energy(at.minimum);
    const double least = energy;
    after_much_work().eliminate(at.E, at.H, g, 0, at.minimum, energy);
    CHECK(energy <= least);
    CHECK(energy == at.E.energy(at.minimum));
}

TEST_CASE("local elimination has the same bits for any number of threads") {
    const Mesh mesh = raise_degree(cube_mesh(4), 2);  // in the part too, enough for several threads
    const auto results = for_threads([&] {
        Disturbed at(mesh, 0.02);
        after_much_work().eliminate(at.E, at.H, at.g, 0, at.x, at.energy);
        return at.x;
    });
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}

TEST_CASE("nodes move with two layers of neighbours: those with nine tenths of what can be gained, or a hundredth") {
    const Mesh square = square_mesh(40);  // 1681 nodes
    std::vector<std::pair<int, double>> at = lattice(square, 40, 8);
    REQUIRE(at.size() == 16);
    const int one = nodes_for(square, {at[0]});
    CHECK(one == 19);  // six neighbours, and twelve around them
    for (const int third : {1, 8, 12}) {  // the first two have 0.989, 0.92 and 0.885 of all
        std::vector<std::pair<int, double>> few(at.begin(), at.begin() + 3);
        few[0].second = std::sqrt(60), few[1].second = std::sqrt(32), few[2].second = std::sqrt(third);
        CHECK(nodes_for(square, few) == (third < 10 ? 2 : 3) * one);
    }
    std::vector<std::pair<int, double>> many = lattice(square, 40, 6);
    REQUIRE(many.size() == 36);
    CHECK(nodes_for(square, many) == 16 * one);
}

TEST_CASE("a local minimisation has at most part of the nodes: less if curved or from a coarser mesh") {
    const Mesh curved = raise_degree(square_mesh(20), 2), large = cube_mesh(16);
    for (const auto& [mesh, part, k, spacing, from_coarser] :
         {std::tuple(&curved, 0.1, 20, 4, false), std::tuple(&large, 0.07, 16, 2, false),
          std::tuple(&large, 0.07, 16, 3, false), std::tuple(&large, 0.05, 16, 4, true)}) {
        const int nodes = nodes_for(*mesh, lattice(*mesh, k, spacing), from_coarser);
        CHECK(nodes <= part * mesh->nodes());
        CHECK(nodes > 0.25 * part * mesh->nodes());
    }
}

// From 8000 unknowns on conjugate gradients solve the local systems.
TEST_CASE("large local systems are solved so well that three steps are enough") {
    constexpr int k = 33;
    const Minimisation problem(cube_mesh(k), {}, Objective::squared);
    const AugmentedFunctional E = problem.functional(100);
    std::vector<double> x = problem.ideal, g(x.size());
    std::vector<std::pair<int, double>> pushed = lattice(problem.mesh, k, 4);
    pushed.resize(43);
    for (const auto& [node, size] : pushed) x[3 * node] += 0.25 * size / k;
    const double least = E.energy(problem.ideal), before = E.energy(x);
    E.gradient(x, g);
    BlockCsr H = problem.distortion.hessian_pattern();
    E.hessian(x, HessianKind::projected, H);
    double energy = before;
    const LocalElimination::Result relaxed = after_much_work().eliminate(E, H, g, 0, x, energy);
    REQUIRE(3 * relaxed.nodes >= 8000);
    CHECK(relaxed.steps <= 3);
    CHECK(energy - least < 1e-8 * (before - least));
}

TEST_CASE("local minimisations begin after the thirteenth step, or the first after a subproblem of more than ten") {
    const Disturbed at;
    LocalElimination elimination;
    const auto is_due = [&](int step, double gained) { return elimination.is_due(step, at.H, at.g, gained); };
    for (const int steps : {10, 11, 13})
        for (int times = 0; times < 2; ++times) {
            for (int step = 1; step <= steps; ++step) CHECK(is_due(step, 1e9) == (step > 12));
            CHECK(is_due(1, 1e9) == (steps > 10));  // of the next subproblem
            elimination.was_hard = elimination.is_hard = false;
        }
    elimination.from_coarser = true;
    CHECK(is_due(1, 0));
    CHECK_FALSE(is_due(1, 1e9));
}

TEST_CASE("local minimisations wait while they have done more than a sixth of the work over the whole mesh") {
    Disturbed at;
    LocalElimination elimination;
    const auto is_due = [&] { return elimination.is_due(13, at.H, at.g, 0); };
    REQUIRE(is_due());
    elimination.eliminate(at.E, at.H, at.g, 0, at.x, at.energy);
    CHECK_FALSE(is_due());
    const double work = elimination.work;
    CHECK(work > 2 * at.E.distortion.hessian_work() * 0.1);  // elements around the node, in some steps
    elimination.work_of_newton += 5.5 * work;
    CHECK_FALSE(is_due());
    elimination.was_hard = elimination.is_hard = false;  // the run goes on
    CHECK_FALSE(is_due());
    CHECK_FALSE(elimination.is_due(1000, at.H, at.g, 0));
}

TEST_CASE("a dear local minimisation ends when all have done more than a quarter of the work over the whole mesh") {
    const Disturbed at(cube_mesh(6), 0.12);
    const auto relax = [&](LocalElimination& elimination) {
        std::vector<double> x = at.x;
        double energy = at.energy;
        return elimination.eliminate(at.E, at.H, at.g, 0, x, energy).steps;
    };
    LocalElimination cheap;  // linear elements, nothing known of a coarser mesh
    CHECK(relax(cheap) > 2);
    LocalElimination unbounded = after_much_work();
    unbounded.from_coarser = true;
    const int steps = relax(unbounded);
    REQUIRE(steps > 2);
    const double work = unbounded.work;
    for (const double part : {1.0, 0.5, 0.0}) {  // of that work, which the bound leaves room for
        CAPTURE(part);
        LocalElimination bounded;
        bounded.from_coarser = true;
        bounded.work_of_newton += part * work / 0.26;
        const int fewer = relax(bounded);
        CHECK((fewer == steps) == (part == 1));
        if (part == 0) CHECK(fewer == 1);
        CHECK(relax(bounded) == 1);  // what was done before counts
    }
}

// Disturbed so that what is left to gain is around one node.
TEST_CASE("from a coarser mesh nodes are relaxed from the first step on, while steps gain less than ten times that") {
    Disturbed at(cube_mesh(6), 0.12);
    const auto steps_from = [&](bool from_coarser, double push) {
        std::vector<double> x = at.minimum;
        x[at.node * 3] += push;
        std::vector<int> nodes;
        Newton newton(at.problem.distortion.hessian_pattern(), {});
        const NewtonParams params{.omega = 1e-9, .first = HessianKind::full, .from_coarser = from_coarser};
        newton.minimise(at.E, params, x, [&](const NewtonStep& step) { nodes.push_back(step.local.nodes); });
        return nodes;
    };
    for (const int nodes : steps_from(false, 0.12)) CHECK(nodes == 0);
    const std::vector<int> relaxed = steps_from(true, 0.12);
    CHECK(*std::max_element(relaxed.begin(), relaxed.end()) > 0);
    CHECK(relaxed.size() < steps_from(false, 0.12).size());
    for (const int nodes : steps_from(true, 1e-6)) CHECK(nodes == 0);  // quadratic convergence
}

TEST_CASE("nodes hold up a step that gained less than ten times what they could reach alone") {
    const Disturbed at;
    double alone = 0;  // sum over nodes of |g_i|^2 / (2 h_i)
    for (int i = 0; i < at.H.n; ++i) {
        const double* const block = at.H.block(at.H.find(i, i));
        const double h = (block[0] + block[4] + block[8]) / 3;
        for (int a = 0; a < 3; ++a) alone += at.g[3 * i + a] * at.g[3 * i + a] / (2 * h);
    }
    CHECK(LocalElimination::holds_up(at.H, at.g, 9.9 * alone));
    CHECK_FALSE(LocalElimination::holds_up(at.H, at.g, 10.1 * alone));
}

// Nodes pushed a little, and one nearly through its elements.
TEST_CASE("few nodes that hold up a local minimisation are minimised over first") {
    constexpr int k = 8;
    const Minimisation problem(cube_mesh(k), {}, Objective::squared);
    const AugmentedFunctional E = problem.functional(100);
    const auto run = [&] {
        std::vector<double> x = problem.ideal, g(x.size());
        const auto pushed = lattice(problem.mesh, k, 2);
        for (const auto& [node, size] : pushed) x[3 * node] += 0.2 * size / k;
        x[3 * pushed[pushed.size() / 2].first] += 0.7 / k;
        E.gradient(x, g);
        BlockCsr H = problem.distortion.hessian_pattern();
        E.hessian(x, HessianKind::projected, H);
        double energy = E.energy(x);
        CHECK(after_much_work().eliminate(E, H, g, 0, x, energy).steps <= 4);  // 8 if all move at once
        return x;
    };
    const auto results = for_threads(run);
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}
