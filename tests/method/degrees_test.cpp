// Every degree that is promised: curving and moving, in 2D and 3D, to a certified mesh with the boundary in place.
#include <doctest/doctest.h>

#include "check/certificate.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

void check_solved(const Minimisation& problem) {
    std::vector<double> x;
    const AlResult result = problem.solve({}, x);
    CAPTURE(problem.mesh.degree);
    CHECK(std::string(to_string(result.status)) == "converged");
    CHECK(result.iterations.back().projected_constraint_norm <= 1e-8);
    CHECK(certify(problem.mesh, x).valid);
}

}  // namespace

TEST_CASE("a ring is curved and its inner circle turned, degrees 1 to 6") {
    for (int degree = 1; degree <= 6; ++degree) {
        const Mesh mesh = raise_degree(ring_mesh(10, 3, 4), degree);
        for (const Objective objective : objectives) {
            const Minimisation problem(
                mesh, {{"inner", "circle 0 0 1; rotate 20 about 0 0"}, {"outer", "circle 0 0 4"}}, objective);
            check_solved(problem);
        }
    }
}

TEST_CASE("the top of a cube is moved and turned, degrees 1 to 4") {
    for (int degree = 1; degree <= 4; ++degree) {
        const Mesh mesh = raise_degree(cube_mesh(1), degree);
        const std::string turn = "rotate 15 axis 0 0 1 about 0.5 0.5 0; translate 0.2 0.1 0.3";
        const Minimisation problem(mesh, {{"bottom", turn}, {"sides", turn}, {"top", turn}}, Objective::deviation);
        check_solved(problem);
    }
}

// Between the points of a quadrature an element can fold unseen; the nodes among the points stop it.
TEST_CASE("a large motion in high degree stays valid, both objectives") {
    for (int degree : {2, 4, 6})
        for (const Objective objective : objectives) {
            const Mesh mesh = raise_degree(ring_mesh(16, 4, 8), degree);
            const Minimisation problem(mesh, {{"inner", "translate 4.5 0"}}, objective);
            check_solved(problem);
        }
}
