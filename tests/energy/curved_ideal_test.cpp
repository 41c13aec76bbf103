// The energy on an ideal mesh with curved elements, whose Jacobian A is another one at each point.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "energy/distortion_energy.hpp"
#include "energy/refined_rule.hpp"
#include "support/energy_checks.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Case {
    Mesh mesh;
    std::vector<double> ideal;  // curved
};

std::vector<Case> cases() {
    std::vector<Case> cases;
    for (const Mesh& mesh : {raise_degree(square_mesh(2), 2), raise_degree(square_mesh(2), 4),
                             raise_degree(ring_mesh(7, 2, 3), 3), raise_degree(cube_mesh(1), 2),
                             raise_degree(cube_mesh(1), 3)})
        cases.push_back({mesh, wavy(mesh.x, mesh.dim, 0.02)});
    return cases;
}

std::unique_ptr<DistortionEnergy> energy_on(const Case& c, Assembly assembly, Objective objective, double alpha = 1) {
    AssembledParams params = with(objective, assembly, alpha);
    params.curved_ideal = true;
    return make_energy(c.mesh, c.ideal, params);
}

double largest(const std::vector<double>& values) {
    double most = 0;
    for (double v : values) most = std::max(most, std::abs(v));
    return most;
}

}  // namespace

TEST_CASE("a curved ideal mesh has no distortion where it is, and a stretch has that of its matrix everywhere") {
    for (const Case& c : cases())
        for (const Assembly assembly : assemblies)
            for (const double alpha : {1.0, 0.5}) {
                const auto deviation = energy_on(c, assembly, Objective::deviation, alpha);
                CHECK(deviation->energy(c.ideal) < 1e-24);
                CHECK(largest(gradient(*deviation, c.ideal)) < 1e-12);
                CHECK(energy_on(c, assembly, Objective::size_shape, alpha)->energy(c.ideal) < 1e-24);
                const double eta = c.mesh.dim == 2 ? 5.0 / 4 : 6 / (3 * std::pow(2, 2.0 / 3));
                const std::vector<double> x = stretched(c.ideal, c.mesh.dim);
                CHECK(deviation->energy(x) == doctest::Approx(deviation->uniform(eta)).epsilon(1e-12));
                CHECK(deviation->statistics(x).max_distortion == doctest::Approx(eta).epsilon(1e-12));
                CHECK(deviation->statistics(x).relative_quality == doctest::Approx(1 / eta).epsilon(1e-12));
            }
}

TEST_CASE("the volume is that of the curved mesh") {
    Mesh mesh = raise_degree(ring_mesh(12, 2, 3), 4);
    for (int i = 0; i < mesh.nodes(); ++i) {  // the polygons to circles, to the degree of the elements
        double* const x = point(mesh.x, i, 2);
        const double sector = 2 * std::numbers::pi / 12;
        const double from_corner = std::abs(std::remainder(std::atan2(x[1], x[0]), sector));
        for (int a = 0; a < 2; ++a) x[a] *= std::cos(sector / 2 - from_corner) / std::cos(sector / 2);
    }
    for (const Assembly assembly : assemblies)
        CHECK(energy_on({mesh, mesh.x}, assembly, Objective::squared)->domain_volume() ==
              doctest::Approx(std::numbers::pi * (3 * 3 - 1)).epsilon(1e-5));
}

TEST_CASE("both assemblies agree on a curved ideal mesh, with refined quadratures and in parts") {
    for (const Case& c : cases())
        for (const Objective objective : {Objective::squared, Objective::deviation, Objective::size_shape}) {
            const std::vector<double> x = wavy(stretched(c.ideal, c.mesh.dim), c.mesh.dim, 0.005);
            std::unique_ptr<DistortionEnergy> energy[2], part[2];
            Restriction around[2];
            std::vector<char> moves(c.mesh.nodes(), 0);
            for (int i = 1; i < c.mesh.nodes(); i += 4) moves[i] = 1;
            for (int k = 0; k < 2; ++k) {
                energy[k] = energy_on(c, assemblies[k], objective, 0.5);
                part[k] = energy[k]->part(x, moves, around[k]);
            }
            check_same(*energy[0], *energy[1], x, 1e-11);
            std::vector<double> on_part[2];
            for (int k = 0; k < 2; ++k)
                for (const int i : around[k].node)
                    on_part[k].insert(on_part[k].end(), point(x, i, c.mesh.dim), point(x, i, c.mesh.dim) + c.mesh.dim);
            CHECK(part[0]->energy(on_part[0]) == doctest::Approx(part[1]->energy(on_part[1])).epsilon(1e-12));
            CHECK(part[0]->domain_volume() == doctest::Approx(part[1]->domain_volume()).epsilon(1e-12));
            std::vector<double> folded = x;  // a node inside an edge of the first element goes too far
            const int far = c.mesh.element(0)[c.mesh.dim + 1];
            for (int a = 0; a < c.mesh.dim; ++a) folded[far * c.mesh.dim + a] += 2;
            for (const auto& of : energy) {
                REQUIRE(of->valid_fraction(x, folded) < 1);
                of->refine_quadrature();
            }
            REQUIRE(energy[0]->refined_elements() > 0);
        }
}

TEST_CASE("straight elements are the same in both ways, and gradient and Hessian on curved ones have slope 2") {
    for (const Case& c : cases()) {
        const std::vector<double> straight = straight_sided(c.mesh), x = wavy(c.ideal, c.mesh.dim, 0.005);
        const auto usual = make_energy(c.mesh, straight, {.weight_exponent = 0.5});
        check_same(*energy_on({c.mesh, straight}, Assembly::simd, Objective::deviation, 0.5), *usual, x, 1e-11);
        const auto E = energy_on(c, Assembly::simd, Objective::squared, 0.5);
        std::vector<double> d(x.size());
        for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(1.0 + static_cast<double>(i));
        const auto along = [&](double t) {
            std::vector<double> y = x;
            for (std::size_t i = 0; i < y.size(); ++i) y[i] += t * d[i];
            return y;
        };
        BlockCsr H = E->hessian_pattern();
        E->add_hessian(x, HessianKind::full, H);
        std::vector<double> Hd(x.size());
        multiply(H, d.data(), Hd.data());
        const std::vector<double> g = gradient(*E, x);
        double slope = 0;
        for (std::size_t i = 0; i < d.size(); ++i) slope += g[i] * d[i];
        double of_energy[2], of_gradient[2];
        for (int k = 0; k < 2; ++k) {
            const double t = k == 0 ? 2e-3 : 1e-3;
            const std::vector<double> there = gradient(*E, along(t)), back = gradient(*E, along(-t));
            of_energy[k] = std::abs((E->energy(along(t)) - E->energy(along(-t))) / (2 * t) - slope);
            of_gradient[k] = 0;
            for (std::size_t i = 0; i < d.size(); ++i)
                of_gradient[k] = std::max(of_gradient[k], std::abs((there[i] - back[i]) / (2 * t) - Hd[i]));
        }
        CHECK(std::log2(of_energy[0] / of_energy[1]) == doctest::Approx(2).epsilon(0.1));
        CHECK(std::log2(of_gradient[0] / of_gradient[1]) == doctest::Approx(2).epsilon(0.1));
    }
}
