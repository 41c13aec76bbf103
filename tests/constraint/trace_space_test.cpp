#include "constraint/trace_space.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the mass matrix integrates traces over the faces that are not free") {
    for (const int degree : {1, 2, 3})
        for (const bool open : {false, true}) {
            const Mesh mesh = raise_degree(ring_mesh(12, 2, 3), degree);
            const BoundaryTarget target = target_of(mesh, {{"outer", open ? "free" : "fixed"}});
            const TraceSpace trace(mesh, straight_sided(mesh), target);
            CHECK(trace.norm_of_one == doctest::Approx(std::sqrt(open ? 12 : 24)));
            REQUIRE(trace.M.n == static_cast<int>(trace.nodes.size()));
            REQUIRE(trace.M.n == 24 * degree);
            double all = 0, of_x_squared = 0;  // (1, 1) and (x, x), x the first coordinate
            for (int t = 0; t < trace.M.n; ++t) {
                double row = 0;
                const double* const at = point(mesh.x, trace.nodes[t], 2);
                for (int k = trace.M.row[t]; k < trace.M.row[t + 1]; ++k) {
                    row += trace.M.value[k];
                    of_x_squared += trace.M.value[k] * at[0] * point(mesh.x, trace.nodes[trace.M.col[k]], 2)[0];
                }
                all += row;
                if (open && std::hypot(at[0], at[1]) > 2) CHECK(row == 0);
            }
            CHECK(all == doctest::Approx(open ? 12 : 24).epsilon(1e-13));
            // Over an edge of a regular 12-gon of radius R the mean of |x|^2 is R^2 (2 + cos(30 degrees)) / 3.
            const double mean = (2 + std::cos(std::numbers::pi / 6)) / 3 / 2;
            CHECK(of_x_squared == doctest::Approx(12 * mean * (open ? 1 : 1 + 9)).epsilon(1e-12));
        }
}

TEST_CASE("heights are those of the flattest cell over a boundary face at the node") {
    Mesh mesh = square_mesh(4);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (point(mesh.x, i, 2)[1] == 0.25) point(mesh.x, i, 2)[1] = 0.05;  // thin cells at the bottom
    const TraceSpace trace(mesh, mesh.x, target_of(mesh, {}));
    for (std::size_t t = 0; t < trace.nodes.size(); ++t) {
        const double* const at = point(mesh.x, trace.nodes[t], 2);
        CHECK(trace.height[t] == doctest::Approx(at[1] == 0 ? 0.05 : 0.25));
    }
}
