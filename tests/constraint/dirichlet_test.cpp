#include "constraint/dirichlet.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.hpp"
#include "mesh/lagrange.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Keeps the mesh that the constraint refers to.
struct Case {
    Mesh mesh;
    std::vector<double> ideal;
    BoundaryTarget target;
    Dirichlet constraint;

    Case(const Mesh& any, const std::map<std::string, std::string>& motions, TargetKind kind)
        : mesh(any),
          ideal(straight_sided(mesh)),
          target(target_of(mesh, motions)),
          constraint(mesh, ideal, target, kind) {}
};

std::vector<double> random_numbers(std::size_t count, int seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<double> values(count);
    for (double& v : values) v = number(random);
    return values;
}

std::vector<double> sum(std::vector<double> x, double t, const std::vector<double>& d) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += t * d[i];
    return x;
}

double inner(const std::vector<double>& a, const std::vector<double>& b) {
    double s = 0;
    for (std::size_t i = 0; i < a.size(); ++i) s += a[i] * b[i];
    return s;
}

// x with the boundary nodes at the projected target g_h.
std::vector<double> at_projection(const Case& c, std::vector<double> x) {
    const std::vector<double> constraint = c.constraint.constraint_field(x);
    for (std::size_t k = 0; k < constraint.size(); ++k) {
        const int dim = c.mesh.dim;
        x[c.constraint.nodes()[k / dim] * dim + k % dim] -= constraint[k] * c.constraint.norm_of_one();
    }
    return x;
}

const std::map<std::string, std::string> onto_circles = {{"inner", "circle 0 0 1"}, {"outer", "circle 0 0 5"}};

Case circle_case(int edges, int degree, TargetKind kind) {
    return {raise_degree(ring_mesh(edges, 1, 5), degree), onto_circles, kind};
}

}  // namespace

TEST_CASE("the constraint norm of a translation is its length, and nothing but it") {
    for (TargetKind kind : {TargetKind::least_squares, TargetKind::nodal})
        for (int degree : {1, 2, 3}) {
            const std::map<std::string, std::string> shift = {{"inner", "translate 3 -4"}, {"outer", "translate 3 -4"}};
            Case ring(raise_degree(ring_mesh(12, 3, 21), degree), shift, kind);
            const std::string d = "translate 2 -3 6";
            Case cube(raise_degree(cube_mesh(2), degree), {{"bottom", d}, {"top", d}, {"sides", d}}, kind);
            for (const auto& [c, length] : {std::pair(&ring, 5.0), std::pair(&cube, 7.0)}) {
                CHECK(c->constraint.norm(c->ideal) == doctest::Approx(length).epsilon(1e-13));
                CHECK(c->constraint.projected_norm(c->ideal) == doctest::Approx(length).epsilon(1e-13));
                CHECK(c->constraint.max_error(c->ideal) == doctest::Approx(length).epsilon(1e-13));
                CHECK(c->constraint.best_approximation_error() < 1e-13);
            }
        }
}

TEST_CASE("the relative error is a node's distance from its place over the height of the flattest cell at it") {
    for (int degree : {1, 2}) {
        const std::string d = "translate 2 -3 6";
        Case cube(raise_degree(cube_mesh(2), degree), {{"bottom", d}, {"top", d}, {"sides", d}}, TargetKind::least_squares);
        CHECK(cube.constraint.relative_error(cube.ideal) == doctest::Approx(7 / 0.5).epsilon(1e-12));
        // Only the inner circle moves: its cells are lower than those of the outer one.
        Case ring(raise_degree(ring_mesh(12, 3, 21), degree), {{"inner", "translate 0.03 0.04"}}, TargetKind::least_squares);
        const double height = (std::cbrt(21.0) - 1) * std::cos(std::numbers::pi / 12);
        CHECK(ring.constraint.relative_error(ring.ideal) == doctest::Approx(0.05 / height).epsilon(1e-12));
        CHECK(ring.constraint.relative_error(at_projection(ring, ring.ideal)) < 1e-12);
        const std::vector<double> errors = ring.constraint.relative_errors(ring.ideal);
        REQUIRE(errors.size() == ring.constraint.nodes().size());
        for (std::size_t t = 0; t < errors.size(); ++t) {
            const double* const at = point(ring.ideal, ring.constraint.nodes()[t], 2);
            const bool inner = std::hypot(at[0], at[1]) < 2;
            CHECK(errors[t] == doctest::Approx(inner ? 0.05 / height : 0).epsilon(1e-12));
        }
    }
}

TEST_CASE("a boundary that moves alone counts by its share of |1|^2") {
    for (int degree : {1, 3}) {
        Case ring(raise_degree(ring_mesh(12, 3, 21), degree), {{"inner", "translate 8 0"}}, TargetKind::least_squares);
        CHECK(ring.constraint.norm(ring.ideal) == doctest::Approx(8 * std::sqrt(0.5)).epsilon(1e-13));
    }
}

