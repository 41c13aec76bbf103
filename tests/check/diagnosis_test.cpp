#include "check/diagnosis.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "check/injectivity.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A mesh whose boundaries move, and positions on their way.
struct Case {
    Minimisation problem;
    BoundaryTarget target;
    std::vector<double> x, distortion;

    explicit Case(const Mesh& any, const std::map<std::string, std::string>& motions = {})
        : problem(any, motions, Objective::squared),
          target(target_of(any, motions)),
          x(problem.ideal),
          distortion(any.element_count(), 1.0) {}

    LastMesh last() const { return {problem.mesh, problem.ideal, x, problem.constraint, target, distortion}; }
    const Mesh& mesh() const { return problem.mesh; }
    std::string boundary(const Diagnosis& diagnosis) const { return mesh().boundaries.at(diagnosis.boundary); }
};

int node_at(const Mesh& mesh, const std::vector<double>& place) {
    for (int i = 0; i < mesh.nodes(); ++i) {
        double distance = 0;
        for (int a = 0; a < mesh.dim; ++a) distance += std::abs(point(mesh.x, i, mesh.dim)[a] - place[a]);
        if (distance < 1e-9) return i;
    }
    return -1;
}

bool has_node(const Mesh& mesh, int element, int node) {
    const int* const first = mesh.element(element);
    return std::find(first, first + mesh.element_nodes(), node) != first + mesh.element_nodes();
}

}  // namespace

TEST_CASE("the node farthest from its target, in heights of its cells, with its boundary and its way") {
    for (const int degree : {1, 2})
        for (const bool in_space : {false, true}) {
            const Mesh mesh = raise_degree(in_space ? cube_mesh(2) : square_mesh(2), degree);
            std::map<std::string, std::string> motions;
            for (const std::string& name : mesh.boundaries)
                motions[name] = in_space ? "translate 4 0 0" : "translate 4 0";
            Case moved(mesh, motions);
            const int node = node_at(mesh, {0.5, in_space ? 0.5 : 1, 1});
            REQUIRE(node >= 0);
            for (int i = 0; i < mesh.nodes(); ++i) point(moved.x, i, mesh.dim)[0] += i == node ? 3 : 3.75;
            for (int e = 0; e < mesh.element_count(); ++e) moved.distortion[e] = 1 + e;
            const Diagnosis found = farthest_off_target(moved.last());
            CHECK(found.kind == DiagnosisKind::off_target);
            CHECK(found.node == node);
            CHECK(found.on_boundary);
            CHECK(moved.boundary(found) == "top");
            CHECK(found.distance == doctest::Approx(1));
            CHECK(found.heights == doctest::Approx(2));
            CHECK(found.way == doctest::Approx(0.75));
            CHECK(found.position[0] == doctest::Approx(3.5));
            CHECK(found.target[0] == doctest::Approx(4.5));
            int last_element = -1;
            for (int e = 0; e < mesh.element_count(); ++e)
                if (has_node(mesh, e, node)) last_element = e;
            CHECK(found.element == last_element);
        }
}

TEST_CASE("no way is told of nodes that should have stayed or slide, and none is farthest where all are in place") {
    Case ring(ring_mesh(12, 3, 6), {{"inner", "translate 1 0"}});
    const int outer = node_at(ring.mesh(), {6, 0});
    for (const int i : ring.mesh().faces)
        if (std::hypot(point(ring.problem.ideal, i, 2)[0], point(ring.problem.ideal, i, 2)[1]) < 2)
            point(ring.x, i, 2)[0] = point(ring.problem.ideal, i, 2)[0] + 1;
    CHECK(farthest_off_target(ring.last()).kind == DiagnosisKind::none);
    point(ring.x, outer, 2)[0] -= 0.5;
    const Diagnosis found = farthest_off_target(ring.last());
    CHECK(found.node == outer);
    CHECK(ring.boundary(found) == "outer");
    CHECK(std::isnan(found.way));
    ring.x = ring.problem.ideal;
    CHECK(farthest_off_target(ring.last()).way == doctest::Approx(0).scale(1));
    set_kind(ring.mesh(), "inner", NodeKind::slides, ring.target);
    CHECK(std::isnan(farthest_off_target(ring.last()).way));
}

