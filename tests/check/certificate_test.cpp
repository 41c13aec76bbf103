#include "check/certificate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "base/small_matrix.hpp"
#include "support/high_order.hpp"
#include "mesh/lagrange.hpp"
#include "support/determinant.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Mesh one_element(int dim, int degree) {
    std::vector<double> x(static_cast<std::size_t>(dim) * (dim + 1), 0.0);
    std::vector<int> element;
    for (int k = 0; k <= dim; ++k) {
        if (k > 0) x[k * dim + k - 1] = 1;
        element.push_back(k);
    }
    return with_degree(linear_mesh(dim, x, element, [](const double*) { return "wall"; }), degree);
}

// Least scaled determinant of an element at a lattice of points.
template <int n>
double sampled_minimum(const Mesh& mesh, const std::vector<double>& x, int e, int steps) {
    const LagrangeBasis basis(n, mesh.degree), linear(n, 1);
    const double centre[3] = {0.2, 0.2, 0.2};
    const double straight = std::abs(determinant_at<n>(linear, mesh.element(e), x, centre));
    double least = std::numeric_limits<double>::infinity();
    for (const MultiIndex& a : gmsh_node_order(n, steps)) {
        const double xi[3] = {a[1] / (1.0 * steps), a[2] / (1.0 * steps), a[3] / (1.0 * steps)};
        least = std::min(least, determinant_at<n>(basis, mesh.element(e), x, xi) / straight);
    }
    return least;
}

// The node of P2 between vertices 0 and 1 moved along its edge: scaled determinant 1 + 4 s (1 - 2 xi - ...), least at
// vertex 1 with the value 1 - 4 s (s in edge lengths).
std::vector<double> with_moved_midpoint(const Mesh& mesh, double s) {
    std::vector<double> x = mesh.x;
    const int node = mesh.element(0)[mesh.dim + 1];
    x[static_cast<std::size_t>(node) * mesh.dim] += s;
    return x;
}

}  // namespace

TEST_CASE("straight-sided elements have scaled determinant one, linear ones exactly") {
    for (int dim = 2; dim <= 3; ++dim)
        for (int degree : {1, 2, 4}) {
            const Mesh mesh = with_degree(dim == 2 ? square_mesh(3) : cube_mesh(2), degree);
            const Certificate c = certify(mesh, mesh.x);
            CHECK(c.valid);
            CHECK(c.uncertified.empty());
            CHECK(c.undecided == 0);
            for (double bound : c.certified_bound) {
                if (degree == 1) CHECK(bound == 1);
                else CHECK(bound == doctest::Approx(1).epsilon(1e-9));
            }
        }
}

TEST_CASE("the element that becomes singular at a vertex is judged by the exact value 1 - 4 s") {
    for (int dim = 2; dim <= 3; ++dim) {
        const Mesh mesh = one_element(dim, 2);
        for (double s : {0.1, 0.2, 0.24, 0.2499, 0.249999}) {
            const Certificate c = certify(mesh, with_moved_midpoint(mesh, s));
            CHECK(c.valid);
            CHECK(c.min_certified_bound <= 1 - 4 * s + 1e-15);
            CHECK(c.min_certified_bound >= 0.99 * (1 - 4 * s) - 1e-11);
        }
        for (double s : {0.25, 0.2500001, 0.3}) {
            const Certificate c = certify(mesh, with_moved_midpoint(mesh, s));
            CHECK_FALSE(c.valid);
            CHECK(c.undecided == 0);
            CHECK(c.uncertified == std::vector<int>{0});
            CHECK(std::abs(c.min_certified_bound - (1 - 4 * s)) < 0.011);
        }
    }
}

