#include "check/boundary_distance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "mesh/lagrange.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<int> nodes_off_wall(const Mesh& mesh, const std::vector<char>& wall) {
    std::vector<char> on(mesh.nodes(), 0);
    for (int f = 0; f < mesh.face_count(); ++f)
        if (wall[mesh.face_boundary[f]])
            for (int i = 0; i < mesh.face_nodes(0); ++i) on[mesh.face(f)[i]] = 1;
    std::vector<int> off;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (!on[i]) off.push_back(i);
    return off;
}

std::array<double, 3> face_point(const Mesh& mesh, const std::vector<double>& x, int face, const double* xi,
                                 std::array<double, 3>* normal = nullptr) {
    const int m = mesh.dim - 1;
    const LagrangeBasis basis(m, mesh.degree);
    std::vector<double> N(basis.count), dN(static_cast<std::size_t>(basis.count) * m);
    basis.values(xi, N.data());
    basis.gradients(xi, dN.data());
    std::array<double, 3> point{}, t[2] = {};
    for (int i = 0; i < basis.count; ++i)
        for (int a = 0; a < mesh.dim; ++a) {
            const double position = x[static_cast<std::size_t>(mesh.face(face)[i]) * mesh.dim + a];
            point[a] += N[i] * position;
            for (int k = 0; k < m; ++k) t[k][a] += dN[i * m + k] * position;
        }
    if (normal && m == 1) *normal = {-t[0][1], t[0][0], 0};
    if (normal && m == 2)
        for (int a = 0; a < 3; ++a)
            (*normal)[a] = -(t[0][(a + 1) % 3] * t[1][(a + 2) % 3] - t[0][(a + 2) % 3] * t[1][(a + 1) % 3]);
    if (normal) {
        const double size = std::hypot((*normal)[0], (*normal)[1], (*normal)[2]);
        for (double& v : *normal) v /= size;
    }
    return point;
}

double fraction(double seed) { return seed * 0.6180339887498949 - std::floor(seed * 0.6180339887498949); }

}  // namespace

TEST_CASE("points at a known offset from curved edges: layers of 1e-9 to 1e-1 on faces of size 0.5") {
    for (int degree : {1, 2, 3, 4, 7}) {
        const Mesh mesh = with_degree(ring_mesh(12, 4, 21), degree);
        std::vector<double> x = mapped(mesh, [](double* p) {
            const double r = std::hypot(p[0], p[1]);
            if (r > 1.01) return;
            p[0] /= r;
            p[1] /= r;
        });
        const std::vector<char> wall = mesh.boundaries_in("inner");
        std::vector<double> expected(mesh.nodes(), 0.0);
        int k = 0;
        for (int i : nodes_off_wall(mesh, wall)) {
            int face = ++k % mesh.face_count();
            while (!wall[mesh.face_boundary[face]]) face = (face + 1) % mesh.face_count();
            const double xi = 0.05 + 0.9 * fraction(k), d = std::pow(10.0, -1 - k % 9);
            std::array<double, 3> normal, p = face_point(mesh, x, face, &xi, &normal);
            for (int a = 0; a < 2; ++a) x[i * 2 + a] = p[a] + d * normal[a];
            expected[i] = d;
        }
        const std::vector<double> distance = wall_distance(mesh, x, wall);
        double error = 0;
        for (int i = 0; i < mesh.nodes(); ++i) error = std::max(error, std::abs(distance[i] - expected[i]));
        CHECK(error < 1e-14);
    }
}

TEST_CASE("points at a known offset from curved triangles") {
    for (int degree : {1, 2, 4}) {
        const Mesh mesh = with_degree(cube_mesh(2), degree);
        std::vector<double> x = mapped(mesh, [](double* p) { p[2] += 0.1 * std::sin(3 * p[0]) * std::cos(2 * p[1]); });
        const std::vector<char> wall = mesh.boundaries_in("bottom");
        std::vector<double> expected(mesh.nodes(), 0.0);
        int k = 0;
        for (int i : nodes_off_wall(mesh, wall)) {
            int face = ++k % mesh.face_count();
            while (!wall[mesh.face_boundary[face]]) face = (face + 1) % mesh.face_count();
            double xi[2] = {0.05 + 0.4 * fraction(k), 0.05 + 0.4 * fraction(k + 0.5)};
            const double d = std::pow(10.0, -2 - k % 8);
            std::array<double, 3> normal, p = face_point(mesh, x, face, xi, &normal);
            for (int a = 0; a < 3; ++a) x[i * 3 + a] = p[a] + d * normal[a];
            expected[i] = d;
        }
        const std::vector<double> distance = wall_distance(mesh, x, wall);
        double error = 0;
        for (int i = 0; i < mesh.nodes(); ++i) error = std::max(error, std::abs(distance[i] - expected[i]));
        CHECK(error < 1e-14);
    }
}