TEST_CASE("the node with the largest part of the gradient, and the boundary nearest to it") {
    const Case ring(ring_mesh(12, 3, 6));
    const Mesh& mesh = ring.mesh();
    std::vector<double> gradient(mesh.x.size(), 0.0);
    CHECK(least_balanced(ring.last(), gradient).kind == DiagnosisKind::none);
    const int inside = 12 * 2, at_wall = 12 * 3;  // in the third of four circles, on the fourth
    point(gradient, inside, 2)[1] = -4;
    point(gradient, at_wall, 2)[0] = 3;
    Diagnosis found = least_balanced(ring.last(), gradient);
    CHECK(found.kind == DiagnosisKind::unbalanced);
    CHECK(found.node == inside);
    CHECK(!found.on_boundary);
    CHECK(found.share == doctest::Approx(0.8));
    const double r = std::hypot(point(mesh.x, inside, 2)[0], point(mesh.x, inside, 2)[1]);
    CHECK(ring.boundary(found) == (r - 1 < 6 - r ? "inner" : "outer"));
    point(gradient, at_wall, 2)[0] = 5;
    found = least_balanced(ring.last(), gradient);
    CHECK(found.node == at_wall);
    CHECK(found.on_boundary);
    CHECK(ring.boundary(found) == "outer");
}

TEST_CASE("the most distorted and the least valid element") {
    Case cube(cube_mesh(2));
    cube.distortion[5] = 7;
    const Diagnosis worst = most_distorted(cube.last());
    CHECK(worst.kind == DiagnosisKind::distorted);
    CHECK(worst.element == 5);
    CHECK(worst.node == -1);
    CHECK(worst.position == centroid(cube.mesh(), cube.x, cube.mesh().element(5), 4));
    std::vector<double> bound(cube.mesh().element_count(), 1.0);
    bound[11] = -0.25;
    const Diagnosis folded = least_valid(cube.last(), bound);
    CHECK(folded.kind == DiagnosisKind::invalid);
    CHECK(folded.element == 11);
}

TEST_CASE("an overlap is at the node or the face that the check of injectivity names") {
    const Case ring(ring_mesh(12, 3, 6));
    Injectivity found;
    found.node = 30;
    CHECK(overlapping(ring.last(), found).node == 30);
    CHECK(overlapping(ring.last(), found).kind == DiagnosisKind::overlap);
    found.node = -1;
    found.face = 3;
    const Diagnosis at_face = overlapping(ring.last(), found);
    CHECK(at_face.element == ring.mesh().face_element[3]);
    CHECK(at_face.boundary == ring.mesh().face_boundary[3]);
    found.face = -1;
    CHECK(overlapping(ring.last(), found).kind == DiagnosisKind::none);
}

TEST_CASE("a neighbourhood grows ring by ring, as long as it is not too large") {
    for (const int degree : {1, 2}) {
        const Mesh mesh = raise_degree(square_mesh(12), degree);
        Diagnosis at;
        at.node = node_at(mesh, {0.5, 0.5});
        CHECK(neighbourhood(mesh, at, 1).element.size() == 6);
        CHECK(neighbourhood(mesh, at, 2).element.size() == 24);
        CHECK(neighbourhood(mesh, at).element.size() == 54);
        CHECK(neighbourhood(mesh, at, 3, 30).element.size() == 24);
        CHECK(neighbourhood(mesh, at, 3, 5).element.size() == 6);
        const Restriction around = neighbourhood(mesh, at);
        CHECK(around.elements.size() == around.element.size() * mesh.element_nodes());
        for (std::size_t k = 0; k < around.elements.size(); ++k)
            CHECK(around.node[around.elements[k]] ==
                  mesh.element(around.element[k / mesh.element_nodes()])[k % mesh.element_nodes()]);
        at.node = -1;
        at.element = 0;  // in the corner of the square with two triangles
        CHECK(neighbourhood(mesh, at, 1).element.size() == 7);
    }
}

TEST_CASE("a node of two boundaries belongs to the one that prescribes its place") {
    const Mesh mesh = square_mesh(2);
    const int corner = node_at(mesh, {0, 0});
    for (const char* const slides : {"left", "bottom"}) {
        const std::vector<int> boundary = boundary_of_nodes(mesh, target_of(mesh, {{slides, "slide"}}));
        CHECK(mesh.boundaries[boundary[corner]] == (std::string(slides) == "left" ? "bottom" : "left"));
        CHECK(boundary[node_at(mesh, {0.5, 0.5})] == -1);
    }
}

TEST_CASE("every kind of diagnosis has a name of its own") {
    using enum DiagnosisKind;
    CHECK(std::string(to_string(none)) == "none");
    CHECK(std::string(to_string(off_target)) == "off_target");
    CHECK(std::string(to_string(unbalanced)) == "unbalanced");
    CHECK(std::string(to_string(distorted)) == "distorted");
    CHECK(std::string(to_string(invalid)) == "invalid");
    CHECK(std::string(to_string(overlap)) == "overlap");
}
