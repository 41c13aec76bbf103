#include "check/target_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/high_order.hpp"
#include "mesh/lagrange.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

TargetReport check(const Mesh& mesh, const std::vector<double>& x) { return check_target(mesh, x); }

bool mentions(const TargetReport& report, const std::string& text) {
    return std::any_of(report.faults.begin(), report.faults.end(),
                       [&](const TargetReport::Fault& fault) { return fault.why.find(text) != std::string::npos; });
}

int node_at(const Mesh& mesh, std::vector<double> p) {
    for (int i = 0; i < mesh.nodes(); ++i) {
        double distance = 0;
        for (int a = 0; a < mesh.dim; ++a) distance += std::abs(mesh.x[i * mesh.dim + a] - p[a]);
        if (distance < 1e-12) return i;
    }
    return -1;
}

// The mesh with one node moved from p to q.
std::vector<double> with_moved(const Mesh& mesh, const std::vector<double>& p, const std::vector<double>& q) {
    std::vector<double> x = mesh.x;
    const int node = node_at(mesh, p);
    REQUIRE(node >= 0);
    std::copy(q.begin(), q.end(), x.begin() + node * mesh.dim);
    return x;
}

}  // namespace

TEST_CASE("motions that keep the boundary are accepted") {
    for (int degree : {1, 2, 4})
        for (const Mesh& linear : {square_mesh(3), ring_mesh(12, 2, 21), cube_mesh(2)}) {
            const Mesh mesh = with_degree(linear, degree);
            const auto quarter = [](double* p) {
                const double x = p[0];
                p[0] = 3 - p[1];
                p[1] = x - 7;
            };
            const auto shrink = [&](double* p) {
                for (int a = 0; a < mesh.dim; ++a) p[a] = 100 + 1e-3 * p[a];
            };
            const std::vector<double> waves = wavy(mesh.x, mesh.dim, mesh.dim == 2 ? 0.05 : 0.02);
            for (const std::vector<double>& x : {mesh.x, mapped(mesh, quarter), mapped(mesh, shrink), waves}) {
                const TargetReport report = check(mesh, x);
                for (const auto& fault : report.faults) MESSAGE(fault.why);
                CHECK(report.faults.empty());
                CHECK(report.crossed_before[0] < 0);
            }
        }
}

TEST_CASE("faces that span arcs of up to 150 degrees are accepted") {
    const double degree_of_arc = std::acos(-1.0) / 180;
    for (int degree = 2; degree <= 7; ++degree) {
        // A triangle with corners at the angles 0, 150 and 300; the edges become the arcs between them.
        std::vector<double> x;
        for (double angle : {0.0, 150.0, 300.0})
            x.insert(x.end(), {std::cos(angle * degree_of_arc), std::sin(angle * degree_of_arc)});
        const Mesh mesh = with_degree(linear_mesh(2, x, {0, 1, 2}, [](const double*) { return "circle"; }), degree);
        std::vector<double> target = mesh.x;
        const std::vector<MultiIndex> order = gmsh_node_order(1, degree);
        for (int f = 0; f < mesh.face_count(); ++f) {
            const double from = 150 * mesh.face(f)[0], span = mesh.face(f)[0] == 2 ? 60 : 150;
            for (int i = 0; i < mesh.face_nodes(0); ++i) {
                const double angle = (from + span * order[i][1] / degree) * degree_of_arc;
                target[2 * mesh.face(f)[i]] = std::cos(angle);
                target[2 * mesh.face(f)[i] + 1] = std::sin(angle);
            }
        }
        CHECK(check_target(mesh, target).faults.empty());
    }
}

TEST_CASE("the thin side faces and nearly touching walls of a boundary layer are accepted") {
    const Mesh mesh = with_degree(square_mesh(3), 4);
    const std::vector<double> x = mapped(mesh, [](double* p) {
        const double r = 1 + 1e-5 * p[1], angle = -1.5 * p[0];
        p[0] = 20 + r * std::cos(angle);
        p[1] = r * std::sin(angle);
    });
    const TargetReport mirrored = check(mesh, mapped(mesh, [](double* p) { p[0] = -p[0]; }));
    CHECK(mirrored.faults.size() == 1);
    for (const auto& fault : check(mesh, x).faults) MESSAGE(fault.why);
    CHECK(check(mesh, x).faults.empty());
}