TEST_CASE("|1|^2 is the number of edges in 2D, the sum of the faces' sizes in 3D") {
    for (int degree : {1, 2, 4}) {
        Case ring(raise_degree(ring_mesh(10, 2, 3), degree), {}, TargetKind::least_squares);
        CHECK(std::pow(ring.constraint.norm_of_one(), 2) == doctest::Approx(20).epsilon(1e-14));
        CHECK(ring.constraint.nodes().size() == 20u * degree);
        CHECK(ring.constraint.multipliers() == 40 * degree);
    }
    Case cube(cube_mesh(3), {}, TargetKind::least_squares);  // 108 triangles of area 1/18
    CHECK(std::pow(cube.constraint.norm_of_one(), 2) == doctest::Approx(108 / std::sqrt(18)).epsilon(1e-13));
}

TEST_CASE("a mesh whose boundary stays has no constraint at all") {
    Case c(raise_degree(cube_mesh(2), 2), {}, TargetKind::least_squares);
    CHECK(c.constraint.projected_norm(c.ideal) < 1e-15);
    CHECK(c.constraint.max_error(c.ideal) < 1e-15);
}

TEST_CASE("the exact norm is the integral of |phi - g_D|^2, by Pythagoras from projection and best approximation") {
    for (int degree : {1, 2, 4}) {
        Case c = circle_case(9, degree, TargetKind::least_squares);
        const std::vector<double> x = wavy(c.ideal, 2, 0.05);
        const LagrangeBasis basis(1, degree);
        std::vector<double> N(basis.count);
        double squared = 0;  // |f| / h = 1 in 2D
        for (int f = 0; f < c.mesh.face_count(); ++f)
            for (int q = 0; q < c.target.rules[0].quadrature.count; ++q) {
                basis.values(&c.target.rules[0].quadrature.xi[q], N.data());
                for (int a = 0; a < 2; ++a) {
                    double d = -c.target.sample[(f * c.target.rules[0].quadrature.count + q) * 2 + a];
                    for (int i = 0; i < basis.count; ++i) d += N[i] * x[c.mesh.face(f)[i] * 2 + a];
                    squared += c.target.rules[0].quadrature.weight[q] * d * d;
                }
            }
        CHECK(c.constraint.norm(x) == doctest::Approx(std::sqrt(squared) / c.constraint.norm_of_one()).epsilon(1e-12));
    }
}

TEST_CASE("no trace is nearer to the target than its projection") {
    Case c = circle_case(9, 2, TargetKind::least_squares);
    const std::vector<double> best = at_projection(c, c.ideal);
    CHECK(c.constraint.projected_norm(best) < 1e-14);
    CHECK(c.constraint.norm(best) == doctest::Approx(c.constraint.best_approximation_error()).epsilon(1e-12));
    for (int seed = 0; seed < 20; ++seed)
        CHECK(c.constraint.norm(sum(best, 1e-3, random_numbers(best.size(), seed))) >
              c.constraint.best_approximation_error());
}

TEST_CASE("the best approximation error of a circle falls with the order p + 1; a nodal target has none") {
    for (int degree : {1, 2, 3, 4}) {
        double before = 0;
        for (int edges : {12, 24, 48}) {
            const double error = circle_case(edges, degree, TargetKind::least_squares).constraint.best_approximation_error();
            CAPTURE(degree);
            CAPTURE(edges);
            CHECK(circle_case(edges, degree, TargetKind::nodal).constraint.best_approximation_error() == 0);
            if (before > 0) CHECK(std::log2(before / error) == doctest::Approx(degree + 1).epsilon(0.06));
            before = error;
        }
    }
}

TEST_CASE("a nodal target is reached at the nodes") {
    Case c = circle_case(10, 3, TargetKind::nodal);
    const std::vector<double> x = at_projection(c, c.ideal);
    for (int node : c.constraint.nodes()) {
        const double r = std::hypot(x[2 * node], x[2 * node + 1]);
        CHECK(std::min(std::abs(r - 1), std::abs(r - 5)) < 1e-14);
    }
    CHECK(c.constraint.max_error(x) < 1e-14);
}

TEST_CASE("an affine motion of a curved boundary is reached everywhere") {
    for (int degree : {2, 3, 4}) {
        Mesh mesh = raise_degree(ring_mesh(7, 2, 4), degree);
        mesh.x = wavy(mesh.x, 2, 0.05);
        Case c(mesh, {{"inner", "rotate 30; translate 3 1"}, {"outer", "scale 2"}}, TargetKind::least_squares);
        CHECK(c.constraint.best_approximation_error() < 1e-14);
        const std::vector<double> x = at_projection(c, c.ideal);
        CHECK(std::max(c.constraint.max_error(x), c.constraint.error_between_nodes(x)) < 2e-14);
    }
}

TEST_CASE("the largest error of a polygon is its sagitta, and at its nodes that of the worst one") {
    for (const TargetKind kind : {TargetKind::nodal, TargetKind::least_squares}) {
        Case polygon = circle_case(8, 1, kind);
        CHECK(polygon.constraint.max_error(polygon.ideal) < 1e-14);
        CHECK(polygon.constraint.error_between_nodes(polygon.ideal) ==
              doctest::Approx(5 * (1 - std::cos(std::numbers::pi / 8))).epsilon(1e-13));
        std::vector<double> x = polygon.ideal;
        x[0] += 0.3;
        x[1] += 0.4;
        CHECK(polygon.constraint.max_error(x) == doctest::Approx(0.5).epsilon(1e-13));
    }
}