TEST_CASE("points beyond the rim of a flat wall are measured to its edges and corners") {
    for (int dim = 2; dim <= 3; ++dim)
        for (int degree : {1, 3}) {
            const Mesh mesh = with_degree(dim == 2 ? square_mesh(3) : cube_mesh(2), degree);
            std::vector<double> x = mesh.x;
            const std::vector<char> wall = mesh.boundaries_in("bottom");
            for (int i : nodes_off_wall(mesh, wall))
                for (int a = 0; a < dim; ++a) x[i * dim + a] = 4 * fraction(7.0 * i + 3.3 * a) - 1.5;
            const std::vector<double> distance = wall_distance(mesh, x, wall);
            double error = 0;
            for (int i = 0; i < mesh.nodes(); ++i) {
                double squared = x[i * dim + dim - 1] * x[i * dim + dim - 1];
                for (int a = 0; a < dim - 1; ++a) {
                    const double out = std::max({-x[i * dim + a], x[i * dim + a] - 1, 0.0});
                    squared += out * out;
                }
                error = std::max(error, std::abs(distance[i] - std::sqrt(squared)));
            }
            CHECK(error < 1e-14);
        }
}

TEST_CASE("on one triangle the closest point is inside, on a side or at a corner") {
    const auto lowest = [](const double* p) { return p[2] < 0.1 ? "wall" : "rest"; };
    const Mesh mesh = with_degree(linear_mesh(3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 1, 2, 3}, lowest), 3);
    const std::vector<char> wall = mesh.boundaries_in("wall");
    const struct {
        std::array<double, 3> x;
        double distance;
    } cases[] = {{{0.2, 0.3, -0.5}, 0.5},
                 {{0.4, -0.3, 0.4}, 0.5},
                 {{1, 1, 0}, std::sqrt(0.5)},
                 {{-3, -4, 0}, 5},
                 {{2, -0.5, 0}, std::hypot(1, 0.5)},
                 {{0.25, 0.25, 0}, 0}};
    const std::vector<int> off = nodes_off_wall(mesh, wall);
    REQUIRE(off.size() >= std::size(cases));
    std::vector<double> x = mesh.x;
    for (std::size_t k = 0; k < std::size(cases); ++k)
        std::copy(cases[k].x.begin(), cases[k].x.end(), &x[static_cast<std::size_t>(off[k]) * 3]);
    const std::vector<double> distance = wall_distance(mesh, x, wall);
    for (std::size_t k = 0; k < std::size(cases); ++k) CHECK(std::abs(distance[off[k]] - cases[k].distance) < 1e-14);
}

TEST_CASE("degenerate faces are measured as far as they go") {
    const auto lowest = [](const double* p) { return p[2] < 0.1 ? "wall" : "rest"; };
    const Mesh mesh = linear_mesh(3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 1, 2, 3}, lowest);
    const auto distance_to = [&](const std::vector<double>& x) {
        return wall_distance(mesh, x, mesh.boundaries_in("wall"))[3];
    };
    CHECK(distance_to({0, 0, 0, 1, 0, 0, 2, 0, 0, 1.5, 3, 0}) == doctest::Approx(3));  // a segment
    CHECK(distance_to({1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 4, 5}) == doctest::Approx(5));    // a point
}

TEST_CASE("no point of a strongly curved wall is nearer than the distance found") {
    for (int dim = 2; dim <= 3; ++dim) {
        const Mesh mesh = with_degree(dim == 2 ? square_mesh(2) : cube_mesh(1), 5);
        std::vector<double> x = mapped(mesh, [dim](double* p) { p[dim - 1] += 0.15 * std::sin(6 * p[0] + p[1]); });
        const std::vector<char> wall = mesh.boundaries_in("bottom");
        const int steps = dim == 2 ? 2000 : 100;
        for (int i : nodes_off_wall(mesh, wall))
            for (int a = 0; a < dim; ++a) x[i * dim + a] = 3 * fraction(5.0 * i + 1.7 * a) - 1;
        std::vector<std::array<double, 3>> samples;
        for (int f = 0; f < mesh.face_count(); ++f)
            for (const MultiIndex& a : gmsh_node_order(dim - 1, wall[mesh.face_boundary[f]] ? steps : 0)) {
                const double xi[2] = {1.0 * a[1] / steps, 1.0 * a[2] / steps};
                if (wall[mesh.face_boundary[f]]) samples.push_back(face_point(mesh, x, f, xi));
            }
        const std::vector<double> distance = wall_distance(mesh, x, wall);
        for (int i : nodes_off_wall(mesh, wall)) {
            double nearest = std::numeric_limits<double>::max();
            for (const auto& s : samples)
                nearest = std::min(nearest, std::hypot(s[0] - x[i * dim], s[1] - x[i * dim + 1],
                                                       dim == 3 ? s[2] - x[i * dim + 2] : 0.0));
            CHECK(distance[i] <= nearest + 1e-14);
            CHECK(distance[i] >= nearest - 0.02);
        }
    }
}

TEST_CASE("nodes of the wall are at distance zero, a wall without faces is an error, threads do not matter") {
    Mesh mesh = with_degree(cube_mesh(3), 2);
    const std::vector<double> x = wavy(mesh.x, 3, 0.03);
    const std::vector<char> wall = mesh.boundaries_in("sides");
    const int before = max_threads();
    set_threads(1);
    const std::vector<double> serial = wall_distance(mesh, x, wall);
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int i = 0; i < mesh.face_nodes(0); ++i)
            if (wall[mesh.face_boundary[f]]) CHECK(serial[mesh.face(f)[i]] == 0);
    for (int threads : {2, 3, 5}) {
        set_threads(threads);
        CHECK(wall_distance(mesh, x, wall) == serial);
    }
    set_threads(before);
    add_boundary(mesh, {"nowhere"});
    CHECK_THROWS_AS(wall_distance(mesh, x, mesh.boundaries_in("nowhere")), InputError);
}