TEST_CASE("folded faces are found: nodes in the wrong order, or a tangent that vanishes") {
    const Mesh cubic = with_degree(square_mesh(1), 3), quadratic = with_degree(square_mesh(1), 2);
    std::vector<double> swapped = cubic.x;
    std::swap(swapped[2 * node_at(cubic, {1.0 / 3, 0})], swapped[2 * node_at(cubic, {2.0 / 3, 0})]);
    const TargetReport report = check(cubic, swapped);
    REQUIRE(report.faults.size() == 1);
    CHECK(report.faults[0].why.find("of bottom at (0.5, 0): the target folds the face back") != std::string::npos);
    CHECK(cubic.boundaries[cubic.face_boundary[report.faults[0].face]] == "bottom");
    CHECK(check(quadratic, with_moved(quadratic, {0.5, 0}, {0.25, 0})).faults.size() == 1);
    CHECK(check(quadratic, with_moved(quadratic, {0.5, 0}, {0.251, 0})).faults.empty());
    // In 3D the middle of an edge of the bottom's diagonal, moved over the far corner.
    const Mesh cube = with_degree(cube_mesh(1), 2);
    CHECK(mentions(check(cube, with_moved(cube, {0.5, 0.5, 0}, {1.2, -0.2, 0})), "folds the face back"));
    CHECK(check(cube, with_moved(cube, {0.5, 0.5, 0}, {0.5, 0.5, -0.3})).faults.empty());
}

TEST_CASE("collapsed faces and nodes that fall together are found") {
    const Mesh square = square_mesh(2);
    CHECK(mentions(check(square, with_moved(square, {0.5, 0}, {0, 0})), "collapses the face"));
    CHECK(mentions(check(square, with_moved(square, {0.5, 0}, {0.5, 1})), " is, at (0.5, 1)"));
    const Mesh cube = cube_mesh(2);
    CHECK(mentions(check(cube, with_moved(cube, {0.5, 0.5, 0}, {0, 0, 0})), "collapses the face"));
    CHECK(mentions(check(cube, with_moved(cube, {0.5, 0.5, 0}, {0.5, 0.5, 1})), " is, at (0.5, 0.5, 1)"));
}

TEST_CASE("mirrored, inside-out and flattened boundaries are found") {
    for (int degree : {1, 3}) {
        const Mesh ring = with_degree(ring_mesh(12, 2, 5), degree), cube = with_degree(cube_mesh(2), degree);
        const auto inner_only = [](double* p) {
            if (std::hypot(p[0], p[1]) < 1.01) p[0] = -p[0];
        };
        const TargetReport inner = check(ring, mapped(ring, inner_only));
        REQUIRE(inner.faults.size() == 1);
        CHECK(mentions(inner, "mirrors or turns inside out the closed boundary made of inner (signed area -"));
        CHECK(check(ring, mapped(ring, [](double* p) { p[1] = -p[1]; })).faults.size() == 2);
        const TargetReport solid = check(cube, mapped(cube, [](double* p) { p[2] = 4 - p[2]; }));
        REQUIRE(solid.faults.size() == 1);
        CHECK(mentions(solid, "signed volume 1 becomes -1"));
        CHECK(mentions(check(cube, mapped(cube, [](double* p) { p[2] = 0.5 * p[0]; })), "flattens"));
        CHECK(mentions(check(ring, mapped(ring, [](double* p) { p[1] = 0.5 * p[0]; })), "flattens"));
    }
}

TEST_CASE("a boundary that crosses itself is found") {
    const Mesh square = square_mesh(4);
    CHECK(mentions(check(square, with_moved(square, {0.5, 0}, {0.55, 1.3})), "crosses face"));
    CHECK(check(square, with_moved(square, {0.5, 0}, {0.55, 0.99})).faults.empty());
    const Mesh cube = cube_mesh(2);
    CHECK(mentions(check(cube, with_moved(cube, {0.5, 0.5, 0}, {0.55, 0.45, 1.3})), "crosses face"));
    CHECK(check(cube, with_moved(cube, {0.5, 0.5, 0}, {0.55, 0.45, 0.99})).faults.empty());
    // Only the curved middle of a face crosses; all vertices stay.
    const Mesh curved = with_degree(square_mesh(1), 4);
    const auto bulge = [&](double height) {
        return mapped(curved, [&](double* p) {
            if (p[1] == 0) p[1] = height * p[0] * (1 - p[0]);
        });
    };
    CHECK(check(curved, bulge(3.9)).faults.empty());
    CHECK(mentions(check(curved, bulge(4.1)), "crosses face"));
}

TEST_CASE("neighbours folded flat onto each other are found") {
    const Mesh square = square_mesh(2);
    CHECK(mentions(check(square, with_moved(square, {0.5, 0}, {1.25, 0})), "folds it flat onto face"));
    const Mesh cube = cube_mesh(2);
    CHECK(mentions(check(cube, with_moved(cube, {0.5, 0.5, 0}, {1.2, 0.4, 0})), "folds it flat onto face"));
}

