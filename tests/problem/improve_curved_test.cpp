// Curved meshes that improve makes better with straight sides, and curves again.
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

TEST_CASE("a boundary that is fixed keeps its bits in a curved mesh that is made better, in any place and unit") {
    for (const double length : {1.0, 3.7e-3}) {
        Mesh mesh = straight_mesh(square_mesh(5));
        for (double& x : mesh.x) x = length * x + 11;
        const TemporaryFolder folder;
        const std::string file = folder.write("mesh.msh", msh_of(mesh));
        const Mesh read = mesh_of(file);
        REQUIRE(almesh_with({"improve", file, "output=" + folder.path("results"), "boundary all=fixed"}).code == 0);
        const Mesh after = mesh_of(folder.path("results/final.msh"));
        CHECK(after.x != read.x);
        for (const int i : read.faces)
            for (int a = 0; a < 2; ++a) CHECK(point(after.x, i, 2)[a] == point(read.x, i, 2)[a]);
    }
}

TEST_CASE("of a mesh of degree 2 with straight sides the vertices move, and the sides stay straight") {
    Mesh large = straight_mesh(square_mesh(5));
    for (double& x : large.x) x = 3.7 * x + 11;
    for (const Mesh& mesh : {straight_mesh(square_mesh(5)), large, straight_mesh(cube_mesh(3))}) {
        REQUIRE(certify(mesh, mesh.x).min_certified_bound > 1 - 1e-9);
        const TemporaryFolder folder;
        const std::string file = folder.write("mesh.msh", msh_of(mesh));
        const Outcome outcome = almesh_with({"improve", file, "output=" + folder.path("results"), "threads=1"});
        CHECK(outcome.code == 0);
        const Mesh after = mesh_of(folder.path("results/final.msh"));
        CHECK(least_corner_jacobian(after, after.x) > 1.1 * least_corner_jacobian(mesh, mesh.x));
        CHECK(certify(after, after.x).min_certified_bound > 1 - 1e-9);
        if (mesh.x != large.x) {  // there the boundary is no straight line to the last bit
            for (const int i : mesh.faces)
                for (int a = 0; a < mesh.dim; ++a)
                    if (const double x = point(mesh.x, i, mesh.dim)[a]; x == 0 || x == 1) CHECK(point(after.x, i, mesh.dim)[a] == x);
        }
        const std::vector<double> straight = straight_sided(after);
        for (std::size_t k = 0; k < straight.size(); ++k) CHECK(std::abs(after.x[k] - straight[k]) < 1e-12);
    }
}
