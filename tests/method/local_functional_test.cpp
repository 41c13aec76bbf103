#include "method/local_functional.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "energy/simd_energy.hpp"
#include "method/functional.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Every third node moves: inside and on the boundary.
std::vector<char> some_nodes(int count) {
    std::vector<char> moves(count, 0);
    for (int i = 0; i < count; i += 3) moves[i] = 1;
    return moves;
}

// Small, and different for every coordinate.
double shift(std::size_t i) { return 0.01 * std::sin(1.0 + static_cast<double>(i)); }

std::vector<double> moved(std::vector<double> x, const std::vector<char>& moves) {
    const std::size_t dim = x.size() / moves.size();
    for (std::size_t i = 0; i < x.size(); ++i)
        if (moves[i / dim]) x[i] += shift(i);
    return x;
}

}  // namespace

TEST_CASE("a local functional's energy, gradient and Hessian are those of the functional, for the nodes that move") {
    for (const Mesh& mesh : {raise_degree(ring_mesh(8, 2, 3), 2), cube_mesh(2)}) {
        const std::map<std::string, std::string> ring = {{"inner", "translate 0.1 0"}},
                                                 cube = {{"top", "scale 1 1 1.2"}, {"sides", "scale 1 1 1.2"}};
        const Minimisation problem(mesh, mesh.dim == 2 ? ring : cube, Objective::squared);
        SimdEnergy weighted(problem.mesh, problem.ideal, {.weight_exponent = 0.5});
        const std::vector<double> lambda(problem.constraint.multipliers(), 0.3);
        const AugmentedFunctional E{weighted, problem.constraint, lambda, 50};
        const std::vector<char> moves = some_nodes(problem.mesh.nodes());
        const std::unique_ptr<LocalFunctional> local_part = E.part(problem.ideal, moves);
        LocalFunctional& local = *local_part;

        // At the start and away from it, in the numbers of the local functional.
        const std::vector<double> x = moved(problem.ideal, moves);
        std::vector<double> number(problem.ideal.size()), y = local.read(problem.ideal), of_mesh(number.size(), -1.0);
        for (std::size_t i = 0; i < y.size(); ++i) y[i] = static_cast<double>(i);
        local.write(y, of_mesh);  // place in the local functional of every coordinate that moves
        y = local.read(problem.ideal);
        for (std::size_t i = 0; i < x.size(); ++i) {
            CHECK((of_mesh[i] >= 0) == static_cast<bool>(moves[i / problem.mesh.dim]));
            if (of_mesh[i] >= 0) y[static_cast<std::size_t>(of_mesh[i])] = x[i];
        }
        CHECK(local.energy(y) - local.energy(local.read(problem.ideal)) ==
              doctest::Approx(E.energy(x) - E.energy(problem.ideal)).epsilon(1e-10));

        std::vector<double> g(y.size()), whole(x.size());
        local.gradient(y, g);
        E.gradient(x, whole);
        std::size_t moving = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (of_mesh[i] < 0) continue;
            ++moving;
            CHECK(g[static_cast<std::size_t>(of_mesh[i])] == doctest::Approx(whole[i]).epsilon(1e-10).scale(1));
        }
        CHECK(y.size() == moving);

        // The columns of the Hessian of nodes that move, from those of the functional.
        BlockCsr H = local.hessian_pattern(), full = weighted.hessian_pattern();
        local.hessian(y, HessianKind::full, H);
        E.hessian(x, HessianKind::full, full);
        std::vector<double> v(y.size(), 0.0), Hv(y.size()), w(x.size(), 0.0), Hw(x.size());
        for (std::size_t i = 0; i < x.size(); ++i)
            if (of_mesh[i] >= 0) w[i] = v[static_cast<std::size_t>(of_mesh[i])] = shift(2 * i);
        multiply(H, v.data(), Hv.data());
        multiply(full, w.data(), Hw.data());
        for (std::size_t i = 0; i < x.size(); ++i)
            if (of_mesh[i] >= 0)
                CHECK(Hv[static_cast<std::size_t>(of_mesh[i])] == doctest::Approx(Hw[i]).epsilon(1e-10).scale(1));
    }
}

TEST_CASE("a part of a local functional is the part of the functional, in the numbers of the local one") {
    const Minimisation problem(cube_mesh(3), {{"top", "scale 1 1 1.2"}, {"sides", "scale 1 1 1.2"}},
                               Objective::squared);
    const AugmentedFunctional E = problem.functional(50);
    const int nodes = problem.mesh.nodes();
    const std::unique_ptr<LocalFunctional> local_part = E.part(problem.ideal, some_nodes(nodes));
    const LocalFunctional& local = *local_part;
    std::vector<double> x = moved(problem.ideal, some_nodes(nodes)), y = local.read(x);
    std::vector<char> inner(local.nodes(), 0), of_mesh(nodes, 0);
    inner[1] = inner[2] = inner[6] = 1;
    std::vector<double> is_inside(x.size(), 0.0), of_local(y.size(), 0.0);
    for (std::size_t i = 0; i < of_local.size(); ++i) of_local[i] = inner[i / 3];
    local.write(of_local, is_inside);
    for (int i = 0; i < nodes; ++i) of_mesh[i] = is_inside[3 * i] != 0;
    const auto part = local.part(y, inner);
    const std::unique_ptr<LocalFunctional> direct_part = E.part(x, of_mesh);
    const LocalFunctional& direct = *direct_part;
    REQUIRE(part->nodes() == 3);
    std::vector<double> z = part->read(y), g(z.size()), expected(z.size());
    CHECK(z == direct.read(x));
    for (double& coordinate : z) coordinate += 0.01;
    const std::vector<double> z0 = direct.read(x);
    CHECK(part->energy(z) - part->energy(z0) == doctest::Approx(direct.energy(z) - direct.energy(z0)).epsilon(1e-10));
    part->gradient(z, g);
    direct.gradient(z, expected);
    for (std::size_t i = 0; i < g.size(); ++i) CHECK(g[i] == doctest::Approx(expected[i]).epsilon(1e-10).scale(1));
    part->write(z, y);
    direct.write(z, x);
    CHECK(y == local.read(x));
}

TEST_CASE("a local functional knows no nodes but those that move, and inverted elements have infinite energy") {
    const Minimisation problem(ring_mesh(8, 2, 3), {}, Objective::squared);
    const AugmentedFunctional E = problem.functional(10);
    std::vector<char> moves(problem.mesh.nodes(), 0);
    moves[0] = 1;
    const std::unique_ptr<LocalFunctional> local_part = E.part(problem.ideal, moves);
    LocalFunctional& local = *local_part;
    CHECK(local.read(problem.ideal) == std::vector<double>{problem.ideal[0], problem.ideal[1]});
    BlockCsr H = local.hessian_pattern();
    CHECK(H.n == 1);
    CHECK(H.col == std::vector<int>{0});
    std::vector<double> x = problem.ideal, y = local.read(problem.ideal);
    for (double& value : y) value = -3 * value;
    local.write(y, x);
    CHECK(x[0] == -3 * problem.ideal[0]);
    CHECK(x[2] == problem.ideal[2]);
    y = local.read(problem.ideal);
    y[0] += 100;  // the node far outside its elements
    CHECK(std::isinf(local.energy(y)));
}
