#include "method/polish.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "check/certificate.hpp"
#include "io/mesh_format.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("all nodes are set to their targets where the mesh stays valid") {
    for (const int degree : {1, 3}) {
        const Minimisation problem(raise_degree(ring_mesh(12, 3, 4), degree), {{"inner", "translate 0.01 0.02"}},
                                   Objective::deviation);
        std::vector<double> x = problem.ideal;
        CHECK(nodes_off_target(problem.constraint, x) >= 12 * degree);
        CHECK(snap_to_targets(problem.distortion, problem.constraint, x) == 0);
        CHECK(nodes_off_target(problem.constraint, x) == 0);
        CHECK(problem.constraint.projected_norm(x) == 0);
        CHECK(certify(problem.mesh, x).valid);
    }
}

// One node inside has come so near to the wall that its element would fold.
TEST_CASE("nodes that would fold an element stay, all others are set") {
    for (const int degree : {1, 2}) {
        const Mesh square = square_mesh(6), mesh = raise_degree(square, degree);
        const Minimisation problem(mesh,
                                   {{"bottom", "translate 0 0.02"},
                                    {"left", "translate 0 0.02"},
                                    {"right", "translate 0 0.02"},
                                    {"top", "translate 0 0.02"}},
                                   Objective::deviation);
        Mesh moved = square;
        for (int i = 0; i < square.nodes(); ++i) {
            double* const p = &moved.x[2 * i];
            if (std::abs(p[0] - 0.5) < 0.01 && std::abs(p[1] - 1.0 / 6) < 0.01) p[1] = 0.01;
        }
        std::vector<double> x = raise_degree(moved, degree).x;
        REQUIRE(certify(mesh, x).valid);
        const int off = snap_to_targets(problem.distortion, problem.constraint, x);
        CHECK(off > 0);
        CHECK(off <= 5 * degree);
        CHECK(off == nodes_off_target(problem.constraint, x));
        CHECK(certify(mesh, x).valid);
    }
}

TEST_CASE("the boundary of final.msh has the bits of its target in the unit of the file; algorithm = paper leaves it") {
    for (const double unit : {1.0, 0.0254, 1000.0}) {
        Mesh mesh = ring_mesh(12, 3, 4);
        for (double& x : mesh.x) x *= unit;
        const RingDeck ring(mesh);
        const std::string motion = concat("translate ", 0.7 * unit, " ", 0.1 * unit);
        const auto off_target = [&] {
            const Mesh result = mesh_of(ring.output + "/final.msh"), initial = mesh_of(ring.folder.path("ring.msh"));
            const BoundaryTarget target = target_of(initial, {{"inner", motion}});
            int off = 0;
            for (std::size_t k = 0; k < initial.faces.size(); ++k)
                for (int a = 0; a < 2; ++a) off += result.x[2 * initial.faces[k] + a] != target.node[2 * k + a];
            return off;
        };
        const Outcome snapped = ring.run({"boundary inner=" + motion});
        CHECK(snapped.code == 0);
        CHECK(has(snapped.out, "every boundary node is where its motion takes it to the last bit"));
        CHECK(summary_of(ring.output).at("nodes_off_target") == "0");
        CHECK(summary_of(ring.output).at("relative_boundary_error") == "0");
        CHECK(off_target() == 0);
        const Outcome left = ring.run({"boundary inner=" + motion, "algorithm=paper"});
        CHECK(left.code == 0);
        CHECK(has(left.out, " boundary nodes off their targets, by at most "));
        CHECK(number(summary_of(ring.output), "nodes_off_target") > 0);
        CHECK(off_target() > 0);
    }
}
