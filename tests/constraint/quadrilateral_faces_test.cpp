// The trace space, targets and sliding on boundaries of quadrilaterals, and of quadrilaterals and triangles.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "constraint/dirichlet.hpp"
#include "constraint/sliding.hpp"
#include "constraint/sliding_nodes.hpp"
#include "mesh/build.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Mesh solid(int k, const std::string& layers, int degree) {
    std::vector<std::string> notes;
    return raise_degree(build_mesh(solid_block(k, layers), notes), degree);
}

// Half as wide at the top: the sides are trapezoids.
Mesh frustum(const std::string& layers, int degree) {
    Mesh mesh = solid(1, layers, degree);
    const auto height = static_cast<double>(layers.size());
    for (int i = 0; i < mesh.nodes(); ++i)
        for (int a = 0; a < 2; ++a) mesh.x[3 * i + a] = (mesh.x[3 * i + a] - 0.5) * (2 - mesh.x[3 * i + 2] / height);
    mesh.x = straight_sided(mesh);
    return mesh;
}

// Values at the trace nodes, x 3.
template <class Function>
std::vector<double> on_trace(const TraceSpace& trace, const std::vector<double>& x, const Function& function) {
    std::vector<double> v(trace.size());
    for (int t = 0; t < trace.count(); ++t) v[3 * t] = function(&x[3 * trace.nodes[t]]);
    return v;
}

}  // namespace

TEST_CASE("the trace space's product on bilinear faces has their areas and integrals") {
    for (const int degree : {1, 2, 3, 4}) {
        CAPTURE(degree);
        const Mesh mesh = frustum("h", degree);
        const TraceSpace trace(mesh, mesh.x, target_of(mesh, {}));
        const double bottom = 4, top = 1, side = 1.5 * std::sqrt(1.25);  // z = 0: 2 x 2, z = 1: 1 x 1
        const double roots = std::sqrt(bottom) + std::sqrt(top) + 4 * std::sqrt(side);
        CHECK(trace.norm_of_one == doctest::Approx(std::sqrt(roots)).epsilon(1e-13));
        const std::vector<double> one = on_trace(trace, mesh.x, [](const double*) { return 1; });
        CHECK(trace.product(one, one) == doctest::Approx(roots).epsilon(1e-13));
        // z^2 over the top is 1; over a side it is the integral of z^2 (2 - z) sqrt(1.25).
        const std::vector<double> z = on_trace(trace, mesh.x, [](const double* x) { return x[2]; });
        const double of_side = (2.0 / 3 - 0.25) * std::sqrt(1.25) / std::sqrt(side);
        CHECK(trace.product(z, z) == doctest::Approx(1 + 4 * of_side).epsilon(1e-13));
        const double volume = 7.0 / 3;  // of the only cell; its heights are over its faces
        for (int t = 0; t < trace.count(); ++t) {
            const double* const x = &mesh.x[3 * trace.nodes[t]];
            const bool is_in_top = x[2] > 1 - 1e-9 && std::max(std::abs(x[0]), std::abs(x[1])) < 0.49;
            CHECK(trace.height[t] == doctest::Approx(volume / (is_in_top ? top : x[2] < 1e-9 ? bottom : side)));
        }
    }
}

TEST_CASE("the trace space of triangles and quadrilaterals together") {
    for (const int degree : {1, 2, 3}) {
        const Mesh mesh = solid(2, "hdp", degree);
        const TraceSpace trace(mesh, mesh.x, target_of(mesh, {}));
        const double roots = (4 + 3 * 8) * 0.5 + 8 * std::sqrt(0.125);
        CHECK(trace.norm_of_one == doctest::Approx(std::sqrt(roots)).epsilon(1e-13));
        const std::vector<double> x = on_trace(trace, mesh.x, [](const double* p) { return p[0]; });
        // x^2 integrates to 1/3 over bottom and top (the latter in triangles of area 1/8), and over each of the two
        // sides y = 0 and 1 to 1/3 times the height 3/2, over x = 1 to 3/2.
        const double expected = (1.0 / 3 + 2 * 0.5 + 1.5) / 0.5 + (1.0 / 3) / std::sqrt(0.125);
        CHECK(trace.product(x, x) == doctest::Approx(expected).epsilon(1e-13));
    }
}

