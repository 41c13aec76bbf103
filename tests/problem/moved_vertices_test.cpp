// Curved meshes that improve makes better by their vertices alone.
#include "problem/improve.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "check/certificate.hpp"
#include "check/scaled_jacobian.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Unit cube or square of degree 2 with straight sides, its vertices inside moved.
Mesh straight_mesh(Mesh mesh) {
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, mesh.dim);
        double wave = 0.06 * std::sin(9 * x[0] + 13 * x[1]);
        for (int a = 0; a < mesh.dim; ++a) wave *= 4 * x[a] * (1 - x[a]);
        for (int a = 0; a < mesh.dim; ++a) x[a] += (a == 1 ? -wave : wave);
    }
    return raise_degree(mesh, 2);
}

}  // namespace

TEST_CASE("of a mesh of degree 2 with straight sides the vertices move, and the sides stay straight") {
    Mesh large = straight_mesh(square_mesh(5));
    for (double& x : large.x) x *= 3;
    for (const Mesh& mesh : {straight_mesh(square_mesh(5)), large, straight_mesh(cube_mesh(3))}) {
        REQUIRE(certify(mesh, mesh.x).min_certified_bound > 1 - 1e-9);
        const TemporaryFolder folder;
        const std::string file = folder.write("mesh.msh", msh_of(mesh));
        const Outcome outcome = almesh_with({"improve", file, "output=" + folder.path("results"), "threads=1"});
        CHECK(outcome.code == 0);
        const Mesh after = mesh_of(folder.path("results/final.msh"));
        CHECK(least_corner_jacobian(after, after.x) > 1.1 * least_corner_jacobian(mesh, mesh.x));
        CHECK(certify(after, after.x).min_certified_bound > 1 - 1e-9);
        const std::vector<double> straight = straight_sided(after);
        for (std::size_t k = 0; k < straight.size(); ++k) CHECK(std::abs(after.x[k] - straight[k]) < 1e-13);
    }
}
