// What both assemblies of the energy promise, and that they agree where simd_energy_test.cpp does not look: all
// objectives with regularisation and damping, parts of a mesh, statistics.
#include "lessons/plain_energy.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/error.hpp"
#include "energy/simd_energy.hpp"
#include "support/assemblies.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr Objective objectives[] = {Objective::squared, Objective::deviation, Objective::size_shape};

std::vector<Mesh> meshes() {
    return {square_mesh(3), raise_degree(square_mesh(2), 3), raise_degree(ring_mesh(7, 2, 3), 2), cube_mesh(2),
            raise_degree(cube_mesh(1), 2)};
}

template <class Values>
double largest(const Values& values) {
    double most = 0;
    for (double v : values) most = std::max(most, std::abs(v));
    return most;
}

// max |a - b| in units of max |b|; nan where an entry is nan.
template <class Values>
double relative_difference(const Values& a, const Values& b) {
    REQUIRE(a.size() == b.size());
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!(std::abs(a[i] - b[i]) <= most)) most = std::abs(a[i] - b[i]);
    return most / largest(b);
}

std::vector<double> gradient(DistortionEnergy& E, const std::vector<double>& x) {
    std::vector<double> g(x.size(), 0.0);
    E.add_gradient(x, g);
    return g;
}

BlockCsr hessian(DistortionEnergy& E, const std::vector<double>& x, HessianKind kind,
                 const Projection& projection) {
    BlockCsr H = E.hessian_pattern();
    E.add_hessian(x, kind, H, projection);
    return H;
}

void check_same(DistortionEnergy& a, DistortionEnergy& b, const std::vector<double>& x) {
    constexpr double tolerance = 1e-12;
    REQUIRE(std::isfinite(b.energy(x)));
    CHECK(std::abs(a.energy(x) - b.energy(x)) <= tolerance * b.energy(x));
    CHECK(relative_difference(gradient(a, x), gradient(b, x)) <= tolerance);
    for (const HessianKind kind : {HessianKind::full, HessianKind::projected, HessianKind::damping})
        for (const Projection& projection : {Projection{}, {.damping = 0.2}, {.damping = 3, .kept_negative = 0.4}})
            CHECK(relative_difference(hessian(a, x, kind, projection).value, hessian(b, x, kind, projection).value) <=
                  tolerance);
}

// x -> R x with the rotation by 0.7 about the last axis, times `factor`.
std::vector<double> turned(const std::vector<double>& x, int dim, double factor) {
    std::vector<double> y = x;
    const double c = std::cos(0.7), s = std::sin(0.7);
    for (std::size_t i = 0; i < y.size(); i += dim) {
        y[i] = factor * (c * x[i] - s * x[i + 1]);
        y[i + 1] = factor * (s * x[i] + c * x[i + 1]);
        if (dim == 3) y[i + 2] = factor * x[i + 2];
    }
    return y;
}

// Every fourth node moves.
std::vector<char> some_nodes(int count) {
    std::vector<char> moves(count, 0);
    for (int i = 1; i < count; i += 4) moves[i] = 1;
    return moves;
}

// Of the nodes of a part in the mesh: the other way round, -1 for nodes outside.
std::vector<int> numbers_in_part(const std::vector<int>& node, int count) {
    std::vector<int> number(count, -1);
    for (std::size_t k = 0; k < node.size(); ++k) number[node[k]] = static_cast<int>(k);
    return number;
}

std::vector<double> on_part(const std::vector<double>& x, const std::vector<int>& node, int dim) {
    std::vector<double> y;
    for (const int i : node) y.insert(y.end(), &x[i * dim], &x[i * dim] + dim);
    return y;
}

}  // namespace

TEST_CASE("plain and SIMD assembly agree for every objective, regularised or not, damped or not") {
    for (const Mesh& mesh : meshes()) {
        const std::vector<double> ideal = straight_sided(mesh);
        for (const Objective objective : objectives) {
            for (double delta : {0.0, 0.3})
                for (double alpha : {1.0, 0.3}) {
                    SimdEnergy simd(mesh, ideal, {objective, delta, alpha, 0});
                    PlainEnergy plain(mesh, ideal, {objective, delta, alpha, 0});
                    check_same(simd, plain, wavy(mesh.x, mesh.dim, 0.03));
                }
            const std::vector<double> folded = wavy(mesh.x, mesh.dim, 0.6);
            SimdEnergy simd(mesh, ideal, {objective, 0.3, 1, 0});
            PlainEnergy plain(mesh, ideal, {objective, 0.3, 1, 0});
            REQUIRE(std::isinf(SimdEnergy(mesh, ideal, {objective, 0, 1, 0}).energy(folded)));
            check_same(simd, plain, folded);
        }
    }
}