TEST_CASE("a Jacobian negative between all nodes and quadrature points is found") {
    // P3 triangle, inner node moved: det J is negative in small parts of the element only.
    const Mesh mesh = one_element(2, 3);
    std::vector<double> x = mesh.x;
    const int inner = mesh.element(0)[9];
    double t = 0;  // largest displacement the coarse samples see as valid
    while (t < 1) {
        x = mesh.x;
        x[inner * 2] += t;
        if (sampled_minimum<2>(mesh, x, 0, 3) <= 0) break;
        t += 1e-3;
    }
    x[inner * 2] = mesh.x[inner * 2] + t - 1e-3;
    REQUIRE(sampled_minimum<2>(mesh, x, 0, 3) > 0);
    REQUIRE(sampled_minimum<2>(mesh, x, 0, 60) < 0);
    const Certificate c = certify(mesh, x);
    CHECK_FALSE(c.valid);
    CHECK(c.undecided == 0);
}

TEST_CASE("lower bounds agree with dense samples at every degree") {
    for (int dim = 2; dim <= 3; ++dim)
        for (int degree = 2; degree <= (dim == 2 ? 7 : 5); ++degree) {
            const Mesh mesh = with_degree(dim == 2 ? square_mesh(2) : cube_mesh(1), degree);
            const std::vector<double> x = wavy(mesh.x, dim, dim == 2 ? 0.05 : 0.006);
            const Certificate c = certify(mesh, x);
            CHECK(c.valid);
            for (int e = 0; e < mesh.element_count(); ++e) {
                const double sampled =
                    dim == 2 ? sampled_minimum<2>(mesh, x, e, 30) : sampled_minimum<3>(mesh, x, e, 16);
                CHECK(c.certified_bound[e] <= sampled);
                CHECK(c.certified_bound[e] >= 0.97 * sampled);
            }
        }
}

TEST_CASE("stretched boundary-layer elements keep the certificate of their affine image") {
    const double pi = std::acos(-1.0);
    for (int dim = 2; dim <= 3; ++dim) {
        const Mesh mesh = with_degree(dim == 2 ? square_mesh(3) : cube_mesh(1), 4);
        const std::vector<double> curved = wavy(mesh.x, dim, dim == 2 ? 0.05 : 0.006);
        const Certificate unit = certify(mesh, curved);
        // Thickness 1e-5 and length 0.5, turned by an odd angle and moved to 20 units from the origin.
        std::vector<double> thin = curved;
        for (int i = 0; i < mesh.nodes(); ++i) {
            double* const p = &thin[static_cast<std::size_t>(i) * dim];
            const double a = 0.5 * p[0], b = 1e-5 * p[1], c = std::cos(pi / 7), s = std::sin(pi / 7);
            p[0] = 20 + c * a - s * b;
            p[1] = -3 + s * a + c * b;
        }
        const Certificate layer = certify(mesh, thin);
        CHECK(layer.valid);
        for (int e = 0; e < mesh.element_count(); ++e)
            CHECK(layer.certified_bound[e] == doctest::Approx(unit.certified_bound[e]).epsilon(1e-4));
    }
}

TEST_CASE("inverted, flat and infinite elements are invalid") {
    const Mesh linear = one_element(2, 1), curved = one_element(2, 3);
    CHECK(certify(linear, {0, 0, 0, 1, 1, 0}).min_certified_bound == -1);
    CHECK(certify(linear, {0, 0, 1, 1, 2, 2}).min_certified_bound == 0);
    CHECK(certify(linear, {0, 0, 0.1, 0.1, 0.3, 0.3}).uncertified == std::vector<int>{0});
    CHECK(certify(linear, {0, 0, 0, 0, 0, 0}).uncertified == std::vector<int>{0});
    for (const double height : {1e-14, 1e-16, 1e-18})  // below a few units in the last place nothing tells it from zero
        CHECK(certify(linear, {0, 0, 1, 0, 0.5, height}).valid == (height > 1e-15));
    std::vector<double> mirrored = mapped(curved, [](double* p) { p[0] = -p[0]; });
    const Certificate c = certify(curved, mirrored);
    CHECK_FALSE(c.valid);
    CHECK(c.min_certified_bound == doctest::Approx(-1).epsilon(1e-9));
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        for (int node : {0, 9}) {
            std::vector<double> x = curved.x;
            x[node * 2] = bad;
            CHECK(certify(curved, x).uncertified == std::vector<int>{0});
            CHECK(certify(curved, x).min_certified_bound == 0);
        }
}

