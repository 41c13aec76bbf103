// The energy on meshes of quadrilaterals, alone and next to triangles.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "energy/group_energy.hpp"
#include "energy/mixed_energy.hpp"
#include "support/energy_checks.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<Mesh> meshes() {
    std::vector<Mesh> meshes;
    for (int degree = 1; degree <= 4; ++degree)
        for (const Mesh& linear : {quad_mesh(3, 0.2), mixed_mesh(4, 0.2)})
            meshes.push_back(raise_degree(linear, degree));
    return meshes;
}

std::vector<double> on_part(const std::vector<double>& x, const std::vector<int>& node) {
    std::vector<double> y;
    for (const int i : node) y.insert(y.end(), point(x, i, 2), point(x, i, 2) + 2);
    return y;
}

// Steps that fold elements, so that their quadrature gets finer.
void refine(DistortionEnergy& E, const Mesh& mesh, const std::vector<double>& x) {
    for (const double amplitude : {0.2, 0.3}) {
        REQUIRE(E.valid_fraction(x, wavy(mesh.x, 2, amplitude)) < 1);
        REQUIRE(E.refine_quadrature());
    }
    REQUIRE(E.refined_elements() > 0);
}

}  // namespace

TEST_CASE("quadrilaterals have no distortion where they are, and a stretch has that of its matrix everywhere") {
    for (const Mesh& mesh : meshes())
        for (const Assembly assembly : assemblies)
            for (const double alpha : {1.0, 0.5}) {
                const auto E = make_energy(mesh, mesh.x, with(Objective::deviation, assembly, alpha));
                CHECK(E->domain_volume() == doctest::Approx(1).epsilon(1e-14));
                CHECK(E->energy(mesh.x) < 1e-24);
                for (const double g : gradient(*E, mesh.x)) CHECK(std::abs(g) < 1e-11);
                CHECK(make_energy(mesh, mesh.x, with(Objective::size_shape, assembly, alpha))->energy(mesh.x) < 1e-24);
                const std::vector<double> x = stretched(mesh.x);
                CHECK(E->energy(x) == doctest::Approx(1.0 / 16).epsilon(1e-12));
                const DistortionStatistics of = E->statistics(x);
                CHECK(of.max_distortion == doctest::Approx(1.25).epsilon(1e-12));
                CHECK(of.relative_quality == doctest::Approx(0.8).epsilon(1e-12));
                CHECK(static_cast<int>(of.element_max.size()) == mesh.element_count());
            }
}

TEST_CASE("both assemblies agree on quadrilaterals, with refined quadratures and in parts") {
    for (const Mesh& mesh : meshes())
        for (const Objective objective : all_objectives) {
            const std::vector<double> x = wavy(stretched(mesh.x), 2, 0.02);
            const auto simd = make_energy(mesh, mesh.x, with(objective)),
                       plain = make_energy(mesh, mesh.x, with(objective, Assembly::plain));
            check_same(*simd, *plain, x);
            refine(*simd, mesh, mesh.x);
            refine(*plain, mesh, mesh.x);
            check_same(*simd, *plain, x);
            std::vector<char> moves(mesh.nodes(), 0);
            for (int i = 1; i < mesh.nodes(); i += 5) moves[i] = 1;
            Restriction around, of_plain;
            const auto part = simd->part(x, moves, around), other = plain->part(x, moves, of_plain);
            const std::vector<int>& node = around.node;
            REQUIRE(node == of_plain.node);
            CHECK(part->refined_elements() == other->refined_elements());
            CHECK(part->domain_volume() == doctest::Approx(other->domain_volume()).epsilon(1e-13));
            std::vector<double> y = on_part(x, node);
            CHECK(part->energy(y) == doctest::Approx(other->energy(y)).epsilon(1e-12));
            // What the part's nodes that move do to it is what they do to the whole.
            std::vector<double> moved = x;
            for (int i = 0; i < mesh.nodes(); ++i) moved[2 * i] += moves[i] ? 1e-3 : 0;
            CHECK(part->energy(on_part(moved, node)) - part->energy(y) ==
                  doctest::Approx(simd->energy(moved) - simd->energy(x)).epsilon(1e-8));
        }
}

