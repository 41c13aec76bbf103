#include "examples/linear_extension.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "energy/distortion_energy.hpp"
#include "support/boundary.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

using Field = std::function<void(const double* x, double* u)>;

std::vector<double> values(const Mesh& mesh, const std::vector<double>& x, const Field& field) {
    std::vector<double> u(x.size());
    for (int i = 0; i < mesh.nodes(); ++i) field(point(x, i, mesh.dim), point(u, i, mesh.dim));
    return u;
}

// The field's values on the boundary, extended inside.
std::vector<double> extension(StiffnessAt stiffness, const Mesh& mesh, const std::vector<double>& x,
                              const Field& field) {
    const BlockCsr pattern = make_energy(mesh, straight_sided(mesh), {})->hessian_pattern();
    std::vector<double> u = values(mesh, x, field);
    const std::vector<char> fixed = on_boundary(mesh);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (!fixed[i]) std::fill_n(point(u, i, mesh.dim), mesh.dim, 0.0);
    const SolveResult solved = extend_displacement(mesh, pattern, stiffness, {}, x, fixed, u);
    CHECK(solved.status == SolveStatus::success);
    return u;
}

double error(StiffnessAt stiffness, const Mesh& mesh, const std::vector<double>& x, const Field& field) {
    const std::vector<double> u = extension(stiffness, mesh, x, field), exact = values(mesh, x, field);
    double largest = 0;
    for (std::size_t i = 0; i < u.size(); ++i) largest = std::max(largest, std::abs(u[i] - exact[i]));
    return largest;
}

std::vector<Mesh> meshes(int degree) {
    std::vector<Mesh> all;
    for (const Mesh& linear : {square_mesh(4), ring_mesh(10, 4, 5), cube_mesh(2)})
        all.push_back(with_degree(linear, degree));
    for (const Mesh& linear : {quad_mesh(4, 0.2), mixed_mesh(4, 0.2)}) all.push_back(raise_degree(linear, degree));
    return all;
}

constexpr double rounding = 1e-12;

}  // namespace

TEST_CASE("harmonic: a linear displacement is extended exactly, on curved and wavy meshes of any degree") {
    for (int degree : {1, 2, 3})
        for (const Mesh& mesh : meshes(degree)) {
            const Field linear = [&](const double* x, double* u) {
                for (int a = 0; a < mesh.dim; ++a) u[a] = 1 - 2 * a + (a + 1) * x[0] - 3 * x[1] + a * x[mesh.dim - 1];
            };
            CHECK(error(harmonic_stiffness, mesh, wavy(mesh.x, mesh.dim, 0.01), linear) < 100 * rounding);
        }
}

TEST_CASE("harmonic: a harmonic polynomial of the elements' degree is extended exactly, another is not") {
    const Mesh square = with_degree(square_mesh(3), 2);
    const Field saddle = [](const double* x, double* u) { u[0] = x[0] * x[0] - x[1] * x[1], u[1] = x[0] * x[1]; };
    const Field bowl = [](const double* x, double* u) { u[0] = x[0] * x[0] + x[1] * x[1], u[1] = 0; };
    CHECK(error(harmonic_stiffness, square, square.x, saddle) < rounding);
    CHECK(error(harmonic_stiffness, square, square.x, bowl) > 0.1);
}

TEST_CASE("harmonic: the displacement of linear elements without obtuse angles is within that of the boundary") {
    const Mesh square = square_mesh(8);
    const Field step = [](const double* x, double* u) { u[0] = x[0] > 0.5, u[1] = -u[0]; };
    const std::vector<double> u = extension(harmonic_stiffness, square, square.x, step);
    CHECK(*std::max_element(u.begin(), u.end()) == 1);
    CHECK(*std::min_element(u.begin(), u.end()) == -1);
}

TEST_CASE("elasticity: rigid motions are extended exactly, whatever the sizes of elements") {
    for (int degree : {1, 2, 3})
        for (const Mesh& mesh : meshes(degree)) {
            const Field rigid = [&](const double* x, double* u) {  // small turns are linear
                const double w[] = {0.4, -0.3, 0.7};
                u[0] = 1 - w[2] * x[1];
                u[1] = 2 + w[2] * x[0];
                if (mesh.dim == 2) return;
                u[0] += w[1] * x[2];
                u[1] -= w[0] * x[2];
                u[2] = w[0] * x[1] - w[1] * x[0];
            };
            CHECK(error(elastic_stiffness, mesh, wavy(mesh.x, mesh.dim, 0.01), rigid) < 100 * rounding);
        }
}

TEST_CASE("elasticity: quadratic solution of the equations of a solid with the ratio 0.3 on a uniform mesh") {
    // u = (x^2 - (l + 2 m) / m y^2, 0) has m lap u + (l + m) grad div u = 0; l / m = 2 v / (1 - 2 v) = 3/2.
    const Mesh square = with_degree(square_mesh(3), 2);
    const auto bent = [](double ratio) {
        return [ratio](const double* x, double* u) { u[0] = x[0] * x[0] - ratio * x[1] * x[1], u[1] = 0; };
    };
    CHECK(error(elastic_stiffness, square, square.x, bent(3.5)) < 10 * rounding);
    CHECK(error(elastic_stiffness, square, square.x, bent(3)) > 0.01);
}

TEST_CASE("elasticity: small elements keep their shape, large ones take the deformation") {
    const Mesh ring = ring_mesh(16, 6, 20);
    const Field moved = [](const double* x, double* u) { u[0] = std::hypot(x[0], x[1]) < 1.5, u[1] = 0; };
    const std::vector<double> stiff = extension(elastic_stiffness, ring, ring.x, moved),
                              plain = extension(harmonic_stiffness, ring, ring.x, moved);
    for (int i = 16; i < 32; ++i) {  // the nodes next to the inner circle
        CHECK(stiff[2 * i] > 0.9);
        CHECK(plain[2 * i] < 0.9);
    }
}

TEST_CASE("the same bits of an extension for any number of threads") {
    const Mesh mesh = with_degree(ring_mesh(24, 12, 9), 3);
    const Field field = [](const double* x, double* u) { u[0] = std::sin(x[1]), u[1] = std::cos(3 * x[0]); };
    for (const StiffnessAt stiffness : {harmonic_stiffness, elastic_stiffness}) {
        const auto results = for_threads([&] { return extension(stiffness, mesh, mesh.x, field); });
        CHECK(results[1] == results[0]);
        CHECK(results[2] == results[0]);
    }
}
