#include "check/infeasible.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "problem/curved_part.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

int node_at(const Mesh& mesh, const Vec<3>& place) {
    for (int i = 0; i < mesh.nodes(); ++i) {
        double distance = 0;
        for (int a = 0; a < mesh.dim; ++a) distance += std::abs(point(mesh.x, i, mesh.dim)[a] - place[a]);
        if (distance < 1e-9) return i;
    }
    FAIL("no node there");
    return -1;
}

// A mesh of degree 2 as a curved file has it: nodes of the straight one moved.
struct Curved {
    Mesh mesh;

    explicit Curved(const Mesh& linear) : mesh(with_degree(linear, 2)) {}
    void move(const Vec<3>& from, const Vec<3>& to) {
        std::copy_n(to.begin(), mesh.dim, point(mesh.x, node_at(with_straight_edges(), from), mesh.dim));
    }
    Mesh with_straight_edges() const {
        Mesh straight = mesh;
        straight.x = straight_sided(mesh);
        return straight;
    }
    BoundaryTarget target(const std::map<std::string, std::string>& motions = {}) const {
        return target_of(mesh, motions);
    }
    Infeasible faults(const BoundaryTarget& of, double bound = 0) const {
        return find_infeasible(mesh, straight_sided(mesh), of, bound);
    }
};

// The middle node of the edge from (1/3, 0) to (1/2, 0), the third of the bottom's, in one of its ends nearly.
Curved with_folded_edge() {
    Curved square(square_mesh(6));
    square.move({5.0 / 12, 0, 0}, {1.0 / 3 + 0.01, 0, 0});
    return square;
}

// The corner (1, 0), in which an element has two edges, made wider than 180 degrees by the middles of these.
Curved with_wide_corner(double by) {
    Curved square(square_mesh(3));
    square.move({5.0 / 6, 0, 0}, {5.0 / 6, -by, 0});
    square.move({1, 1.0 / 6, 0}, {1 + by, 1.0 / 6, 0});
    return square;
}

std::vector<char> nodes_of(const Mesh& mesh, const std::vector<std::string>& boundaries) {
    std::vector<char> flag(mesh.nodes(), 0);
    for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k)
        for (const std::string& name : boundaries)
            if (mesh.boundaries[mesh.face_boundary[k / mesh.face_nodes(0)]] == name) flag[mesh.faces[k]] = 1;
    return flag;
}

}  // namespace

TEST_CASE("a face folded by its middle node: its whole straight side is released, and no other") {
    const Curved square = with_folded_edge();
    BoundaryTarget target = square.target();
    const Infeasible faults = square.faults(target);
    REQUIRE(faults.faces.faults.size() == 1);
    CHECK(faults.faces.faults[0].by_curvature);
    CHECK(!faults.none());
    CHECK(faults.sliding_may_help());
    free_nodes(square.mesh, nodes_to_free(square.mesh, target, faults), target);
    CHECK(freed_nodes(square.mesh, target) == nodes_of(square.mesh, {"bottom"}));
    CHECK(square.faults(target).none());
    CHECK(!square.faults(target).sliding_may_help());
}

TEST_CASE("in a mesh cut out of another, nodes at the cut stay, also where they end a side that is released") {
    const Curved square = with_folded_edge();
    std::vector<char> folded(square.mesh.element_count(), 0);
    folded[square.mesh.face_element[square.faults(square.target()).faces.faults[0].face]] = 1;
    Problem problem;
    problem.level = std::make_unique<Level>();
    problem.level->mesh = square.mesh;
    problem.level->ideal = straight_sided(square.mesh);
    CurvedPart part(problem, surroundings(square.mesh, folded, 0), square.mesh.x, square.mesh.x);
    part.free_nodes(part.nodes_to_free(part.find_infeasible(0), true));
    const std::vector<char> at_cut = part.on_cut, at_bottom = nodes_of(part, {"bottom"});
    int ends = 0;
    for (int i = 0; i < part.nodes(); ++i) {
        CHECK(bool(part.freed[i]) == (at_bottom[i] && !at_cut[i]));
        ends += at_bottom[i] && at_cut[i];
    }
    CHECK(ends == 2);
}

