#include "app/memory.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <string>

#include "energy/distortion_energy.hpp"
#include "mesh/build.hpp"
#include "support/meshes.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the blocks of the Hessian are counted as its pattern has them, in every degree") {
    for (const Mesh& linear : {ring_mesh(12, 3, 6), cube_mesh(2)})
        for (int degree = 1; degree <= 4; ++degree) {
            const Mesh mesh = raise_degree(linear, degree);
            const BlockCsr H = make_energy(mesh, straight_sided(mesh), {})->hessian_pattern();
            CHECK(hessian_blocks(mesh) == H.blocks());
        }
}

TEST_CASE("the blocks of meshes with hexahedra, prisms and pyramids are counted too") {
    std::vector<std::string> notes;
    for (const char* const layers : {"hh", "pp", "hdpuh"})
        for (int degree = 1; degree <= 3; ++degree) {
            const Mesh mesh = raise_degree(build_mesh(solid_block(2, layers), notes), degree);
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

TEST_CASE("the summary has the prediction beside what was taken") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const double predicted = std::stod(summary_of(ring.output).at("predicted_memory_mb"));
    CHECK(predicted > 1);
    CHECK(predicted < 20);
}
