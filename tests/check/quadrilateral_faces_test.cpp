// Checks of boundaries of quadrilaterals, and of quadrilaterals and triangles.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "check/boundary_distance.hpp"
#include "check/infeasible.hpp"
#include "check/target_check.hpp"
#include "mesh/build.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Mesh solid(int k, const std::string& layers, int degree = 1) {
    std::vector<std::string> notes;
    return raise_degree(build_mesh(solid_block(k, layers), notes), degree);
}

// Two blocks, the second one moved by 2 in x, with other numbers of nodes.
Mesh two_blocks(int degree) {
    RawMesh raw = solid_block(1, "h");
    const RawMesh other = solid_block(1, "hdp");
    const auto nodes = static_cast<int>(raw.nodes.size()), elements = static_cast<int>(raw.elements.size());
    for (RawNode node : other.nodes) {
        node.id += nodes;
        node.x[0] += 2;
        raw.nodes.push_back(node);
    }
    for (RawElement element : other.elements) {
        element.id += elements;
        element.first += raw.element_nodes.size();
        raw.elements.push_back(element);
    }
    const std::size_t first = raw.element_nodes.size();
    for (std::size_t k = raw.elements.size() - other.elements.size(), i = 0; i < other.elements.size(); ++i, ++k)
        raw.elements[k].first = first + other.elements[i].first;
    for (const int node : other.element_nodes) raw.element_nodes.push_back(node + nodes);
    std::vector<std::string> notes;
    return raise_degree(build_mesh(raw, notes), degree);
}

bool mentions(const TargetReport& report, const std::string& text) {
    return std::any_of(report.faults.begin(), report.faults.end(),
                       [&](const TargetReport::Fault& fault) { return fault.why.find(text) != std::string::npos; });
}

// The positions with the second of two_blocks() moved and scaled.
std::vector<double> with_second(const Mesh& mesh, const Vec<3>& shift, double scale = 1) {
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i)
        for (int a = 0; a < 3 && mesh.x[3 * i] > 1.5; ++a) x[3 * i + a] = scale * mesh.x[3 * i + a] + shift[a];
    return x;
}

}  // namespace

TEST_CASE("targets that quadrilateral faces can keep have no faults") {
    for (const int degree : {1, 2, 3})
        for (const char* const layers : {"hh", "hdp"}) {
            const Mesh mesh = solid(2, layers, degree);
            CHECK(check_target(mesh, mesh.x).faults.empty());
            CHECK(check_target(mesh, wavy(mesh.x, 3, 0.05)).faults.empty());
            std::vector<double> turned = mesh.x;
            for (int i = 0; i < mesh.nodes(); ++i) {
                turned[3 * i] = 5 - 3 * mesh.x[3 * i + 1];
                turned[3 * i + 1] = 3 * mesh.x[3 * i] + 1;
                turned[3 * i + 2] = 3 * mesh.x[3 * i + 2];
            }
            CHECK(check_target(mesh, turned).faults.empty());
            for (int i = 0; i < mesh.nodes(); ++i) turned[3 * i + 2] *= -1;
            CHECK(mentions(check_target(mesh, turned), "mirrors or turns inside out"));
        }
}

TEST_CASE("quadrilateral faces that cross are found, once each pair, and parts inside each other") {
    for (const int degree : {1, 2}) {
        const Mesh mesh = two_blocks(degree);
        CHECK(check_target(mesh, mesh.x).faults.empty());
        const TargetReport crossing = check_target(mesh, with_second(mesh, {-1.4, 0.3, 0.35}));
        CHECK(mentions(crossing, "in the target it crosses"));
        REQUIRE(!crossing.crossing.empty());
        for (std::size_t k = 1; k < crossing.crossing.size(); ++k)
            CHECK(crossing.crossing[k - 1] < crossing.crossing[k]);
        for (const auto& [f, g] : crossing.crossing) CHECK((mesh.face(f)[0] < 8) != (mesh.face(g)[0] < 8));
        CHECK(check_target(mesh, with_second(mesh, {-0.98, 0.3, 0.35})).crossing.empty());
        const TargetReport inside = check_target(mesh, with_second(mesh, {-0.1, 0.3, 0.1}, 0.25));
        CHECK(mentions(inside, "through the one made of"));
    }
}

TEST_CASE("quadrilateral faces that fold, collapse or lie flat on a neighbour are found") {
    for (const int degree : {1, 2}) {
        const Mesh mesh = solid(1, "h", degree);
        std::vector<double> folded = mesh.x;  // a corner of the top beyond the diagonal
        for (int i = 0; i < 8; ++i)
            if (mesh.x[3 * i] + mesh.x[3 * i + 1] + mesh.x[3 * i + 2] == 3) folded[3 * i] = folded[3 * i + 1] = 0.1;
        CHECK(mentions(check_target(mesh, folded), "folds the face back on itself"));
        std::vector<double> collapsed = mesh.x;
        for (int i = 0; i < mesh.nodes(); ++i)
            if (mesh.x[3 * i + 2] == 1) collapsed[3 * i] = 0.5;
        CHECK(mentions(check_target(mesh, collapsed), "collapses the face"));
        std::vector<double> flat = mesh.x;  // the top folded onto the side x = 1
        for (int i = 0; i < mesh.nodes(); ++i)
            if (mesh.x[3 * i + 2] == 1) {
                flat[3 * i] = 1;
                flat[3 * i + 2] = mesh.x[3 * i];
            }
        CHECK(!check_target(mesh, flat).faults.empty());
    }
}

TEST_CASE("distances to walls of quadrilaterals are exact") {
    for (const int degree : {1, 3}) {
        const Mesh mesh = solid(2, "hhh", degree);
        std::vector<char> wall(mesh.boundaries.size(), 0);
        wall[mesh.boundary_index("bottom")] = 1;
        const std::vector<double> distance = wall_distance(mesh, mesh.x, wall);
        for (int i = 0; i < mesh.nodes(); ++i) CHECK(distance[i] == doctest::Approx(mesh.x[3 * i + 2]).epsilon(1e-12));
    }
}

TEST_CASE("corners of hexahedra and prisms that the target folds are told, those of others are not") {
    for (const int degree : {1, 2, 3})
        for (const char* const layers : {"h", "p", "hdp"}) {
            const Mesh mesh = solid(1, layers, degree);
            std::vector<char> prescribed(mesh.nodes(), 0);
            for (const int i : mesh.faces) prescribed[i] = 1;
            CHECK(infeasible_elements(mesh, mesh.x, prescribed).empty());
            std::vector<double> x = mesh.x;
            int moved = -1;
            for (int i = 0; i < mesh.nodes(); ++i)
                if (mesh.x[3 * i] == 1 && mesh.x[3 * i + 1] == 0 && mesh.x[3 * i + 2] == 0) moved = i;
            x[3 * moved + 2] = 9;
            if (degree > 1)
                for (int i = 0; i < mesh.nodes(); ++i)  // all of its edge with it
                    if (mesh.x[3 * i] == 1 && mesh.x[3 * i + 1] == 0 && mesh.x[3 * i + 2] < 0.999) x[3 * i + 2] = 9;
            CHECK(!infeasible_elements(mesh, x, prescribed).empty());
            prescribed[moved] = 0;
            if (degree == 1) CHECK(infeasible_elements(mesh, x, prescribed).empty());
        }
}
