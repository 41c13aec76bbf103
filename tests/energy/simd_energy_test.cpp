#include "energy/simd_energy.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <span>

#include "base/error.hpp"
#include "lessons/plain_energy.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr HessianKind kinds[] = {HessianKind::full, HessianKind::projected, HessianKind::damping};
constexpr Objective objectives[] = {Objective::squared, Objective::deviation, Objective::size_shape};

double largest(std::span<const double> v) {
    double most = 0;
    for (double entry : v) most = std::max(most, std::abs(entry));
    return most;
}

// max |a - b| in units of max |b|; nan where an entry is nan.
double relative_difference(std::span<const double> a, std::span<const double> b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!(std::abs(a[i] - b[i]) <= most)) most = std::abs(a[i] - b[i]);
    return most / largest(b);
}

// Energy, gradient and the three Hessians against the plain ones, each to `tolerance` of its largest entry.
void check_against_plain(const Mesh& mesh, const std::vector<double>& ideal, const std::vector<double>& x,
                         double tolerance) {
    for (const Objective objective : objectives) {
        const DistortionParams params{objective, 0, 0.5, 0};
        SimdEnergy fast(mesh, ideal, params);
        PlainEnergy plain(mesh, ideal, params);
        REQUIRE(std::isfinite(plain.energy(x)));
        CHECK(std::abs(fast.energy(x) - plain.energy(x)) <= tolerance * plain.energy(x));
        std::vector<double> g(x.size(), 0.0), expected(x.size(), 0.0);
        fast.add_gradient(x, g);
        plain.add_gradient(x, expected);
        CHECK(relative_difference(g, expected) <= tolerance);
        for (const HessianKind kind : kinds) {
            BlockCsr H = fast.hessian_pattern(), oracle = fast.hessian_pattern();
            fast.add_hessian(x, kind, H);
            plain.add_hessian(x, kind, oracle);
            CHECK(relative_difference(H.value, oracle.value) <= tolerance);
        }
    }
}

// One element whose Jacobian is F: the ideal element is the reference one.
template <int n>
Mesh single_element(int degree) {
    std::vector<double> x((n + 1) * n, 0.0);
    std::vector<int> nodes(n + 1);
    for (int k = 0; k < n; ++k) {
        x[(k + 1) * n + k] = 1;
        nodes[k + 1] = k + 1;
    }
    return raise_degree(linear_mesh(n, x, nodes, [](const double*) { return "boundary"; }), degree);
}

template <int n>
std::vector<double> mapped(const std::vector<double>& x, const Mat<n>& F) {
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t i = 0; i < x.size(); i += n)
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) y[i + a] += F[a][b] * x[i + b];
    return y;
}

// A rotation by `angle`; in 3D about an axis that no coordinate plane contains.
template <int n>
Mat<n> rotation(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    if constexpr (n == 2) {
        return {{{c, -s}, {s, c}}};
    } else {
        const Vec<3> axis = {2.0 / 7, 3.0 / 7, 6.0 / 7};
        Mat<3> R;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) R[i][j] = (1 - c) * axis[i] * axis[j] + (i == j ? c : 0);
        for (int i = 0; i < 3; ++i) {
            R[(i + 1) % 3][i] += s * axis[(i + 2) % 3];
            R[i][(i + 1) % 3] -= s * axis[(i + 2) % 3];
        }
        return R;
    }
}

// rotation(left) diag(s) rotation(right)
template <int n>
Mat<n> stretched(double left, const Vec<n>& s, double right) {
    Mat<n> F = rotation<n>(right);
    for (int i = 0; i < n; ++i)
        for (double& v : F[i]) v *= s[i];
    return multiply<n>(rotation<n>(left), F);
}

template <int n>
void check_single_elements() {
    const std::vector<Vec<3>> stretches = {{1, 1, 1},      {2, 2, 2},       {2, 1, 1},       {1, 1, 0.5},
                                           {3, 0.1, 1.7},  {1, 0.3, 0.3},   {1, 1e-3, 1},    {1e-3, 1e-3, 1e-3},
                                           {40, 0.025, 1}, {1e-2, 1, 1e-2}, {0.2, 5, 0.001}, {1 + 1e-9, 1, 1}};
    for (int degree : {1, 2}) {
        const Mesh mesh = single_element<n>(degree);
        for (int step = 0; step < 16; ++step)
            for (const Vec<3>& s : stretches) {
                Vec<n> values;
                std::copy_n(s.begin(), n, values.begin());
                const Mat<n> F = stretched<n>(step * 0.4, values, step * step * 0.1 - 2);
                // Rounding of F alone moves its least singular value by this part.
                const double condition = *std::max_element(values.begin(), values.end()) /
                                         *std::min_element(values.begin(), values.end());
                // (eta - 1)^2 and its derivatives vanish at a similarity: nothing to compare relative to.
                if (condition < 1.001) continue;
                check_against_plain(mesh, mesh.x, mapped<n>(mesh.x, F), 1e-13 * condition * condition);
            }
    }
}