TEST_CASE("gradient and Hessian on quadrilaterals have slope 2") {
    for (const Mesh& mesh : meshes()) {
        const std::vector<double> x = wavy(stretched(mesh.x), 2, 0.02);
        for (const bool refined : {false, true}) {
            const auto E = make_energy(mesh, mesh.x, with(Objective::squared));
            if (refined) refine(*E, mesh, mesh.x);
            check_slopes(*E, x);
        }
    }
}

// phi = (x + a sin(pi y), y): |D phi|^2 = 2 + s^2, det = 1, s = a pi cos(pi y), so eta^2 = (1 + s^2 / 2)^2. With
// b = (a pi)^2 the integral over the unit square is 1 + b / 2 + 3 b^2 / 32.
// At degree 4 the error is that of the node points, which have a thousandth of the weight.
TEST_CASE("the energy of a smooth map converges to the exact one with the degree of quadrilaterals") {
    const double a = 0.2, b = a * a * std::numbers::pi * std::numbers::pi, exact = 1 + b / 2 + 3 * b * b / 32;
    for (int degree = 1; degree <= 4; ++degree) {
        double error[2];
        for (int level = 0; level < 2; ++level) {
            const Mesh mesh = raise_degree(quad_mesh(4 << level, 0.1), degree);
            std::vector<double> x = mesh.x;
            for (std::size_t i = 0; i < x.size(); i += 2) x[i] += a * std::sin(std::numbers::pi * x[i + 1]);
            error[level] =
                std::abs(make_energy(mesh, mesh.x, with(Objective::squared, Assembly::simd, 1))->energy(x) - exact);
        }
        CHECK(std::log2(error[0] / error[1]) > std::min(degree, 2));
        CHECK(error[1] < std::pow(0.06, degree + 1));
    }
}

TEST_CASE("elements of both types have the weights of their sizes") {
    // Two squares of area 1 and 1/4 of another size, the second one of two triangles; the first one is stretched.
    const std::vector<double> x = {0, 0, 1, 0, 1, 1, 0, 1, 3, 0, 3.5, 0, 3.5, 0.5, 3, 0.5};
    const Mesh mesh = linear_mesh(2, x, {4, 5, 6, 4, 6, 7, 0, 1, 2, 3}, [](const double*) { return "wall"; },
                                  {{&simplex(2), 0, 2, 0}, {&quadrilateral(), 2, 1, 6}});
    std::vector<double> moved = x;
    for (int i = 0; i < 4; ++i) moved[2 * i] *= 2;
    for (const Assembly assembly : assemblies)
        for (const double alpha : {1.0, 0.5, 0.25}) {
            const double of_square = 1, of_triangles = 2 * std::pow(0.125, alpha);
            const auto E = make_energy(mesh, x, with(Objective::squared, assembly, alpha));
            const double part = of_square / (of_square + of_triangles);
            CHECK(E->energy(moved) == doctest::Approx(1.25 * (part * 1.5625 + (1 - part))).epsilon(1e-13));
            CHECK(E->statistics(moved).relative_quality ==
                  doctest::Approx(std::sqrt(1.25 / (1.5625 + 0.25))).epsilon(1e-13));
        }
}