TEST_CASE("plain and SIMD assembly agree in volume, statistics, pattern, and in what they refuse") {
    for (const Mesh& mesh : meshes()) {
        const std::vector<double> ideal = straight_sided(mesh), x = wavy(mesh.x, mesh.dim, 0.03);
        SimdEnergy simd(mesh, ideal, {});
        PlainEnergy plain(mesh, ideal, {});
        CHECK(plain.domain_volume() == doctest::Approx(simd.domain_volume()).epsilon(1e-14));
        const DistortionStatistics a = simd.statistics(x), b = plain.statistics(x);
        CHECK(b.relative_quality == doctest::Approx(a.relative_quality).epsilon(1e-13));
        CHECK(b.max_distortion == doctest::Approx(a.max_distortion).epsilon(1e-13));
        CHECK(relative_difference(a.element_max, b.element_max) <= 1e-13);
        CHECK(plain.hessian_pattern().row == simd.hessian_pattern().row);
        CHECK(plain.hessian_pattern().col == simd.hessian_pattern().col);
        std::vector<double> inverted = x;
        for (int k = 0; k < mesh.dim; ++k) inverted[mesh.element(0)[0] * mesh.dim + k] += 3;
        CHECK(std::isinf(plain.energy(inverted)));
        CHECK(std::isinf(simd.energy(inverted)));
        std::vector<double> flat = ideal;
        for (std::size_t i = 1; i < flat.size(); i += mesh.dim) flat[i] = 0;
        CHECK_THROWS_AS(PlainEnergy(mesh, flat, {}), InputError);
    }
}

TEST_CASE("a part has the energy, gradient and Hessian of the elements around the nodes that move") {
    for (const Mesh& mesh : meshes())
        for (const Objective objective : objectives) {
            const int dim = mesh.dim;
            const std::vector<double> ideal = straight_sided(mesh), x = wavy(mesh.x, dim, 0.03);
            const std::vector<char> moves = some_nodes(mesh.nodes());
            std::vector<double> y = x;  // the nodes that move have moved
            for (std::size_t i = 0; i < y.size(); ++i)
                if (moves[i / dim]) y[i] += 0.01 * std::sin(1.0 + static_cast<double>(i));
            std::vector<double> v(x.size(), 0.0);  // a motion of theirs
            for (std::size_t i = 0; i < v.size(); ++i)
                if (moves[i / dim]) v[i] = std::cos(static_cast<double>(i));
            for (const Assembly assembly : assemblies) {
                const auto whole = make_energy(mesh, ideal, AssembledParams{{objective, 0, 0.5, 0}, assembly});
                Restriction around;
                const auto part = whole->part(x, moves, around);
                const std::vector<int>& node = around.node;
                const std::vector<int> number = numbers_in_part(node, mesh.nodes());
                const std::vector<double> part_x = on_part(x, node, dim), part_y = on_part(y, node, dim);
                CHECK(part->domain_volume() <= whole->domain_volume() * (1 + 1e-14));
                CHECK(part->energy(part_y) - part->energy(part_x) ==
                      doctest::Approx(whole->energy(y) - whole->energy(x)).epsilon(1e-9));
                const std::vector<double> g = gradient(*whole, y), part_g = gradient(*part, part_y);
                std::vector<double> expected, found;
                for (int i = 0; i < mesh.nodes(); ++i)
                    for (int a = 0; a < dim && moves[i]; ++a) {
                        REQUIRE(number[i] >= 0);
                        expected.push_back(g[i * dim + a]);
                        found.push_back(part_g[number[i] * dim + a]);
                    }
                CHECK(relative_difference(found, expected) <= 1e-12);
                for (const HessianKind kind : {HessianKind::full, HessianKind::projected, HessianKind::damping}) {
                    std::vector<double> Hv(v.size()), part_v = on_part(v, node, dim), part_Hv(part_v.size());
                    multiply(hessian(*whole, y, kind, {.damping = 0.2}), v.data(), Hv.data());
                    multiply(hessian(*part, part_y, kind, {.damping = 0.2}), part_v.data(), part_Hv.data());
                    CHECK(relative_difference(part_Hv, on_part(Hv, node, dim)) <= 1e-12);
                }
            }
        }
}

