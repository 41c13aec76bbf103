#include "method/fixed_nodes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "energy/vertex_interpolation.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/ordering.hpp"
#include "method/functional.hpp"
#include "method/newton.hpp"
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
    E.fixed.assign(of.mesh.nodes(), 0);
    for (const int node : of.constraint.nodes()) E.fixed[node] = 1;
    E.gradient(x, g);
    E.hessian(x, HessianKind::full, H);
    for (int i = 0; i < of.mesh.nodes(); ++i)
        for (int a = 0; a < 2; ++a) CHECK(g[2 * i + a] == (E.fixed[i] ? 0 : of_all[2 * i + a]));
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k)
            for (int ab = 0; ab < 4; ++ab) {
                const bool fixed = E.fixed[i] || E.fixed[H.col[k]], diagonal = i == H.col[k] && ab % 3 == 0;
                CHECK(H.block(k)[ab] == (fixed ? (diagonal ? 1 : 0) : full.block(k)[ab]));
            }
}

// With elements of several types, one with a refined rule, and each assembly.
TEST_CASE("half of a Hessian has the blocks of the whole one in single precision, and its diagonal") {
    for (const Assembly assembly : {Assembly::simd, Assembly::plain})
        for (const Mesh& linear : {ring_mesh(8, 3, 4), cube_mesh(2), mixed_mesh(4)}) {
            const Minimisation of(raise_degree(linear, 2), {}, Objective::deviation,
                                  TargetKind::nodal, assembly);
            of.distortion.set_quadrature({{{0, {1}, 0.1}}, {}});
            const std::vector<double> x = wavy(of.ideal, of.mesh.dim, 0.01);
            AugmentedFunctional E = of.functional(10);
            for (const bool holds : {false, true}) {
                if (holds) E.fixed = of.level.on_boundary();
                BlockCsr whole = of.distortion.hessian_pattern();
                E.hessian(x, HessianKind::full, whole);
                const Minimisation other(raise_degree(linear, 2), {}, Objective::deviation,
                                         TargetKind::nodal, assembly);
                other.distortion.set_quadrature({{{0, {1}, 0.1}}, {}});
                other.distortion.order_hessian([](const BlockCsr& pattern) {
                    RowOrder order = cut_into_domains(graph_of(pattern));
                    order.in_half = true;
                    return std::make_shared<RowOrder>(std::move(order));
                });
                AugmentedFunctional of_half = other.functional(10);
                of_half.fixed = E.fixed;
                BlockCsr half = other.distortion.hessian_pattern();
                of_half.hessian(x, HessianKind::full, half);
                const int size = half.d * half.d;
                const double largest = norm_inf(whole);
                int blocks = 0;
                for (int i = 0; i < half.n; ++i) {
                    const int node = half.node_of(i);
                    for (int e = 0; e < size; ++e)
                        CHECK(half.diagonal(i)[e] == doctest::Approx(whole.diagonal(node)[e]).epsilon(1e-12));
                    for (int k = half.row[i]; k < half.row[i + 1]; ++k, ++blocks) {
                        const double* const block = whole.block(whole.find(node, half.node_of(half.col[k])));
                        REQUIRE(half.col[k] < i);
                        for (int e = 0; e < size; ++e)
                            CHECK(std::abs(half.block_below(k)[e] - block[e]) < 1e-6 * largest);
                    }
                }
                CHECK(2 * blocks + half.n == whole.blocks());
            }
        }
}

// The correction of degree 1 moves nodes and moves them back, to rounding.
TEST_CASE("held nodes of curved elements stay to the last bit where conjugate gradients have a p-multigrid") {
    const Minimisation of(raise_degree(cube_mesh(4), 2), {{"top", "fixed"}, {"sides", "fixed"}, {"bottom", "fixed"}},
                          Objective::squared);
    of.distortion.order_hessian([&](const BlockCsr& pattern) {
        return sweep_order(pattern, 3, {.kind = SolverKind::cg}, vertex_interpolation(of.mesh));
    });
    AugmentedFunctional E = of.functional(0);
    E.fixed.assign(of.mesh.nodes(), 0);
    for (const int node : of.constraint.nodes()) E.fixed[node] = 1;
    const std::vector<double> start = wavy(of.ideal, 3, 0.02);
    std::vector<double> x = start;
    Newton newton(of.distortion.hessian_pattern(), {.kind = SolverKind::cg});
    NewtonParams params;
    params.omega = params.omega_star = 1e-8;
    PreconditionerKind used = PreconditionerKind::automatic;
    const NewtonResult result = newton.minimise(E, params, x, [&](const NewtonStep& s) { used = s.preconditioner; });
    CHECK(result.status == Status::converged);
    CHECK(used == PreconditionerKind::pmg);
    for (int i = 0; i < of.mesh.nodes(); ++i)
        for (int a = 0; a < 3 && E.fixed[i]; ++a) CHECK(x[3 * i + a] == start[3 * i + a]);
}