// Central differences of the gradient against the full Hessian: the error must fall as t^2.
void check_hessian_slope(DistortionEnergy& E, const std::vector<double>& x) {
    const auto gradient = [&](double t) {
        std::vector<double> y = x, g(x.size(), 0.0);
        for (std::size_t i = 0; i < y.size(); ++i) y[i] += t * std::sin(3.0 * i + 1);
        E.add_gradient(y, g);
        return g;
    };
    BlockCsr H = E.hessian_pattern();
    E.add_hessian(x, HessianKind::full, H);
    std::vector<double> d(x.size()), Hd(x.size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(3.0 * i + 1);
    multiply(H, d.data(), Hd.data());
    double error[2];
    for (int level = 0; level < 2; ++level) {
        const double t = 2e-3 / (1 + level);
        const std::vector<double> plus = gradient(t), minus = gradient(-t);
        double squared = 0;
        for (std::size_t i = 0; i < d.size(); ++i) squared += std::pow((plus[i] - minus[i]) / (2 * t) - Hd[i], 2);
        error[level] = std::sqrt(squared);
    }
    CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.1));
}

}  // namespace

TEST_CASE("energies, gradients and Hessians of whole meshes are those of the plain assembly") {
    // Numbers of elements that are and are not multiples of any number of lanes.
    const Mesh meshes[] = {square_mesh(3), raise_degree(square_mesh(2), 4), raise_degree(ring_mesh(7, 2, 3), 2),
                           cube_mesh(2),   raise_degree(cube_mesh(1), 3),   single_element<3>(2), single_element<2>(1)};
    for (const Mesh& mesh : meshes) {
        const std::vector<double> ideal = straight_sided(mesh);
        check_against_plain(mesh, ideal, wavy(mesh.x, mesh.dim, 0.02), 1e-12);
    }
}

TEST_CASE("elements stretched and turned by any angle, with equal and with tiny singular values: 2D") {
    check_single_elements<2>();
}
TEST_CASE("elements stretched and turned by any angle, with equal and with tiny singular values: 3D") {
    check_single_elements<3>();
}

TEST_CASE("nearly inverted elements: det F = 1e-8") {
    // Nodes moved exactly onto a plane but for 2^-27 or so: the determinant has no rounding error to speak of.
    const Mesh triangle = single_element<2>(1), tetrahedron = single_element<3>(1);
    check_against_plain(triangle, triangle.x, {0, 0, 1, 0, 0.25, 1e-8}, 1e-12);
    check_against_plain(tetrahedron, tetrahedron.x, {0, 0, 0, 1, 0, 0, 0.25, 1, 0, 0.5, 0.125, 1e-8}, 1e-12);
}

TEST_CASE("at a rotation the Hessian of Eq. 5 vanishes and the others have the similarities as kernel") {
    const Mesh mesh = single_element<3>(1);
    const std::vector<double> x = mapped<3>(mesh.x, rotation<3>(1.1));
    SimdEnergy E(mesh, mesh.x, {Objective::deviation, 0, 1, 0});
    BlockCsr H = E.hessian_pattern();
    E.add_hessian(x, HessianKind::full, H);
    CHECK(largest(H.value) < 1e-14);
    E.add_hessian(x, HessianKind::damping, H);
    CHECK(largest(H.value) > 0.1);
    std::vector<double> turned = mapped<3>(x, {{{2, 1, 2}, {-1, 2, 3}, {-2, -3, 2}}}), Hx(x.size());
    multiply(H, turned.data(), Hx.data());
    CHECK(largest(Hx) < 1e-13);
}

TEST_CASE("one inverted element among many is found in any lane, and leaves the statistics of the others alone") {
    const Mesh mesh = square_mesh(3);  // 18 triangles
    SimdEnergy E(mesh, mesh.x, {});
    for (int e = 0; e < mesh.element_count(); ++e) {
        Mesh mirrored = mesh;  // this one walked the other way round
        std::swap(mirrored.elements[e * 3 + 1], mirrored.elements[e * 3 + 2]);
        CHECK_THROWS_AS(SimdEnergy(mirrored, mesh.x, {}), InputError);
        std::vector<double> x = mesh.x;
        for (int k = 0; k < 2; ++k) std::swap(x[mesh.element(e)[1] * 2 + k], x[mesh.element(e)[2] * 2 + k]);
        CHECK(std::isinf(E.energy(x)));
        const DistortionStatistics statistics = E.statistics(x);
        CHECK(std::isinf(statistics.element_max[e]));
        CHECK(std::isinf(statistics.max_distortion));
        CHECK(statistics.relative_quality == 0);
    }
}

TEST_CASE("regularised, gradients and Hessians of flat, folded and inverted elements are finite and have slope 2") {
    const Mesh mesh = single_element<3>(1);
    for (const Mat<3>& F :
         {Mat<3>{}, Mat<3>{{{0, 0, 2}, {0, 0, 0}, {0, 0, 0}}}, Mat<3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}},
          Mat<3>{{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}}, Mat<3>{{{0.3, 1, 0}, {0.3, 1, 0}, {2, 0.1, 0.4}}}})
        for (const Objective objective : objectives) {
            SimdEnergy E(mesh, mesh.x, {objective, 0.5, 1, 0});
            check_hessian_slope(E, mapped<3>(mesh.x, F));
        }
}
