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
    std::vector<int> node;
    BlockCsr pattern;
    std::unique_ptr<Constraint> constraint;
    std::unique_ptr<ConstraintPart> part;
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
        const int* const first = mesh.element(0);
        for (int i = 0; i < mesh.nodes(); ++i)
            if (i % 3 == 0 || std::count(first, first + mesh.element_nodes(), i)) node.push_back(i);
        std::vector<int> all(node.size());
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
        const int count = static_cast<int>(node.size());
        pattern = matrix_of_cells(count, mesh.dim, all, count);
        part = constraint->part(x, lambda, mu, node, pattern);
    }

    std::vector<double> start() const {
        std::vector<double> y;
        for (const int i : node) y.insert(y.end(), point(x, i, mesh.dim), point(x, i, mesh.dim) + mesh.dim);
        return y;
    }
    std::vector<double> with(const std::vector<double>& y) const {
        std::vector<double> all = x;
        for (std::size_t k = 0; k < node.size(); ++k)
            std::copy_n(&y[k * mesh.dim], mesh.dim, point(all, node[k], mesh.dim));
        return all;
    }
    double value(const std::vector<double>& y) const {
        double E = 0;
        part->add_value(y, E);
        return E;
    }
    std::vector<double> gradient(const std::vector<double>& y) const {
        std::vector<double> g(y.size(), 0.0);
        part->add_gradient(y, g);
        return g;
    }
};

std::vector<double> moved(std::vector<double> y, double t) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += t * std::sin(7.0 * static_cast<double>(i));
    return y;
}

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
        const std::vector<double> y = moved(of.start(), 0.05);
        const double change = of.value(y) - of.value(of.start());
        CHECK(std::abs(change) > 1e-4);
        CHECK(change == doctest::Approx(of.constraint->value(of.with(y), of.lambda, of.mu) -
                                        of.constraint->value(of.x, of.lambda, of.mu)).epsilon(1e-10));
        const std::vector<double> g = of.gradient(y);
        std::vector<double> whole(of.x.size(), 0.0);
        of.constraint->add_gradient(of.with(y), of.lambda, of.mu, whole);
        for (std::size_t k = 0; k < of.node.size(); ++k)
            for (int a = 0; a < of.mesh.dim; ++a)
                CHECK(g[k * of.mesh.dim + a] ==
                      doctest::Approx(point(whole, of.node[k], of.mesh.dim)[a]).epsilon(1e-10).scale(1));
    });
}

TEST_CASE("its gradient is the derivative of its value everywhere, its Hessian that of the gradient on the surfaces") {
    const double h = 1e-5;
    for (const double off : {0.05, 0.0})
        for_parts(off, [&](const Part& of) {
            const std::vector<double> y = off > 0 ? moved(of.start(), 0.05) : of.start();
            const std::vector<double> plus = moved(y, h), minus = moved(y, -h);
            const std::vector<double> d = moved(std::vector<double>(y.size()), 1);
            CHECK((of.value(plus) - of.value(minus)) / (2 * h) ==
                  doctest::Approx(dot(of.gradient(y), d)).epsilon(1e-6));
            if (off > 0) return;
            BlockCsr H = of.pattern;
            of.part->add_hessian(y, false, H);
            std::vector<double> Hd(y.size()), change = of.gradient(plus);
            multiply(H, d.data(), Hd.data());
            const std::vector<double> before = of.gradient(minus);
            for (std::size_t i = 0; i < y.size(); ++i) change[i] = (change[i] - before[i]) / (2 * h) - Hd[i];
            CHECK(norm_inf(Hd) > 1e-3);
            CHECK(norm_inf(change) < 1e-6 * norm_inf(Hd));
        });
}

TEST_CASE("its projected Hessian is positive semidefinite") {
    for_parts(0.05, [](const Part& of) {
        BlockCsr H = of.pattern;
        of.part->add_hessian(of.start(), true, H);
        for (int k = 1; k < 20; ++k) {
            std::vector<double> v(of.start().size()), Hv(v.size());
            for (std::size_t i = 0; i < v.size(); ++i) v[i] = std::cos(static_cast<double>(k * (i + 1)));
            multiply(H, v.data(), Hv.data());
            CHECK(dot(v, Hv) > -1e-12 * norm_inf(Hv));
        }
    });
}