TEST_CASE("the parts of both assemblies are the same energy") {
    for (const Mesh& mesh : meshes()) {
        const std::vector<double> ideal = straight_sided(mesh), x = wavy(mesh.x, mesh.dim, 0.03);
        const std::vector<char> moves = some_nodes(mesh.nodes());
        for (double delta : {0.0, 0.3}) {
            Restriction around[2];
            std::unique_ptr<DistortionEnergy> part[2];
            for (int k = 0; k < 2; ++k)
                part[k] = make_energy(mesh, ideal, AssembledParams{{Objective::deviation, delta, 0.5}, assemblies[k]})
                              ->part(x, moves, around[k]);
            CHECK(part[0]->domain_volume() == doctest::Approx(part[1]->domain_volume()).epsilon(1e-13));
            const std::vector<double> x0 = on_part(x, around[0].node, mesh.dim),
                                      x1 = on_part(x, around[1].node, mesh.dim);
            CHECK(part[0]->energy(x0) == doctest::Approx(part[1]->energy(x1)).epsilon(1e-12));
            const std::vector<double> g0 = gradient(*part[0], x0), g1 = gradient(*part[1], x1);
            std::vector<double> in_mesh[2];
            for (int k = 0; k < 2; ++k) {
                in_mesh[k].assign(x.size(), 0.0);
                const std::vector<double>& g = k == 0 ? g0 : g1;
                for (std::size_t i = 0; i < g.size(); ++i)
                    in_mesh[k][around[k].node[i / mesh.dim] * mesh.dim + i % mesh.dim] = g[i];
            }
            CHECK(relative_difference(in_mesh[0], in_mesh[1]) <= 1e-12);
        }
    }
}

TEST_CASE("of all similarities of the mesh size_shape has energy zero for rotations only, the others for each") {
    for (const Mesh& mesh : meshes())
        for (const Assembly assembly : assemblies) {
            const std::vector<double> ideal = straight_sided(mesh);
            const auto size_shape = make_energy(mesh, ideal, AssembledParams{{Objective::size_shape}, assembly});
            const auto deviation = make_energy(mesh, ideal, AssembledParams{{Objective::deviation}, assembly});
            CHECK(size_shape->energy(turned(ideal, mesh.dim, 1)) < 1e-25);
            CHECK(largest(gradient(*size_shape, turned(ideal, mesh.dim, 1))) < 1e-13);
            for (double factor : {0.5, 0.9, 1.1, 2.0}) {
                const std::vector<double> y = turned(ideal, mesh.dim, factor);
                const double D = std::pow(factor, mesh.dim), eta = 0.5 * (D + 1 / D);
                CHECK(deviation->energy(y) < 1e-25);
                CHECK(size_shape->energy(y) == doctest::Approx(size_shape->uniform(eta)).epsilon(1e-10));
            }
            CHECK(size_shape->energy(wavy(ideal, mesh.dim, 0.03)) > 1e-5);
        }
}

TEST_CASE("a mesh with the same distortion everywhere has the energy uniform(), and mean_slope() knows it") {
    for (const Mesh& mesh : {raise_degree(square_mesh(2), 2), cube_mesh(2)})
        for (const Assembly assembly : assemblies) {
            std::vector<double> x = mesh.x;
            for (std::size_t i = 0; i < x.size(); i += mesh.dim) x[i] *= 2;  // det F = 2
            const double eta = mesh.dim == 2 ? 1.25 : 2 / std::cbrt(4);      // (4 + n - 1) / (n 2^(2/n))
            struct Expected {
                Objective objective;
                double eta, slope;
            };
            for (const Expected& expected : {Expected{Objective::squared, eta, eta},
                                             Expected{Objective::deviation, eta, eta - 1},
                                             Expected{Objective::size_shape, 1.25 * eta, 1.25 * eta - 1}}) {
                const auto E = make_energy(mesh, mesh.x, AssembledParams{{expected.objective}, assembly});
                CHECK(E->energy(x) == doctest::Approx(E->uniform(expected.eta)).epsilon(1e-12));
                CHECK(E->mean_slope(E->energy(x)) == doctest::Approx(expected.slope).epsilon(1e-12));
                CHECK(E->mean_slope(-1e-15) == 0);  // rounding
            }
            const auto squared = make_energy(mesh, mesh.x, AssembledParams{{Objective::squared}, assembly});
            CHECK(squared->uniform(20) == doctest::Approx(400 * squared->domain_volume()).epsilon(1e-14));
        }
}

namespace {

// Asks both for a step that folds elements, so that their quadrature gets finer.
void refine(DistortionEnergy& E, const Mesh& mesh, const std::vector<double>& x) {
    for (int times = 0; times < 3; ++times) {
        REQUIRE(E.valid_fraction(x, wavy(mesh.x, mesh.dim, 0.15 + 0.05 * times)) < 1);
        REQUIRE(E.refine_quadrature());
    }
    REQUIRE(!E.refine_quadrature());  // nothing folded since
    REQUIRE(E.refined_elements() > 0);
}

}  // namespace

