#include "constraint/sliding.hpp"
#include "constraint/sliding_nodes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::unique_ptr<SlidingSurfaces> surfaces_of(const Mesh& mesh, const std::vector<std::string>& names) {
    std::vector<char> slides(mesh.boundaries.size(), 0);
    for (const std::string& name : names) slides[mesh.boundary_index(name)] = 1;
    return std::make_unique<SlidingSurfaces>(mesh, target_of(mesh, {}).node, slides, 30, Frame());
}

// A piece of a pipe along y: cylinders of radius 2 and 3, planes around.
Mesh pipe_mesh() {
    Mesh pipe = cube_mesh(3);
    for (int i = 0; i < pipe.nodes(); ++i) {
        const double angle = pipe.x[3 * i], r = 2 + pipe.x[3 * i + 2];
        pipe.x[3 * i] = r * std::sin(angle), pipe.x[3 * i + 2] = r * std::cos(angle);
    }
    return pipe;
}

// Of the pipe: the inner cylinder, its end y = 0, and both.
struct Pipe {
    Mesh mesh = pipe_mesh();
    std::unique_ptr<SlidingSurfaces> sliding = surfaces_of(mesh, {"bottom", "sides"});
    int cylinder = part("bottom", {2 * std::sin(0.5), 0.5, 2 * std::cos(0.5)});
    int end = part("sides", {2.5 * std::sin(0.5), 0, 2.5 * std::cos(0.5)});
    int side = part("sides", {0, 0.5, 2.5});
    std::vector<std::vector<int>> combinations = {{cylinder}, {end}, {cylinder, end}, {end, cylinder},
                                                  {cylinder, end, side}};

    int part(const char* boundary, const Vec<3>& x) const {
        return sliding->part(mesh, face_near(mesh, mesh.boundary_index(boundary), x));
    }
};

}  // namespace

TEST_CASE("a point at given distances from one, two or three surfaces") {
    const Pipe pipe;
    CHECK(pipe.sliding->surface(pipe.cylinder).name() == "cylinder of radius 2");
    const Vec<3> x = {1.1, 0.15, 1.9};
    const std::array<double, 3> wanted = {0.04, -0.03, 0.02};
    for (const std::vector<int>& parts : pipe.combinations) {
        const Vec<3> at = at_distances(*pipe.sliding, parts, x, wanted);
        const std::array<double, 3> is = distances(*pipe.sliding, parts, at, {});
        for (std::size_t k = 0; k < parts.size(); ++k) CHECK(is[k] == doctest::Approx(wanted[k]).epsilon(1e-12));
        const Vec<3> on = on_surfaces(*pipe.sliding, parts, x);
        for (const int part : parts) CHECK(length(pipe.sliding->closest(part, on).position - on) < 1e-14);
        CHECK(length(distance_to(*pipe.sliding, parts, on).r) < 1e-14);
        CHECK(length(on - x) < (parts.size() < 3 ? 0.3 : 1.2));
    }
    const Vec<3> corner = on_surfaces(*pipe.sliding, pipe.combinations.back(), x);
    CHECK(length(corner - Vec<3>{0, 0, 2}) < 1e-13);
}

TEST_CASE("distances are told to first order, and the point at them is that far from the straight step") {
    const Pipe pipe;
    const Vec<3> x = {1.05, 0.02, 1.75}, d = {0.3, -0.2, 0.4};
    for (const std::vector<int>& parts : pipe.combinations) {
        double error[2], bend[2];
        for (int k = 0; k < 2; ++k) {
            const double t = 0.1 / (1 << k);
            const std::array<double, 3> predicted = distances(*pipe.sliding, parts, x, t * d);
            const std::array<double, 3> are = distances(*pipe.sliding, parts, x + t * d, {});
            error[k] = 0;
            for (std::size_t i = 0; i < parts.size(); ++i)
                error[k] = std::max(error[k], std::abs(predicted[i] - are[i]));
            bend[k] = length(at_distances(*pipe.sliding, parts, x + t * d, predicted) - (x + t * d));
        }
        if (parts == std::vector<int>{pipe.end}) {  // a plane
            CHECK(error[0] < 1e-15);
            CHECK(bend[0] < 1e-15);
            continue;
        }
        CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.1));
        CHECK(std::log2(bend[0] / bend[1]) == doctest::Approx(2).epsilon(0.1));
    }
}

TEST_CASE("the slope of the distance to one, two or three surfaces is its derivative, as is its own on the surfaces") {
    const Pipe pipe;
    const Vec<3> d = {0.3, -0.2, 0.4}, force = {-0.7, 0.5, 0.9};
    const double h = 1e-5;
    for (const std::vector<int>& parts : pipe.combinations) {
        const Vec<3> near = {1.1, 0.15, 1.9}, on = on_surfaces(*pipe.sliding, parts, near);
        for (const Vec<3>& x : {near, on}) {
            const SurfaceDistance at = distance_to(*pipe.sliding, parts, x);
            const Vec<3> change = 0.5 / h * (distance_to(*pipe.sliding, parts, x + h * d).r -
                                             distance_to(*pipe.sliding, parts, x - h * d).r);
            for (int i = 0; i < 3; ++i) CHECK(std::abs(dot(at.slope[i], d) - change[i]) < 1e-8);
        }
        const Mat<3> second = second_derivative(*pipe.sliding, parts, on, force);
        const auto pulled = [&](const Vec<3>& x) {  // slope' force
            const Mat<3> slope = distance_to(*pipe.sliding, parts, x).slope;
            Vec<3> sum{};
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) sum[j] += slope[i][j] * force[i];
            return sum;
        };
        const Vec<3> change = 0.5 / h * (pulled(on + h * d) - pulled(on - h * d));
        for (int i = 0; i < 3; ++i) CHECK(std::abs(dot(second[i], d) - change[i]) < 1e-8);
    }
}

TEST_CASE("nodes that a target releases slide along its surface, and meet there; all others stay") {
    const Mesh mesh = raise_degree(ring_mesh(12, 2, 3), 2);
    BoundaryTarget target = target_of(mesh, {{"inner", "circle 0 0 1"}, {"outer", "circle 0 0 3"}});
    std::vector<char> freed(mesh.nodes(), 0);
    int inner_face = 0;
    while (mesh.boundaries[mesh.face_boundary[inner_face]] != "inner") ++inner_face;
    for (int i = 0; i < 3; ++i) freed[mesh.face(inner_face)[i]] = 1;
    free_nodes(mesh, freed, target);
    std::vector<char> slides(mesh.boundaries.size(), 0), fixed;
    slides[mesh.boundary_index("inner")] = 1;
    const SlidingSurfaces sliding(mesh, target.node, slides, 30, {});
    REQUIRE(sliding.parts() == 1);
    std::vector<int> nodes = mesh.faces, places(mesh.faces.size());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (std::size_t k = 0; k < places.size(); ++k)
        places[k] = static_cast<int>(std::lower_bound(nodes.begin(), nodes.end(), mesh.faces[k]) - nodes.begin());
    const std::vector<double> at = at_target(mesh, target, mesh.x);
    std::vector<double> of_nodes;
    for (const int i : nodes) of_nodes.insert(of_nodes.end(), point(at, i, 2), point(at, i, 2) + 2);
    const auto parts = sliding_parts(mesh, target, &sliding, nodes, places, of_nodes, fixed);
    for (std::size_t t = 0; t < nodes.size(); ++t) {
        CHECK(parts[t] == (freed[nodes[t]] ? std::vector<int>{0} : std::vector<int>{}));
        CHECK(static_cast<bool>(fixed[t]) == !freed[nodes[t]]);
    }
}
