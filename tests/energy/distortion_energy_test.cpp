#include "energy/simd_energy.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "support/assemblies.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Case {
    Mesh mesh;
    std::vector<double> ideal, x;  // x: a valid deformed mesh
};

Case deformed(const Mesh& linear, int degree, double amplitude) {
    const Mesh mesh = raise_degree(linear, degree);
    return {mesh, straight_sided(mesh), wavy(mesh.x, mesh.dim, amplitude)};
}

std::vector<Case> cases() {
    return {deformed(square_mesh(3), 1, 0.05), deformed(square_mesh(2), 3, 0.05), deformed(ring_mesh(8, 3, 4), 2, 0.02),
            deformed(cube_mesh(2), 1, 0.04), deformed(cube_mesh(1), 2, 0.04)};
}

std::vector<double> shifted(std::vector<double> x, const std::vector<double>& d, double t) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += t * d[i];
    return x;
}

double dot_of(const std::vector<double>& a, const std::vector<double>& b) {
    double s = 0;
    for (std::size_t i = 0; i < a.size(); ++i) s += a[i] * b[i];
    return s;
}

std::vector<double> gradient(DistortionEnergy& E, const std::vector<double>& x) {
    std::vector<double> g(x.size(), 0.0);
    E.add_gradient(x, g);
    return g;
}

BlockCsr hessian(DistortionEnergy& E, const Mesh& mesh, const std::vector<double>& x, HessianKind kind) {
    BlockCsr H = matrix_of_cells(mesh.nodes(), mesh.dim, mesh.elements, mesh.element_nodes());
    E.add_hessian(x, kind, H);
    return H;
}

}  // namespace

TEST_CASE("linear elements take one point, whatever exactness is asked for") {
    for (const Mesh& linear : {square_mesh(3), cube_mesh(2)}) {
        const Case c = deformed(linear, 1, 0.04);
        SimdEnergy one(c.mesh, c.ideal, {Objective::squared, 0, 1, 0});
        SimdEnergy many(c.mesh, c.ideal, {Objective::squared, 0, 1, 5});
        CHECK(many.energy(c.x) == one.energy(c.x));
        CHECK(gradient(many, c.x) == gradient(one, c.x));
        for (const HessianKind kind : {HessianKind::full, HessianKind::projected, HessianKind::damping})
            CHECK(hessian(many, c.mesh, c.x, kind).value == hessian(one, c.mesh, c.x, kind).value);
    }
}

TEST_CASE("at the identity the objectives are the domain volume and zero") {
    for (const Case& c : cases()) {
        SimdEnergy squared(c.mesh, c.ideal, {Objective::squared, 0, 1, 0});
        SimdEnergy deviation(c.mesh, c.ideal, {Objective::deviation, 0, 1, 0});
        CHECK(squared.energy(c.ideal) == doctest::Approx(squared.domain_volume()));
        CHECK(deviation.energy(c.ideal) < 1e-25);
        const DistortionStatistics statistics = squared.statistics(c.ideal);
        CHECK(statistics.relative_quality == doctest::Approx(1));
        CHECK(statistics.max_distortion == doctest::Approx(1));
    }
    SimdEnergy square(square_mesh(2), square_mesh(2).x, {});
    CHECK(square.domain_volume() == doctest::Approx(1));
}

TEST_CASE("a uniform stretch has the distortion of its matrix everywhere") {
    const Mesh mesh = raise_degree(square_mesh(2), 3);
    std::vector<double> x = mesh.x;
    for (std::size_t i = 0; i < x.size(); i += 2) x[i] *= 2;  // eta = (4 + 1) / (2 * 2) = 1.25
    CHECK(SimdEnergy(mesh, mesh.x, {Objective::squared, 0, 1, 0}).energy(x) == doctest::Approx(1.25 * 1.25));
    SimdEnergy deviation(mesh, mesh.x, {Objective::deviation, 0, 1, 0});
    CHECK(deviation.energy(x) == doctest::Approx(0.0625));
    CHECK(deviation.statistics(x).relative_quality == doctest::Approx(0.8));
    CHECK(deviation.statistics(x).max_distortion == doctest::Approx(1.25));
}

TEST_CASE("the energy is infinite as soon as one element is inverted or flat") {
    for (const Mesh& mesh : {square_mesh(3), cube_mesh(2)}) {
        SimdEnergy E(mesh, mesh.x, {});
        std::vector<double> x = mesh.x;
        x[mesh.element(0)[0] * mesh.dim] += 3;
        CHECK(std::isinf(E.energy(x)));
        std::fill(x.begin(), x.end(), 0.0);
        CHECK(std::isinf(E.energy(x)));
        CHECK(std::isfinite(SimdEnergy(mesh, mesh.x, {Objective::squared, 0.1, 1, 0}).energy(x)));
    }
}