TEST_CASE("value, gradient and Hessian belong together: the functional is exactly quadratic") {
    Case ring = circle_case(7, 3, TargetKind::least_squares);
    const std::string spin = "scale 1 1 1.5 about 0 0 1; rotate 20 axis 1 1 0";
    Case cube(raise_degree(cube_mesh(1), 2), {{"top", spin}, {"bottom", spin}, {"sides", spin}},
                    TargetKind::nodal);
    for (Case* c : {&ring, &cube}) {
        const std::vector<double> x = wavy(c->ideal, c->mesh.dim, 0.05), v = random_numbers(x.size(), 1),
                                  lambda = random_numbers(c->constraint.multipliers(), 2);
        const double mu = 37;
        std::vector<double> g(x.size(), 0.0), Hv(x.size());
        c->constraint.add_gradient(x, lambda, mu, g);
        BlockCsr H = matrix_of_cells(c->mesh.nodes(), c->mesh.dim, c->mesh.elements, c->mesh.element_nodes());
        c->constraint.add_hessian(x, lambda, mu, false, H);
        multiply(H, v.data(), Hv.data());
        const double at_x = c->constraint.value(x, lambda, mu), slope = inner(g, v), curvature = inner(v, Hv);
        CHECK(curvature > 0);
        BlockCsr projected = matrix_of_cells(c->mesh.nodes(), c->mesh.dim, c->mesh.elements, c->mesh.element_nodes());
        c->constraint.add_hessian(x, lambda, mu, true, projected);
        CHECK(projected.value == H.value);
        for (double t : {-1.0, 0.25, 2.0}) {
            const double expected = at_x + t * slope + 0.5 * t * t * curvature;
            CHECK(c->constraint.value(sum(x, t, v), lambda, mu) == doctest::Approx(expected).epsilon(1e-12));
        }
    }
}

TEST_CASE("value, gradient and Hessian are added to what is there") {
    Case c = circle_case(5, 1, TargetKind::least_squares);
    const std::vector<double> lambda(c.constraint.multipliers(), 0.5);
    std::vector<double> once(c.ideal.size(), 0.0), twice;
    c.constraint.add_gradient(c.ideal, lambda, 3, once);
    twice = once;
    c.constraint.add_gradient(c.ideal, lambda, 3, twice);
    for (std::size_t i = 0; i < once.size(); ++i) CHECK(twice[i] == 2 * once[i]);
}

TEST_CASE("the multiplier update is lambda - mu c_D at every node, and makes the gradient that of the penalty") {
    Case c = circle_case(6, 2, TargetKind::least_squares);
    const std::vector<double> x = wavy(c.ideal, 2, 0.1), before = random_numbers(c.constraint.multipliers(), 4);
    std::vector<double> lambda = before;
    const double mu = 12.5;
    c.constraint.update_multipliers(x, mu, lambda);
    const std::vector<double> constraint = c.constraint.constraint_field(x);
    for (std::size_t k = 0; k < lambda.size(); ++k)
        CHECK(lambda[k] == doctest::Approx(before[k] - mu * constraint[k]).epsilon(1e-13));

    std::vector<double> with_penalty(x.size(), 0.0), with_multipliers(x.size(), 0.0);
    c.constraint.add_gradient(x, before, mu, with_penalty);
    c.constraint.add_gradient(x, lambda, 0, with_multipliers);
    for (std::size_t i = 0; i < x.size(); ++i)
        CHECK(with_penalty[i] == doctest::Approx(with_multipliers[i]).epsilon(1e-12));
}

TEST_CASE("the same bits for any number of threads") {
    const auto run = [] {
        Case c(raise_degree(ring_mesh(400, 1, 2), 3), onto_circles, TargetKind::least_squares);  // 2400 trace nodes
        const std::vector<double> x = wavy(c.ideal, 2, 1e-3), lambda = random_numbers(c.constraint.multipliers(), 6);
        std::vector<double> result(x.size(), 0.0);
        c.constraint.add_gradient(x, lambda, 7, result);
        result.insert(result.end(),
                      {c.constraint.best_approximation_error(), c.constraint.norm(x), c.constraint.max_error(x)});
        result.push_back(c.constraint.value(x, lambda, 7));
        return result;
    };
    const auto results = for_threads(run);
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}

TEST_CASE("the target has to prescribe all positions") {
    const Mesh ring = ring_mesh(12, 1, 5);
    for (const char* motion : {"free", "slide"}) {
        const BoundaryTarget target = target_of(ring, {{"outer", motion}});
        CHECK_THROWS_AS(Dirichlet(ring, ring.x, target, TargetKind::nodal), InputError);
    }
    CHECK_NOTHROW(Dirichlet(ring, ring.x, target_of(ring, {}), TargetKind::nodal));
}