TEST_CASE("elements with a finer quadrature: both assemblies agree, in parts too, and derivatives have slope 2") {
    for (const Mesh& mesh : meshes()) {
        if (mesh.degree == 1) continue;
        const std::vector<double> ideal = straight_sided(mesh), x = wavy(mesh.x, mesh.dim, 0.03);
        for (const Objective objective : objectives) {
            SimdEnergy simd(mesh, ideal, {objective, 0, 0.5, 0}), coarse(mesh, ideal, {objective, 0, 0.5, 0});
            PlainEnergy plain(mesh, ideal, {objective, 0, 0.5, 0});
            refine(simd, mesh, x);
            refine(plain, mesh, x);
            CHECK(simd.refined_elements() == plain.refined_elements());
            CHECK(simd.hessian_work() == plain.hessian_work());
            CHECK(simd.hessian_work() > coarse.hessian_work());
            check_same(simd, plain, x);
            const DistortionStatistics a = simd.statistics(x), b = plain.statistics(x);
            if (mesh.dim == 2) {
                CHECK(simd.energy(x) == doctest::Approx(coarse.energy(x)).epsilon(0.02));  // the same integral
                CHECK(simd.energy(x) != coarse.energy(x));
            } else {
                CHECK(simd.energy(x) > coarse.energy(x));  // a barrier
            }
            CHECK(a.relative_quality == doctest::Approx(coarse.statistics(x).relative_quality).epsilon(0.02));
            CHECK(b.relative_quality == doctest::Approx(a.relative_quality).epsilon(1e-13));
            CHECK(relative_difference(a.element_max, b.element_max) <= 1e-13);

            Restriction of_simd, of_plain;
            const auto part = simd.part(x, some_nodes(mesh.nodes()), of_simd);
            const auto other = plain.part(x, some_nodes(mesh.nodes()), of_plain);
            CHECK(part->refined_elements() > 0);
            CHECK(part->refined_elements() == other->refined_elements());
            CHECK(part->domain_volume() == doctest::Approx(other->domain_volume()));
            CHECK(part->energy(on_part(x, of_simd.node, mesh.dim)) ==
                  doctest::Approx(other->energy(on_part(x, of_plain.node, mesh.dim))).epsilon(1e-12));

            std::vector<double> d(x.size()), error;
            for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(7.0 * i);
            for (const double t : {2e-3, 1e-3}) {
                std::vector<double> plus = x, minus = x;
                double slope = 0;
                const std::vector<double> g = gradient(simd, x);
                for (std::size_t i = 0; i < d.size(); ++i) {
                    plus[i] += t * d[i];
                    minus[i] -= t * d[i];
                    slope += g[i] * d[i];
                }
                error.push_back(std::abs((simd.energy(plus) - simd.energy(minus)) / (2 * t) - slope));
            }
            CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.1));
        }
    }
}

TEST_CASE("a part hands its refinements back") {
    const Mesh mesh = raise_degree(square_mesh(3), 3);
    const std::vector<double> x = wavy(mesh.x, 2, 0.02);
    for (const Assembly assembly : assemblies) {
        const auto whole = make_energy(mesh, straight_sided(mesh), AssembledParams{{}, assembly});
        Restriction around;
        const auto part = whole->part(x, some_nodes(mesh.nodes()), around);
        const std::vector<int>& node = around.node;
        REQUIRE(part->valid_fraction(on_part(x, node, 2), on_part(wavy(mesh.x, 2, 0.2), node, 2)) < 1);
        REQUIRE(part->refine_quadrature());
        CHECK(whole->take_over_refinements(*part));
        CHECK(whole->refined_elements() == part->refined_elements());
        const auto again = whole->part(x, some_nodes(mesh.nodes()), around);
        CHECK(again->energy(on_part(x, node, 2)) ==
              doctest::Approx(part->energy(on_part(x, node, 2))).epsilon(1e-13));
        // What the whole has had before is not handed back a second time.
        const double before = whole->energy(x);
        CHECK(!again->refine_quadrature());
        CHECK(!whole->take_over_refinements(*again));
        CHECK(whole->energy(x) == before);
        REQUIRE(whole->valid_fraction(x, wavy(mesh.x, 2, 0.25)) < 1);  // not yet refined
        CHECK(!whole->part(x, some_nodes(mesh.nodes()), around)->refine_quadrature());
    }
}