TEST_CASE("a folded face on a curved side: it and its neighbours are released") {
    Curved square = with_folded_edge();
    Mesh& mesh = square.mesh;
    mesh.x = mapped(mesh, [](double* p) { p[1] += 0.3 * (1 - p[1]) * p[0] * (p[0] - 1); });
    const BoundaryTarget target = square.target();
    const Infeasible faults = square.faults(target);
    REQUIRE(faults.sliding_may_help());
    const std::vector<char> freed = nodes_to_free(mesh, target, faults), bottom = nodes_of(mesh, {"bottom"});
    for (int i = 0; i < mesh.nodes(); ++i) {
        const double x = point(mesh.x, i, 2)[0];
        CHECK(static_cast<bool>(freed[i]) == (bottom[i] && x > 1.0 / 6 - 1e-9 && x < 4.0 / 6 + 1e-9));
    }
}

TEST_CASE("what slides or is free is no fault, and is not released") {
    const Curved square = with_folded_edge();
    for (const char* const open : {"slide", "free"}) {
        CHECK(square.faults(square.target({{"bottom", open}})).none());
        const BoundaryTarget target = square.target({{"right", open}, {"left", open}});
        const Infeasible faults = square.faults(target);
        REQUIRE(faults.sliding_may_help());
        CHECK(nodes_to_free(square.mesh, target, faults) == nodes_of(square.mesh, {"bottom"}));
    }
    const Curved corner = with_wide_corner(0.1);
    const BoundaryTarget target = corner.target({{"right", "free"}});
    CHECK(corner.faults(target).none());
}

TEST_CASE("an element with two curved edges that meet at more than 180 degrees: both straight sides are released") {
    const Curved square = with_wide_corner(0.1);
    BoundaryTarget target = square.target();
    const Infeasible faults = square.faults(target);
    CHECK(faults.faces.faults.empty());
    REQUIRE(faults.elements.size() == 1);
    CHECK(faults.elements[0].by_curvature);
    CHECK(faults.elements[0].scaled_determinant == doctest::Approx(1 - 16 * 0.01 * 9));
    CHECK(faults.sliding_may_help());
    free_nodes(square.mesh, nodes_to_free(square.mesh, target, faults), target);
    CHECK(freed_nodes(square.mesh, target) == nodes_of(square.mesh, {"bottom", "right"}));
    CHECK(square.faults(target).none());
    CHECK(with_wide_corner(0.08).faults(with_wide_corner(0.08).target()).none());
    const std::string text = describe(square.mesh, faults);
    CHECK(text == "\n  triangle " + std::to_string(square.mesh.file.element_id[faults.elements[0].element]) +
                      " at (0.888889, 0.111111): its boundary nodes make its scaled determinant -0.44, wherever the "
                      "nodes inside are");
}

TEST_CASE(
    "targets that leave next to nothing of an element are faults by the bound, unless a projection is in the way") {
    const double by = std::sqrt((1 - 0.005) / 16 / 9);
    const Curved square = with_wide_corner(by);
    CHECK(square.faults(square.target()).none());
    CHECK(square.faults(square.target(), 0.004).none());
    CHECK(square.faults(square.target(), 0.006).elements.size() == 1);
    BoundaryTarget projected = square.target();
    projected.in_trace_space = false;
    CHECK(square.faults(projected, 0.006).none());
    CHECK(with_wide_corner(0.1).faults(with_wide_corner(0.1).target()).elements.size() == 1);
}

TEST_CASE("a face of a cube folded by a middle node: the nodes of its plane are released, in 3D") {
    Curved cube(cube_mesh(4));
    cube.move({0.375, 0.5, 0}, {0.26, 0.5, 0});
    BoundaryTarget target = cube.target();
    const Infeasible faults = cube.faults(target);
    CHECK(faults.faces.faults.size() == 2);  // at that edge
    REQUIRE(faults.sliding_may_help());
    free_nodes(cube.mesh, nodes_to_free(cube.mesh, target, faults), target);
    CHECK(freed_nodes(cube.mesh, target) == nodes_of(cube.mesh, {"bottom"}));
    CHECK(cube.faults(target).none());
}