TEST_CASE("a Hessian in another order of its rows has the same blocks, in both assemblies") {
    const Mesh mesh = raise_degree(cube_mesh(2), 2);
    const std::vector<double> ideal = straight_sided(mesh), x = wavy(ideal, 3, 0.01);
    for (const Assembly assembly : assemblies) {
        const auto E = make_energy(mesh, ideal, AssembledParams{{}, assembly});
        const auto ordered = make_energy(mesh, ideal, AssembledParams{{}, assembly});
        REQUIRE(std::isfinite(E->energy(x)));
        std::vector<int> reversed;
        for (int i = mesh.nodes(); i-- > 0;) reversed.push_back(i);
        ordered->order_hessian([&](const BlockCsr&) { return std::make_shared<RowOrder>(row_order(reversed)); });
        BlockCsr H = E->hessian_pattern(), P = ordered->hessian_pattern();
        E->add_hessian(x, HessianKind::full, H);
        ordered->add_hessian(x, HessianKind::full, P);
        for (int i = 0; i < H.n; ++i)
            for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
                const double* const there = P.block(P.find(P.row_of(i), P.row_of(H.col[k])));
                CHECK(std::equal(there, there + 9, H.block(k)));
            }
    }
}

TEST_CASE("gradient and Hessian have slope 2 against central differences") {
    for (const Case& c : cases())
        for (const Objective objective : {Objective::squared, Objective::deviation})
            for (const double alpha : {1.0, 0.5}) {
                SimdEnergy E(c.mesh, c.ideal, {objective, 0, alpha, 0});
                std::vector<double> direction(c.x.size());
                for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = std::sin(7.0 * i);
                const double exact = dot_of(gradient(E, c.x), direction);
                std::vector<double> exact2(c.x.size());
                multiply(hessian(E, c.mesh, c.x, HessianKind::full), direction.data(), exact2.data());
                double first[2], second[2];
                for (int level = 0; level < 2; ++level) {
                    const double t = 2e-3 / (1 + level);
                    const auto plus = shifted(c.x, direction, t), minus = shifted(c.x, direction, -t);
                    first[level] = std::abs((E.energy(plus) - E.energy(minus)) / (2 * t) - exact);
                    const auto difference = shifted(gradient(E, plus), gradient(E, minus), -1);
                    double squared = 0;
                    for (std::size_t i = 0; i < difference.size(); ++i)
                        squared += std::pow(difference[i] / (2 * t) - exact2[i], 2);
                    second[level] = std::sqrt(squared);
                }
                CHECK(std::log2(first[0] / first[1]) == doctest::Approx(2).epsilon(0.1));
                CHECK(std::log2(second[0] / second[1]) == doctest::Approx(2).epsilon(0.1));
            }
}

TEST_CASE("Hessians are symmetric and the projected ones positive semidefinite") {
    for (const Case& c : cases()) {
        SimdEnergy E(c.mesh, c.ideal, {Objective::deviation, 0, 1, 0});
        for (const HessianKind kind : {HessianKind::full, HessianKind::projected, HessianKind::damping}) {
            const BlockCsr H = hessian(E, c.mesh, c.x, kind);
            const int d = H.d;
            double scale = 0;
            for (double v : H.value) scale = std::max(scale, std::abs(v));
            for (int i = 0; i < H.n; ++i)
                for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
                    const double* transposed = H.block(H.find(H.col[k], i));
                    for (int a = 0; a < d; ++a)
                        for (int b = 0; b < d; ++b)
                            CHECK(std::abs(H.block(k)[a * d + b] - transposed[b * d + a]) <= 1e-13 * scale);
                }
            if (kind == HessianKind::full) continue;
            std::vector<double> v(H.size()), Hv(H.size());
            for (int trial = 0; trial < 50; ++trial) {
                for (std::size_t i = 0; i < v.size(); ++i) v[i] = std::sin((trial + 1.3) * (i + 1));
                multiply(H, v.data(), Hv.data());
                CHECK(dot_of(v, Hv) > -1e-12 * scale);
            }
        }
    }
}

