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

TEST_CASE("a run that needs more memory than there is is refused before its mesh is made, with what fits") {
    LinearSolverParams cg;
    cg.kind = SolverKind::cg;
    for (const Mesh& base : {solid_mesh(2, "hh"), solid_mesh(2, "hdpuh"), cube_mesh(2), mixed_mesh(8)}) {
        const double bytes = predicted_bytes(raise_degree(refine(base, 1), 3), cg);
        CHECK_NOTHROW(check_memory(base, 3, 1, cg, 1.25 * bytes));
        CHECK_THROWS_WITH_AS(check_memory(base, 3, 1, cg, 0.85 * bytes), doctest::Contains("degree = 2 takes"),
                             InputError);
        CHECK_THROWS_WITH_AS(check_memory(base, 1, 7, cg, 1e8), doctest::Contains("refine = "), InputError);
        CHECK_THROWS_WITH_AS(check_memory(base, 3, 1, cg, 1), doctest::Contains("a coarser mesh takes less"),
                             InputError);
    }
}

TEST_CASE("a run whose refined mesh would not fit into memory ends at once") {
    const RingDeck ring;
    const Outcome run = ring.run({"refine=7", "degree=7"});
    CHECK(run.code == 2);
    CHECK(has(run.error, "GB of memory, and "));
    CHECK(has(run.error, " GB are free here: "));
}

TEST_CASE("the summary has the prediction beside what was taken") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const double predicted = std::stod(summary_of(ring.output).at("predicted_memory_mb"));
    CHECK(predicted > 1);
    CHECK(predicted < 20);
}