TEST_CASE("targets folded by vertices are not mended by sliding") {
    const std::string by = "0.3*x^2*(1-y)^2\"", moved = "expression \"x - " + by + " \"y + " + by;
    const std::map<std::string, std::string> dented = {
        {"left", moved}, {"right", moved}, {"bottom", moved}, {"top", moved}};
    for (const int degree : {1, 2}) {
        const Mesh mesh = with_degree(square_mesh(4), degree);
        const Infeasible faults = find_infeasible(mesh, mesh.x, target_of(mesh, dented));
        CHECK(faults.elements.size() == 1);
        CHECK(!faults.none());
        CHECK(!faults.sliding_may_help());
    }
    Curved square = with_folded_edge();  // one that could be mended beside one that could not
    square.move({1.0 / 6, 0, 0}, {0, 0, 0});
    const Infeasible faults = square.faults(square.target());
    CHECK(faults.faces.faults.size() >= 2);
    CHECK(!faults.sliding_may_help());
}

TEST_CASE("ten faults are told, and that there are more") {
    const Mesh mesh = ring_mesh(16, 1, 3);
    const Infeasible faults = find_infeasible(mesh, mesh.x, target_of(mesh, {{"inner", "rotate 120"}}));
    REQUIRE(faults.elements.size() > 10);
    const std::string text = describe(mesh, faults);
    CHECK(std::count(text.begin(), text.end(), '\n') == 11);
    CHECK(text.ends_with("\n  ..."));
}

TEST_CASE("elements between two boundaries: sliding may help, and their own vertices are released") {
    const Mesh ring = ring_mesh(16, 1, 1.25);
    BoundaryTarget target = target_of(
        ring, {{"inner", "expression \"x*cos(0.9*x)-y*sin(0.9*x)\" \"x*sin(0.9*x)+y*cos(0.9*x)\""}});
    const Infeasible faults = find_infeasible(ring, straight_sided(ring), target);
    REQUIRE(faults.elements.size() == 6);
    CHECK(faults.sliding_may_help());
    std::vector<char> vertices(ring.nodes(), 0);
    for (const InfeasibleElement& fault : faults.elements) {
        CHECK(!fault.by_curvature);
        CHECK(fault.division_helps);
        for (int k = 0; k < 3; ++k) vertices[ring.element(fault.element)[k]] = 1;
    }
    free_nodes(ring, nodes_to_free(ring, target, faults), target);
    CHECK(freed_nodes(ring, target) == vertices);
    CHECK(find_infeasible(ring, straight_sided(ring), target).none());
}

TEST_CASE("elements between two faces of prescribed boundaries: sliding does not help, unless one of them is free") {
    const Mesh cube = cube_mesh(1);
    for (const std::string sides : {"expression \"x\" \"y\" \"-z\"", "free"}) {
        CAPTURE(sides);
        BoundaryTarget target = target_of(cube, {{"top", "translate 0 0 -2"}, {"sides", sides}});
        prescribe_shared_nodes(cube, target);
        const Infeasible faults = find_infeasible(cube, straight_sided(cube), target);
        REQUIRE(!faults.elements.empty());
        for (const InfeasibleElement& fault : faults.elements) {
            CHECK(fault.sliding_may_help == (sides == "free"));
            CHECK(fault.division_helps);
        }
    }
}

TEST_CASE("a quadrilateral whose corner is nearly straight in the ideal mesh already is at fault where it gets worse") {
    Mesh mesh = quad_mesh(1);
    const int corner = node_at(mesh, {1, 1, 0});
    for (int a = 0; a < 2; ++a) point(mesh.x, corner, 2)[a] = 0.5005;
    const auto faults = [&](double toward) {
        BoundaryTarget target = target_of(mesh, {});
        for (std::size_t k = 0; k < mesh.faces.size(); ++k)
            for (int a = 0; a < 2 && mesh.faces[k] == corner; ++a) target.node[2 * k + a] -= toward;
        return find_infeasible(mesh, mesh.x, target, 0.01).elements;
    };
    CHECK(faults(0).empty());
    CHECK(faults(0.0001).empty());
    REQUIRE(faults(0.0004).size() == 1);  // a fifth of what it was
    CHECK(faults(0.0004)[0].scaled_determinant == doctest::Approx(0.0004).epsilon(0.01));
    CHECK(faults(0.001).size() == 1);
}
