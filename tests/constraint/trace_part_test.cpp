#include "constraint/sliding.hpp"
#include "constraint/trace_space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "constraint/sliding_boundary.hpp"
#include "linalg/vector_ops.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A ring or cube of which boundaries slide, a part of whose nodes moves: near one another, in one, two or no surfaces.
struct Part {
    Mesh mesh;
    std::vector<double> x, lambda;
    std::vector<double> of_part;  // lambda
    Restriction around;
    std::unique_ptr<Constraint> constraint, part;
    static constexpr double mu = 30;

    Part(const Mesh& any, const std::map<std::string, std::string>& motions, double off) : mesh(any) {
        const BoundaryTarget target = target_of(mesh, motions);
        const std::vector<char> sliding_ones = slides(mesh, target);
        const bool some = std::count(sliding_ones.begin(), sliding_ones.end(), 1) > 0;
        const auto sliding =
            some ? std::make_shared<SlidingSurfaces>(mesh, target.node, sliding_ones, 30, Frame()) : nullptr;
        constraint = make_constraint(mesh, straight_sided(mesh), target, TargetKind::nodal, sliding);
        x = wavy(mesh.x, mesh.dim, off);
        lambda.resize(constraint->multipliers());
        for (std::size_t k = 0; k < lambda.size(); ++k) lambda[k] = std::cos(1.7 * static_cast<double>(k));
        std::vector<char> moves(mesh.nodes(), 0);
        const int* const first = mesh.element(0);
        for (int i = 0; i < mesh.nodes(); ++i)
            moves[i] = i % 3 == 0 || std::count(first, first + mesh.element_nodes(), i);
        around = restriction_to(moves, mesh);
        of_part = lambda;
        part = constraint->part(around, of_part);
    }

    std::vector<double> start() const {
        std::vector<double> y;
        for (const int i : around.node) y.insert(y.end(), point(x, i, mesh.dim), point(x, i, mesh.dim) + mesh.dim);
        return y;
    }
    std::vector<double> with(const std::vector<double>& y) const {
        std::vector<double> all = x;
        for (std::size_t k = 0; k < around.node.size(); ++k)
            std::copy_n(&y[k * mesh.dim], mesh.dim, point(all, around.node[k], mesh.dim));
        return all;
    }
    double value(const std::vector<double>& y) const { return part->value(y, of_part, mu); }
    // Derivatives with respect to the nodes that move.
    std::vector<double> gradient(const std::vector<double>& y) const {
        std::vector<double> g(y.size(), 0.0);
        part->add_gradient(y, of_part, mu, g);
        std::fill(g.begin() + coordinates(), g.end(), 0.0);
        return g;
    }
    std::vector<double> hessian_times(const std::vector<double>& y, bool projected,
                                      const std::vector<double>& d) const {
        BlockCsr H = matrix_of_cells(static_cast<int>(around.node.size()), mesh.dim, around.elements,
                                     mesh.element_nodes());
        part->add_hessian(y, of_part, mu, projected, H);
        std::vector<double> Hd(y.size());
        multiply(H, d.data(), Hd.data());
        std::fill(Hd.begin() + coordinates(), Hd.end(), 0.0);
        return Hd;
    }
    std::ptrdiff_t coordinates() const { return static_cast<std::ptrdiff_t>(around.moving) * mesh.dim; }
    std::vector<double> moved(std::vector<double> y, double t) const {
        for (std::ptrdiff_t i = 0; i < coordinates(); ++i) y[i] += t * std::sin(7.0 * static_cast<double>(i));
        return y;
    }
};

template <class Body>
void for_parts(double off, const Body& body) {
    body(Part(ring_mesh(12, 2, 3), {{"outer", "slide"}, {"inner", "translate 0.2 0.1"}}, off));
    body(Part(ring_mesh(12, 2, 3), {{"outer", "free"}, {"inner", "slide"}}, off));
    body(Part(cube_mesh(2), {{"sides", "slide"}, {"bottom", "slide"}, {"top", "slide"}}, off));
    body(Part(ring_mesh(12, 2, 3), {{"inner", "translate 0.2 0.1"}}, off));  // all is prescribed
}

}  // namespace

TEST_CASE("a part of the constraint changes as the whole does with its nodes") {
    for_parts(0.05, [](const Part& of) {
        const std::vector<double> y = of.moved(of.start(), 0.05);
        const double change = of.value(y) - of.value(of.start());
        CHECK(std::abs(change) > 1e-4);
        CHECK(change == doctest::Approx(of.constraint->value(of.with(y), of.lambda, of.mu) -
                                        of.constraint->value(of.x, of.lambda, of.mu)).epsilon(1e-10));
        const std::vector<double> g = of.gradient(y);
        std::vector<double> whole(of.x.size(), 0.0);
        of.constraint->add_gradient(of.with(y), of.lambda, of.mu, whole);
        for (int k = 0; k < of.around.moving; ++k)
            for (int a = 0; a < of.mesh.dim; ++a)
                CHECK(g[k * of.mesh.dim + a] ==
                      doctest::Approx(point(whole, of.around.node[k], of.mesh.dim)[a]).epsilon(1e-10).scale(1));
    });
}

TEST_CASE("its gradient is the derivative of its value everywhere, its Hessian that of the gradient on the surfaces") {
    const double h = 1e-5;
    for (const double off : {0.05, 0.0})
        for_parts(off, [&](const Part& of) {
            const std::vector<double> y = off > 0 ? of.moved(of.start(), 0.05) : of.start();
            const std::vector<double> plus = of.moved(y, h), minus = of.moved(y, -h);
            const std::vector<double> d = of.moved(std::vector<double>(y.size()), 1);
            CHECK((of.value(plus) - of.value(minus)) / (2 * h) ==
                  doctest::Approx(dot(of.gradient(y), d)).epsilon(1e-6));
            if (off > 0) return;
            const std::vector<double> Hd = of.hessian_times(y, false, d);
            std::vector<double> change = of.gradient(plus);
            const std::vector<double> before = of.gradient(minus);
            for (std::size_t i = 0; i < y.size(); ++i) change[i] = (change[i] - before[i]) / (2 * h) - Hd[i];
            CHECK(norm_inf(Hd) > 1e-3);
            CHECK(norm_inf(change) < 1e-6 * norm_inf(Hd));
        });
}

TEST_CASE("its projected Hessian is positive semidefinite") {
    for_parts(0.05, [](const Part& of) {
        for (int k = 1; k < 20; ++k) {
            std::vector<double> v(of.start().size());
            for (std::ptrdiff_t i = 0; i < of.coordinates(); ++i) v[i] = std::cos(static_cast<double>(k * (i + 1)));
            const std::vector<double> Hv = of.hessian_times(of.start(), true, v);
            CHECK(dot(v, Hv) > -1e-12 * norm_inf(Hv));
        }
    });
}