TEST_CASE("an element out of bisections is undecided, and uncertified ones are listed worst first") {
    const Mesh mesh = one_element(2, 4);
    const auto bent = [&](double amplitude) {
        return mapped(mesh, [&](double* p) { p[1] *= 1 + amplitude * std::cos(5 * p[0]); });
    };
    CertificateParams hasty;
    hasty.max_bisections = 0;
    double amplitude = 0.5;  // grows until the plain coefficients no longer show that the element is valid
    while (amplitude < 2 && certify(mesh, bent(amplitude), hasty).valid) amplitude *= 1.01;
    CHECK(certify(mesh, bent(amplitude)).valid);
    const Certificate c = certify(mesh, bent(amplitude), hasty);
    CHECK(c.certified_bound[0] <= 0);
    CHECK(c.undecided == 1);
    CHECK_FALSE(c.valid);

    const Mesh square = square_mesh(4);
    std::vector<double> folded = square.x;
    folded[2 * 12] += 0.6;  // the centre node leaves its patch
    const Certificate order = certify(square, folded);
    REQUIRE(order.uncertified.size() >= 2);
    CHECK(std::is_sorted(order.uncertified.begin(), order.uncertified.end(),
                         [&](int a, int b) { return order.certified_bound[a] < order.certified_bound[b]; }));
}

TEST_CASE("bounds have the same bits for any number of threads") {
    const Mesh mesh = with_degree(cube_mesh(3), 3);
    const std::vector<double> x = wavy(mesh.x, 3, 0.05);
    const int before = max_threads();
    set_threads(1);
    const std::vector<double> serial = certify(mesh, x).certified_bound;
    for (int threads : {2, 3, 5}) {
        set_threads(threads);
        CHECK(certify(mesh, x).certified_bound == serial);
    }
    set_threads(before);
}

// All eight corners have det J > 4.5; on the edge from vertex 0 to 1 it falls to -5 between them.
TEST_CASE("a hexahedron that is folded along an edge between positive corners is invalid") {
    Mesh mesh;
    mesh.dim = 3;
    mesh.x = {1.2, 0.6, 1.3, 1.9, -1.0, -1.0, 2.0, 2.0, -0.9, -0.8, -0.9, -1.0,
              -1.0, 1.0, 0.7, 1.6, -1.0, 2.0, 2.0, -0.1, 1.7, 0.7, 2.0, 2.0};
    for (int i = 0; i < 8; ++i) mesh.elements.push_back(i);
    mesh.groups = groups_of({&hexahedron()}, 1);
    const LagrangeBasis basis(hexahedron(), 1);
    for (int i = 0; i < 8; ++i) CHECK(determinant_at<3>(basis, mesh.element(0), mesh.x, basis.point(i).data()) > 4.5);
    const double middle[3] = {0.5, 0, 0};
    CHECK(determinant_at<3>(basis, mesh.element(0), mesh.x, middle) < -4);
    for (const int degree : {1, 2, 3}) {
        std::vector<double> x;  // the same element
        const LagrangeBasis higher(hexahedron(), degree);
        mesh.degree = degree;
        mesh.elements.clear();
        for (int i = 0; i < higher.count; ++i) {
            double N[8];
            basis.values(higher.point(i).data(), N);
            for (int a = 0; a < 3; ++a) {
                x.push_back(0);
                for (int v = 0; v < 8; ++v) x.back() += N[v] * mesh.x[3 * v + a];
            }
            mesh.elements.push_back(i);
        }
        mesh.groups = groups_of({&hexahedron()}, degree);
        const Certificate c = certify(mesh, x);
        CHECK(!c.valid);
        CHECK(c.undecided == 0);
    }
}
