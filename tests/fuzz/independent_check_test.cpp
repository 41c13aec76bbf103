// The harnesses' own check finds what it is there for.
#include "fuzz/independent_check.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/program.hpp"
#include "support/sample_mesh.hpp"

using namespace almesh;
using namespace almesh::fuzz;

namespace {

std::string fault(const RawMesh& raw, bool either_winding = false) {
    return fault_of(Elements(raw), either_winding);
}

// A second copy of the mesh, moved along x.
void append_copy(RawMesh& raw, double by) {
    const std::size_t nodes = raw.nodes.size(), elements = raw.elements.size();
    for (std::size_t i = 0; i < nodes; ++i) {
        RawNode node = raw.nodes[i];
        node.x[0] += by;
        raw.nodes.push_back(node);
    }
    for (std::size_t e = 0; e < elements; ++e) {
        RawElement element = raw.elements[e];
        const int count = simplex_node_count(element.dim, element.degree);
        for (int k = 0; k < count; ++k)
            raw.element_nodes.push_back(raw.element_nodes[element.first + k] + static_cast<int>(nodes));
        element.first = raw.element_nodes.size() - count;
        raw.elements.push_back(element);
    }
}

}  // namespace

TEST_CASE("inverted elements, by their winding or by a node") {
    for (int dim : {2, 3})
        for (int degree : {1, 2, 3}) {
            CAPTURE(dim);
            CAPTURE(degree);
            RawMesh raw = SampleMesh(dim, degree, 2).raw;
            CHECK(fault(raw) == "");
            CHECK(fault(raw, true) == "");
            const RawMesh turned = SampleMesh(dim, degree, 2, true).raw;
            CHECK(test::has(fault(turned), "is inverted"));
            CHECK(fault(turned, true) == "");
            const RawElement& element = raw.elements.back();
            raw.nodes[raw.element_nodes[element.first]].x[0] += 1;
            CHECK(test::has(fault(raw, true), degree == 1 ? "overlap" : "is inverted"));
        }
}

// x(t) along an edge from 0 to 1 with its middle node at m has x' = 4 m - 1 at 0.
TEST_CASE("a curved element that is inverted near a vertex alone") {
    for (const double middle : {0.26, 0.24}) {
        RawMesh raw;
        for (const auto& [x, y] : {std::pair(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}, {middle, 0.0}, {0.5, 0.5}, {0.0, 0.5}})
            raw.nodes.push_back({static_cast<long long>(raw.nodes.size()) + 1, {x, y, 0}, 0});
        raw.element_nodes = {0, 1, 2, 3, 4, 5};
        raw.elements.push_back({1, 0, 0, 2, 2, 1, 1});
        CHECK((fault(raw) == "") == (middle > 0.25));
    }
}

TEST_CASE("elements in each other, of meshes that are valid by themselves") {
    for (int dim : {2, 3})
        for (int degree : {1, 2}) {
            CAPTURE(dim);
            CAPTURE(degree);
            for (const double by : {0.25, 1.0}) {
                RawMesh raw = SampleMesh(dim, degree, 1).raw;
                append_copy(raw, by);
                CHECK(test::has(fault(raw), "overlap") == (by < 1));
            }
        }
}

TEST_CASE("sides of one element, with the names of their groups") {
    const Elements elements(SampleMesh(3, 2, 2).raw);
    CHECK(elements.sides.size() == 6 * 4 * 2);
    int left = 0;
    for (const Elements::Side& side : elements.sides) {
        CHECK(side.node.size() == 6);
        left += side.boundary == "left";
    }
    CHECK(left == 8);
}

TEST_CASE("distances from points, segments and triangles") {
    const std::vector<Point> triangle = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
    CHECK(distance({3, 4, 0}, {{0, 0, 0}}) == doctest::Approx(5));
    CHECK(distance({1, 3, 0}, {{0, 0, 0}, {2, 0, 0}}) == doctest::Approx(3));
    CHECK(distance({-3, 4, 0}, {{0, 0, 0}, {2, 0, 0}}) == doctest::Approx(5));
    CHECK(distance({0.5, 0.5, -7}, triangle) == doctest::Approx(7));
    CHECK(distance({2, 2, 0}, triangle) == doctest::Approx(std::sqrt(2)));
    CHECK(distance({-3, -4, 0}, triangle) == doctest::Approx(5));
}