TEST_CASE("rigid motions and scalings of the mesh do not change the energy") {
    for (const Case& c : cases()) {
        SimdEnergy E(c.mesh, c.ideal, {Objective::deviation, 0, 1, 0});
        std::vector<double> y = c.x;
        const double cosine = std::cos(0.7), sine = std::sin(0.7);
        for (std::size_t i = 0; i < y.size(); i += c.mesh.dim) {
            const double a = y[i], b = y[i + 1];
            y[i] = 3 * (cosine * a - sine * b) + 5;
            y[i + 1] = 3 * (sine * a + cosine * b) - 2;
            if (c.mesh.dim == 3) y[i + 2] = 3 * y[i + 2] + 1;
        }
        CHECK(E.energy(y) == doctest::Approx(E.energy(c.x)).epsilon(1e-10));
    }
}

TEST_CASE("element weights keep the total weight and favour small elements") {
    const Mesh ring = ring_mesh(12, 4, 20);
    SimdEnergy plain(ring, ring.x, {Objective::squared, 0, 1, 0}),
        weighted(ring, ring.x, {Objective::squared, 0, 0, 0});
    CHECK(weighted.energy(ring.x) == doctest::Approx(plain.energy(ring.x)));
    std::vector<double> x = ring.x;
    x[0] -= 0.05;  // a node of the inner circle, where the elements are small
    CHECK(weighted.energy(x) - weighted.energy(ring.x) > 10 * (plain.energy(x) - plain.energy(ring.x)));
}

TEST_CASE("an ideal element without volume is refused") {
    const Mesh mesh = square_mesh(1);
    std::vector<double> flat = mesh.x;
    for (std::size_t i = 1; i < flat.size(); i += 2) flat[i] = 0;
    CHECK_THROWS_AS(SimdEnergy(mesh, flat, {}), InputError);
}

TEST_CASE("energy, gradient, Hessian and statistics have the same bits for any number of threads") {
    const int before = max_threads();
    for (const Case& c :
         {deformed(square_mesh(40), 1, 0.005), deformed(square_mesh(7), 4, 0.01), deformed(cube_mesh(8), 1, 0.01)}) {
        SimdEnergy E(c.mesh, c.ideal, {});
        set_threads(1);
        const double energy = E.energy(c.x);
        const std::vector<double> g = gradient(E, c.x);
        const LargeVector<double> h = hessian(E, c.mesh, c.x, HessianKind::projected).value;
        const DistortionStatistics statistics = E.statistics(c.x);
        CHECK(std::isfinite(energy));
        for (int threads : {2, 3, 8}) {
            set_threads(threads);
            CHECK(E.energy(c.x) == energy);
            CHECK(gradient(E, c.x) == g);
            CHECK(hessian(E, c.mesh, c.x, HessianKind::projected).value == h);
            CHECK(E.statistics(c.x).relative_quality == statistics.relative_quality);
            CHECK(E.statistics(c.x).element_max == statistics.element_max);
            // Set up by that many threads: the same energy of the same mesh.
            CHECK(SimdEnergy(c.mesh, c.ideal, {}).energy(c.x) == energy);
        }
    }
    set_threads(before);
}

// K_ee ~ w'_e |e|, and by scaling a linear element's Hessian of eta^2 goes with |e| / size^2: in 2D as w'_e.
TEST_CASE("damping makes an element stiff by the power 3/2 of its size, if the weights of the objective leave that") {
    for (const double alpha : {1.0, 0.3}) {
        const double ratio = 100;  // of the sizes of two triangles that share no node
        std::vector<double> x = {0, 0, 1, 0, 0, 1, 5, 5, 5 + ratio, 5, 5, 5 + ratio};
        const Mesh mesh = linear_mesh(2, x, {0, 1, 2, 3, 4, 5}, [](const double*) { return "wall"; });
        const auto E = make_energy(mesh, mesh.x, {.objective = Objective::squared, .weight_exponent = alpha});
        const BlockCsr H = hessian(*E, mesh, mesh.x, HessianKind::damping);
        const double small = H.block(H.find(0, 0))[0], large = H.block(H.find(3, 3))[0];
        CHECK(large / small == doctest::Approx(std::pow(ratio, 2 * std::min(0.75, alpha) - 2)).epsilon(1e-12));
    }
}

TEST_CASE("the scale of the damping does not depend on the unit of length") {
    for (const double unit : {1.0, 1e3}) {
        Case at = deformed(square_mesh(3), 1, 0.05);
        for (std::vector<double>* v : {&at.mesh.x, &at.ideal, &at.x})
            for (double& each : *v) each *= unit;
        const auto E = make_energy(at.mesh, at.ideal, {.objective = Objective::squared});
        CHECK(E->mean_slope(E->energy(at.x)) == doctest::Approx(std::sqrt(E->energy(at.x) / (unit * unit))));
    }
}
