// The energy on meshes of hexahedra, prisms, pyramids and tetrahedra.
#include <doctest/doctest.h>

#include <cmath>

#include "energy/group_energy.hpp"
#include "mesh/lagrange.hpp"
#include "support/energy_checks.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// One element of each type, of degree 1 to 4, and some meshes of degree 1 and 2.
std::vector<Mesh> meshes() {
    std::vector<Mesh> meshes;
    for (const Mesh& linear : solid_meshes())
        for (int degree = 1; degree <= 2; ++degree) meshes.push_back(raise_degree(linear, degree));
    for (const char* const layers : {"h", "p", "d"}) meshes.push_back(raise_degree(solid_mesh(1, layers), 3));
    meshes.push_back(raise_degree(solid_mesh(1, "p"), 4));
    return meshes;
}

}  // namespace

TEST_CASE("solid cells have no distortion where they are, and a stretch has that of its matrix everywhere") {
    for (const Mesh& mesh : meshes())
        for (const Assembly assembly : assemblies) {
            const auto E = make_energy(mesh, mesh.x, with(Objective::deviation, assembly));
            CHECK(E->domain_volume() == doctest::Approx(volume(mesh, mesh.x)).epsilon(1e-13));
            CHECK(std::abs(volume(mesh, mesh.x) - std::round(volume(mesh, mesh.x) * 4) / 4) < 1e-12);
            CHECK(E->energy(mesh.x) < 1e-22);
            for (const double g : gradient(*E, mesh.x)) CHECK(std::abs(g) < 1e-11);
            const DistortionStatistics of = E->statistics(stretched(mesh.x, 3));
            CHECK(of.max_distortion == doctest::Approx(2 / std::pow(4, 1.0 / 3)).epsilon(1e-12));
            CHECK(of.relative_quality == doctest::Approx(std::pow(4, 1.0 / 3) / 2).epsilon(1e-12));
        }
}

TEST_CASE("both assemblies agree on solid cells") {
    for (const Mesh& mesh : meshes())
        for (const Objective objective : all_objectives)
            check_same(*make_energy(mesh, mesh.x, with(objective)),
                       *make_energy(mesh, mesh.x, with(objective, Assembly::plain)),
                       wavy(stretched(mesh.x, 3), 3, 0.01));
}

TEST_CASE("gradient and Hessian on solid cells have slope 2") {
    for (const Mesh& mesh : meshes())
        check_slopes(*make_energy(mesh, mesh.x, with(Objective::squared)), wavy(stretched(mesh.x, 3), 3, 0.01));
}
