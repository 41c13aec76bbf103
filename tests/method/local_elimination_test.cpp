#include "method/local_elimination.hpp"

#include <doctest/doctest.h>

#include "method/newton.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

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
        newton.minimise(E, {.omega = 1e-9, .reach = {}}, minimum);
        x = minimum;
        x[node * 3] += push;
        energy = E.energy(x);
        g.resize(x.size());
        E.gradient(x, g);
        E.hessian(x, HessianKind::projected, H);
    }
};

}  // namespace

TEST_CASE("a node out of its place goes back, and nodes far away stay where they are") {
    Disturbed at;
    const double disturbed = at.energy, least = at.E.energy(at.minimum);
    std::vector<double> x = at.x;
    const LocalElimination::Result relaxed = LocalElimination().eliminate(at.E, at.H, at.g, 0, x, at.energy);
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
    const LocalElimination::Result once = LocalElimination().eliminate(at.E, at.H, at.g, 1e3, x, at.energy);
    CHECK(once.steps == 1);
    CHECK(at.energy < before);
    std::vector<double> g(x.size());
    at.E.gradient(at.minimum, g);
    double energy = at.E.energy(at.minimum);
    const double least = energy;
    LocalElimination().eliminate(at.E, at.H, g, 0, at.minimum, energy);
    CHECK(energy <= least);
    CHECK(energy == at.E.energy(at.minimum));
}

TEST_CASE("local elimination has the same bits for any number of threads") {
    const Mesh mesh = raise_degree(cube_mesh(4), 2);  // in the part too, enough for several threads
    const auto results = for_threads([&] {
        Disturbed at(mesh, 0.02);
        LocalElimination().eliminate(at.E, at.H, at.g, 0, at.x, at.energy);
        return at.x;
    });
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}
