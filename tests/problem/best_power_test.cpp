// improve with objective = minimax: of two powers the one with the larger least scaled Jacobian.
#include "problem/best_power.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "check/scaled_jacobian.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Of inputs/meshes/NAME.msh, improved.
double least_after(const std::string& name, std::vector<std::string> settings, std::string& out) {
    const TemporaryFolder folder;
    settings.insert(settings.begin(), {"improve", "inputs/meshes/" + name + ".msh", "output=" + folder.path("results"),
                                       "objective=minimax", "threads=1"});
    const Outcome outcome = almesh_with(settings);
    CHECK(outcome.code == 0);
    out = outcome.out;
    const Mesh mesh = mesh_of(folder.path("results/final.msh"));
    return least_corner_jacobian(mesh, mesh.x);
}

}  // namespace

TEST_CASE("minimax takes the power with the larger least scaled Jacobian: in tetrahedra a low one, in triangles not") {
    std::string out;
    for (const char* name : {"cube", "circle"}) {
        const bool is_solid = name == std::string("cube");
        const double low = least_after(name, {"power=8"}, out), high = least_after(name, {"power=64"}, out);
        CHECK((low > high) == is_solid);
        CHECK(!has(out, "with power = 8"));
        CHECK(least_after(name, {}, out) >= std::max(low, high));  // corners are raised after it
        CHECK(has(out, "least scaled Jacobian: " + rounded_down(low, 4) + " with power = 8, " + rounded_down(high, 4) +
                           " with all powers\n"));
    }
}