TEST_CASE("a step that folds a quadrilateral between its vertices is refused, and its quadrature gets finer there") {
    for (int degree = 1; degree <= 4; ++degree) {
        const Mesh mesh = raise_degree(quad_mesh(1), degree);
        const auto E = make_energy(mesh, mesh.x, with(Objective::squared));
        CHECK(E->certified(mesh.x));
        CHECK(E->valid_fraction(mesh.x, wavy(mesh.x, 2, 0.02)) == 1);
        CHECK(E->valid_fraction(mesh.x, stretched(mesh.x)) == 1);
        std::vector<double> folded = mesh.x;
        if (degree == 1) {  // vertex 2 beyond the diagonal: the two triangles of the other one have positive areas
            folded[4] = folded[5] = 0.45;
        } else {  // a node of the first edge goes too far, the vertices stay
            folded[2 * mesh.element(0)[4] + 1] = 0.8;
        }
        CHECK(!E->certified(folded));
        const double s = E->valid_fraction(mesh.x, folded);
        CHECK(s < 1);
        CHECK(s > 0.05);
        std::vector<double> x = mesh.x;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += s * (folded[i] - x[i]);
        CHECK(E->certified(x));
        CHECK(std::isfinite(E->energy(x)));
        REQUIRE(E->refine_quadrature());  // the usual rule first
        CHECK(E->refined_elements() == 0);
        CHECK(E->valid_fraction(mesh.x, folded) == s);
        REQUIRE(E->refine_quadrature());
        CHECK(E->refined_elements() == 1);
        CHECK(std::isfinite(E->energy(x)));
        CHECK(E->energy(stretched(mesh.x)) == doctest::Approx(1.5625).epsilon(1e-12));
        CHECK(E->statistics(stretched(mesh.x)).relative_quality == doctest::Approx(0.8).epsilon(1e-12));
    }
}

TEST_CASE("few points until a quadrilateral is bent, and then for good those of the usual rule") {
    for (const Mesh& mesh : meshes())
        for (const Assembly assembly : assemblies) {
            const auto E = make_energy(mesh, mesh.x, with(Objective::deviation, assembly));
            DistortionParams params = with(Objective::deviation, assembly);
            params.exactness = 2 * mesh.degree + 2;
            const auto usual = make_energy(mesh, mesh.x, params);
            const std::vector<double> straight = stretched(mesh.x), bent = wavy(mesh.x, 2, 0.1);
            E->refine_quadrature(straight);
            CHECK(E->energy(straight) == doctest::Approx(usual->energy(straight)).epsilon(1e-12));
            const double before = E->energy(bent);
            CHECK(before == doctest::Approx(usual->energy(bent)).epsilon(0.02));
            REQUIRE(E->refine_quadrature(bent));
            CHECK(!E->refine_quadrature(bent));
            const double after = E->energy(bent);
            CHECK(after != before);
            CHECK(!E->refine_quadrature(straight));
            CHECK(E->energy(bent) == after);
            CHECK(std::abs(after - usual->energy(bent)) < std::abs(before - usual->energy(bent)));
            check_slopes(*E, bent);
        }
}

TEST_CASE("a mixed mesh keeps the state of its quadrature, takes over that of parts, and orders its Hessian") {
    const Mesh mesh = raise_degree(mixed_mesh(4, 0.2), 2);
    const std::vector<double> x = wavy(mesh.x, 2, 0.02);
    for (const Assembly assembly : assemblies) {
        const auto E = make_energy(mesh, mesh.x, with(Objective::deviation, assembly)),
                   other = make_energy(mesh, mesh.x, with(Objective::deviation, assembly));
        REQUIRE(dynamic_cast<MixedEnergy*>(E.get()));
        const double before = E->energy(x);
        refine(*E, mesh, mesh.x);
        CHECK(E->energy(x) != before);
        other->set_quadrature(E->quadrature());
        for (DistortionEnergy* energy : {E.get(), other.get()})  // elements that are bent are found again
            energy->refine_quadrature(wavy(mesh.x, 2, 0.2));
        CHECK(other->energy(x) == E->energy(x));
        CHECK(other->refined_elements() == E->refined_elements());

        std::vector<char> moves(mesh.nodes(), 0);
        moves[mesh.element(0)[0]] = moves[mesh.element(mesh.element_count() - 1)[0]] = 1;
        Restriction around;
        const auto whole = make_energy(mesh, mesh.x, with(Objective::deviation, assembly));
        const auto part = whole->part(x, moves, around);
        const std::vector<int>& node = around.node;
        REQUIRE(part->valid_fraction(on_part(x, node), on_part(wavy(mesh.x, 2, 0.3), node)) < 1);
        REQUIRE(part->refine_quadrature());
        CHECK(whole->take_over_refinements(*part));
        CHECK(whole->refined_elements() == part->refined_elements());

        BlockCsr H = E->hessian_pattern();
        E->add_hessian(x, HessianKind::full, H);
        std::vector<int> backwards(mesh.nodes());
        for (int i = 0; i < mesh.nodes(); ++i) backwards[i] = mesh.nodes() - 1 - i;
        const auto order = std::make_shared<RowOrder>(row_order(backwards));
        E->order_hessian([&](const BlockCsr&) { return order; });
        BlockCsr ordered = E->hessian_pattern();
        E->add_hessian(x, HessianKind::full, ordered);
        CHECK(relative_difference(ordered.value, reordered(H, *order).value) == 0);
    }
}

