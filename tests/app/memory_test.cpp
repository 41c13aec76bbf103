#include "app/memory.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <string>

#include "base/error.hpp"
#include "energy/distortion_energy.hpp"
#include "support/meshes.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the blocks of the Hessian are counted as its pattern has them, in every degree") {
    std::vector<Mesh> meshes = {ring_mesh(12, 3, 6), cube_mesh(2), mixed_mesh(4)};
    for (const Mesh& mesh : solid_meshes()) meshes.push_back(mesh);
    for (const Mesh& linear : meshes)
        for (int degree = 1; degree <= 4; ++degree) {
            const Mesh mesh = raise_degree(linear, degree);
            const BlockCsr H = make_energy(mesh, straight_sided(mesh), {})->hessian_pattern();
            CHECK(hessian_blocks(mesh) == H.blocks());
        }
}

TEST_CASE("more is predicted for finer meshes and higher degrees, and for the factor of a large 3D mesh") {
    const Mesh cube = cube_mesh(4), fine = refine(cube, 1);
    LinearSolverParams cg, cholesky;
    cg.kind = SolverKind::cg;
    cholesky.kind = SolverKind::cholesky;
    CHECK(predicted_bytes(fine, cg) > predicted_bytes(cube, cg));
    CHECK(predicted_bytes(raise_degree(cube, 2), cg) > predicted_bytes(cube, cg));
    CHECK(predicted_bytes(refine(cube, 3), cholesky) > 2 * predicted_bytes(refine(cube, 3), cg));
    CHECK(predicted_bytes(cube, {}) == predicted_bytes(cube, cholesky));  // small: so decides `automatic`
}

TEST_CASE("a run that needs more memory than there is is refused with a degree that fits") {
    const Mesh mesh = raise_degree(solid_mesh(2, "hh"), 3);
    const double bytes = predicted_bytes(mesh, {}), of_degree_2 = predicted_bytes(interpolated(mesh, 2), {});
    REQUIRE(of_degree_2 < bytes);
    CHECK_NOTHROW(check_memory(mesh, {}, bytes));
    CHECK_THROWS_WITH_AS(check_memory(mesh, {}, 0.5 * (bytes + of_degree_2)), doctest::Contains("degree = 2 takes"),
                         InputError);
    CHECK_THROWS_WITH_AS(check_memory(mesh, {}, 1), doctest::Contains("a coarser mesh takes less"), InputError);
}

TEST_CASE("the summary has the prediction beside what was taken") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const double predicted = std::stod(summary_of(ring.output).at("predicted_memory_mb"));
    CHECK(predicted > 1);
    CHECK(predicted < 20);
}
