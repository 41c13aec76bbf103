#include "method/held_nodes.hpp"

#include <doctest/doctest.h>

#include "method/functional.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("held nodes: no gradient, rows and columns of the unit matrix, all others as they were") {
    const Minimisation of(ring_mesh(8, 3, 4), {{"inner", "translate 0.3 0"}}, Objective::squared);
    const std::vector<double> x = wavy(of.ideal, 2, 0.02);
    AugmentedFunctional E = of.functional(10);
    std::vector<double> g(x.size()), of_all(x.size());
    BlockCsr H = of.distortion.hessian_pattern(), full = H;
    E.gradient(x, of_all);
    E.hessian(x, HessianKind::full, full);
    E.held.assign(of.mesh.nodes(), 0);
    for (const int node : of.constraint.nodes()) E.held[node] = 1;
    E.gradient(x, g);
    E.hessian(x, HessianKind::full, H);
    for (int i = 0; i < of.mesh.nodes(); ++i)
        for (int a = 0; a < 2; ++a) CHECK(g[2 * i + a] == (E.held[i] ? 0 : of_all[2 * i + a]));
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k)
            for (int ab = 0; ab < 4; ++ab) {
                const bool held = E.held[i] || E.held[H.col[k]], diagonal = i == H.col[k] && ab % 3 == 0;
                CHECK(H.block(k)[ab] == (held ? (diagonal ? 1 : 0) : full.block(k)[ab]));
            }
}