TEST_CASE("density and regularisation of a mixed mesh change for all of its elements") {
    const Mesh mesh = mixed_mesh(4, 0.2);
    const std::vector<double> x = wavy(stretched(mesh.x), 2, 0.02), folded = wavy(mesh.x, 2, 0.4);
    DistortionParams params = with(Objective::minimax);
    const auto E = make_energy(mesh, mesh.x, params);
    params.power = {.p = 16, .M = 0.5, .kappa = 0.2};
    E->set_power(params.power);
    CHECK(E->energy(x) == make_energy(mesh, mesh.x, params)->energy(x));
    REQUIRE(std::isinf(E->energy(folded)));
    params.delta = 0.5;
    E->set_delta(params.delta);
    CHECK(E->energy(folded) == make_energy(mesh, mesh.x, params)->energy(folded));
    CHECK(E->valid_fraction(mesh.x, folded) == 1);
}

TEST_CASE("ideal quadrilaterals that are not convex are refused by their number") {
    Mesh mesh = mixed_mesh(4);
    point(mesh.x, mesh.element(mesh.element_count() - 1)[0], 2)[0] += 0.4;
    for (const Assembly assembly : assemblies)
        CHECK_THROWS_AS(make_energy(mesh, mesh.x, with(Objective::squared, assembly)), InputError);
}

TEST_CASE("infeasible elements: they may invert, cut no step, and are in no norm; their energy has its derivatives") {
    const Mesh mesh = mixed_mesh(4, 0.2);
    const int inside = mesh.element(mesh.element_count() / 2)[0];
    std::vector<char> infeasible(mesh.element_count(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.element_nodes(e); ++k) infeasible[e] |= mesh.element(e)[k] == inside;
    std::vector<double> x = mesh.x;
    point(x, inside, 2)[0] += 0.7;
    for (const Assembly assembly : assemblies) {
        const AssembledParams params = with(Objective::deviation, assembly);
        MixedEnergy E(mesh, mesh.x, params, infeasible, maker_of(assembly));
        CHECK(std::isinf(make_energy(mesh, mesh.x, params)->energy(x)));
        CHECK(std::isfinite(E.energy(x)));
        CHECK(E.valid_fraction(mesh.x, x) == 1);
        CHECK(E.certified(x));
        CHECK(E.statistics(x).max_distortion == doctest::Approx(1));
        CHECK(E.statistics(x).relative_quality == doctest::Approx(1));
        for (int e = 0; e < mesh.element_count(); ++e)
            CHECK((E.statistics(x).element_max[e] > 1.001) == (infeasible[e] != 0));
        std::vector<double> g(x.size(), 0), y = x;
        E.add_gradient(x, g);
        const std::size_t k = 2 * static_cast<std::size_t>(inside);
        y[k] += 1e-6;
        const double above = E.energy(y);
        y[k] -= 2e-6;
        CHECK(g[k] == doctest::Approx((above - E.energy(y)) / 2e-6).epsilon(1e-6));
        point(y = mesh.x, 0, 2)[0] += 5;  // of elements that have to be valid
        CHECK(std::isinf(E.energy(y)));
    }
}