TEST_CASE("a body moved through the outer boundary, or past it, is found; one that comes near it is not") {
    for (const int degree : {1, 2}) {
        const Mesh ring = with_degree(ring_mesh(16, 3, 21), degree);
        const auto moved_by = [&](double distance) {
            return check(ring, mapped(ring, [distance](double* p) {
                if (std::hypot(p[0], p[1]) < 1.01) p[0] += distance;
            }));
        };
        CHECK(moved_by(19.5).faults.empty());
        const TargetReport through = moved_by(20.5), past = moved_by(40);
        REQUIRE(through.faults.size() == 1);
        CHECK(mentions(through, "crosses face"));
        CHECK(mentions(through, "inner goes through the one made of"));
        REQUIRE(past.faults.size() == 1);
        CHECK(mentions(past, "the target takes the closed boundary made of inner through the one made of outer"));
    }
    Mesh shell = cube_mesh(3);  // without its middle cell: an inner cube
    std::vector<int> elements;
    for (int e = 0; e < shell.element_count(); ++e) {
        const auto c = centroid(shell, shell.x, shell.element(e), 4);
        const bool inside = std::max({std::abs(c[0] - 0.5), std::abs(c[1] - 0.5), std::abs(c[2] - 0.5)}) < 1.0 / 6;
        if (!inside) elements.insert(elements.end(), shell.element(e), shell.element(e) + 4);
    }
    const Mesh hollow = linear_mesh(3, shell.x, elements, [](const double* c) {
        return std::max({std::abs(c[0] - 0.5), std::abs(c[1] - 0.5), std::abs(c[2] - 0.5)}) < 0.2 ? "hole" : "outside";
    });
    const auto moved_by = [&](double distance) {
        return check(hollow, mapped(hollow, [distance](double* p) {
            if (std::max({std::abs(p[0] - 0.5), std::abs(p[1] - 0.5), std::abs(p[2] - 0.5)}) < 0.2) p[0] += distance;
        }));
    };
    CHECK(moved_by(0.3).faults.empty());
    CHECK(mentions(moved_by(0.4), "through the one made of outside"));  // along edges of the faces: no crossing there
    CHECK(mentions(moved_by(2), "through the one made of outside"));
}

// A square's corners turned until they are outside the outer square, but inside the circle that this becomes.
TEST_CASE("a corner between the faces of a curved boundary and their chords is inside or outside the curved ones") {
    const Mesh ring = with_degree(ring_mesh(4, 1, 1.25), 4);
    const auto curved_to = [&](double radius, double turn) {
        std::vector<double> x = ring.x;
        for (std::size_t k = 0; k < ring.faces.size(); ++k) {
            const double* const from = &ring.x[2 * ring.faces[k]];
            double* const to = &x[2 * ring.faces[k]];
            const double* const vertex = &ring.x[2 * ring.face(static_cast<int>(k) / ring.face_nodes(0))[0]];
            const bool is_outer = std::hypot(vertex[0], vertex[1]) > 1.1;
            const double angle = std::atan2(from[1], from[0]) + (is_outer ? 0 : turn);
            const double r = is_outer ? radius : std::hypot(from[0], from[1]);
            to[0] = r * std::cos(angle);
            to[1] = r * std::sin(angle);
        }
        return x;
    };
    CHECK(check(ring, curved_to(1.25, 0)).faults.empty());
    CHECK(check(ring, curved_to(1.25, std::numbers::pi / 4)).faults.empty());
}

TEST_CASE("the report is the same for any number of threads") {
    const Mesh mesh = ring_mesh(2000, 1, 3);
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (i % 5 == 0) x[2 * i] = -x[2 * i];  // crossings, and more
    const auto reports = for_threads([&] { return check(mesh, x); });
    CHECK(reports[0].faults.size() > 100);
    for (const TargetReport& report : reports) {
        REQUIRE(report.faults.size() == reports[0].faults.size());
        for (std::size_t k = 0; k < report.faults.size(); ++k) CHECK(report.faults[k].why == reports[0].faults[k].why);
        CHECK(report.crossed_before == reports[0].crossed_before);
    }
}

TEST_CASE("the two sides of a crack in the initial mesh are not a fault") {
    // Three by three nodes; the left middle node exists twice, once for the cells below it and once for those above.
    std::vector<double> x;
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) x.insert(x.end(), {0.5 * i, 0.5 * j});
    x.insert(x.end(), {0, 0.5});
    const std::vector<int> elements = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 9, 4, 7, 9, 7, 6, 4, 5, 8, 4, 8, 7};
    for (int degree : {1, 2}) {
        const Mesh mesh = with_degree(linear_mesh(2, x, elements, [](const double*) { return "rim"; }), degree);
        REQUIRE(mesh.face_count() == 10);
        CHECK(check(mesh, mesh.x).faults.empty());
        std::vector<double> open = mesh.x;
        open[2 * 9 + 1] += 0.1;
        CHECK(check(mesh, open).faults.empty());
    }
}