TEST_CASE("the projection of an affine target is its interpolation, and curved ones converge") {
    double last = 2;
    for (const int degree : {1, 2, 3, 4}) {
        const Mesh mesh = frustum("hdp", degree);
        const BoundaryTarget target = target_of(mesh, {{"sides", "scale 2 about 1 0 0; translate 1 2 3"},
                                                       {"top", "scale 2 about 1 0 0; translate 1 2 3"},
                                                       {"bottom", "scale 2 about 1 0 0; translate 1 2 3"}});
        const TraceSpace trace(mesh, mesh.x, target);
        const std::vector<double> a = trace.interpolation(mesh, target), b = trace.projection(mesh, target);
        for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == doctest::Approx(b[i]).epsilon(1e-11).scale(1));
        const std::string to_sphere = "sphere 0 0 1.5 4";
        const Mesh fine = frustum("hdp", degree);
        const BoundaryTarget curved =
            target_of(fine, {{"sides", to_sphere}, {"top", to_sphere}, {"bottom", to_sphere}});
        const Dirichlet constraint(fine, fine.x, curved, TargetKind::least_squares);
        CHECK(constraint.best_approximation_error() < 0.6 * last);
        last = constraint.best_approximation_error();
    }
}

TEST_CASE("quadrilaterals slide along planes, spheres and their own faces") {
    const Frame frame;
    const auto surfaces = [&](const Mesh& mesh) {
        return SlidingSurfaces(mesh, target_of(mesh, {}).node, std::vector<char>(mesh.boundaries.size(), 1), 30, frame);
    };
    const Mesh block = solid(2, "hdp", 2);
    const SlidingSurfaces of_block = surfaces(block);
    CHECK(of_block.parts() == 6);
    for (int part = 0; part < of_block.parts(); ++part) CHECK(of_block.surface(part).name() == "plane");

    for (const int degree : {1, 2, 3}) {
        Mesh ball = solid(3, "hhh", degree);
        std::fill(ball.face_boundary.begin(), ball.face_boundary.end(), 0);
        Mesh egg = ball;
        const auto place = [](Mesh& mesh, double amplitude) {
            for (int i = 0; i < mesh.nodes(); ++i) {
                Vec<3> x = 2.0 * positions(mesh, mesh.x, &i, 1)[0] - Vec<3>{1, 1, 1};
                const double cube = std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])});
                if (cube > 0) x = cube / length(x) * x;
                const double factor = 1 + amplitude * std::sin(2 * x[0]) * std::cos(x[1]) * (1 + 0.3 * x[2] * x[2]);
                for (int a = 0; a < 3; ++a) mesh.x[3 * i + a] = factor * x[a];
            }
        };
        place(ball, 0);
        const SlidingSurfaces of_ball = surfaces(ball);
        CHECK(of_ball.parts() == 1);
        CHECK(of_ball.surface(0).name() == "sphere of radius 1");
        place(egg, 0.1);
        const SlidingSurfaces of_egg = SlidingSurfaces(egg, target_of(egg, {}).node, {1, 1, 1}, 80, frame);
        REQUIRE(of_egg.parts() == 1);
        CHECK(of_egg.surface(0).name() == "the mesh's own faces");
        for (const int node : egg.faces) {
            const Vec<3> x = positions(egg, egg.x, &node, 1)[0];
            const SurfacePoint at = of_egg.closest(0, 1.05 * x);
            CHECK(length(at.position - x) < 0.2 * 0.05 + (degree == 1 ? 0.06 : 0.02));
            if (degree == 1 || node < 64) CHECK(length(of_egg.closest(0, x).position - x) < 1e-10);
        }
    }
}
