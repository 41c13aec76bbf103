#include "check/boundary_distance.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "constraint/sliding.hpp"
#include "mesh/build.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"
#include "support/solids.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr double pi = std::numbers::pi;
constexpr int around = 12;
constexpr double radius = 3;

// A ring with all nodes on circles: those between its vertices are moved outward, from chords to their arcs.
Mesh round_ring(int degree) {
    Mesh mesh = with_degree(ring_mesh(around, 2, radius), degree);
    mesh.x = mapped(mesh, [](double* p) {
        const double half = pi / around, angle = std::atan2(p[1], p[0]);
        const double stretch = std::cos(std::remainder(angle - half, 2 * half)) / std::cos(half);
        p[0] *= stretch, p[1] *= stretch;
    });
    return mesh;
}

SlidingSurfaces surfaces_of(const Mesh& mesh, const BoundaryTarget& target, const Frame& frame = {}) {
    return {mesh, target.node, std::vector<char>(mesh.boundaries.size(), 1), 30, frame};
}

std::vector<char> only(const Mesh& mesh, const std::string& boundary) { return mesh.boundaries_in(boundary); }

// The nodes of one boundary changed by `map`, all others as they are.
std::vector<double> with_moved(const Mesh& mesh, const std::string& boundary,
                               const std::function<void(double*)>& map) {
    std::vector<double> x = mesh.x;
    std::vector<char> done(mesh.nodes(), 0);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int i = mesh.faces[k];
        if (mesh.boundaries[mesh.face_boundary[f]] == boundary && !done[i]) map(point(x, i, mesh.dim)), done[i] = 1;
    });
    return x;
}

// A unit cube of k^3 cells bent to a quarter of a shell of radii 1 and 2; the boundary bottom is the inner cylinder.
Mesh quarter_shell(int k, int degree) {
    Mesh mesh = with_degree(cube_mesh(k), degree);
    mesh.x = mapped(mesh, [](double* p) {
        const double angle = 0.5 * pi * p[0], r = 1 + p[2], y = p[1];
        p[0] = r * std::cos(angle), p[1] = r * std::sin(angle), p[2] = y;
    });
    return mesh;
}

}  // namespace

TEST_CASE("a boundary moved by a linear offset: largest and RMS distance exactly, of faces of all types and degrees") {
    const double a = 0.1, b = 0.3;
    const auto down = [&](double* p) { p[2] -= a + b * p[0]; };
    const double rms = std::sqrt(a * a + a * b + b * b / 3);
    std::vector<Mesh> linear = {cube_mesh(2), solid_mesh(2, "h"), solid_mesh(2, "p")};
    for (const Mesh& coarse : linear)
        for (const int degree : {1, 2, 3, 4, 7}) {
            const Mesh mesh = raise_degree(coarse, degree);
            CAPTURE(mesh.elements_text());
            CAPTURE(degree);
            const auto rows = boundary_distances(mesh, mesh.x, with_moved(mesh, "bottom", down), only(mesh, "bottom"));
            REQUIRE(rows.size() == 1);
            const bool quads = mesh.face_cell(face_near(mesh, rows[0].boundary, {0.5, 0.5, 0})).vertices == 4;
            const double edge = quads ? 0.5 : std::sqrt(0.5);
            CHECK(mesh.boundaries[rows[0].boundary] == "bottom");
            CHECK(rows[0].faces == (quads ? 4 : 8));
            CHECK(rows[0].moved == rows[0].faces);
            CHECK(rows[0].moved_area == doctest::Approx(1));
            CHECK(rows[0].largest == doctest::Approx(a + b).epsilon(1e-12));
            CHECK(rows[0].rms == doctest::Approx(rms).epsilon(1e-12));
            CHECK(rows[0].relative_largest == doctest::Approx((a + b) / edge).epsilon(1e-12));
            CHECK(rows[0].relative_rms == doctest::Approx(rms / edge).epsilon(1e-12));
        }
}

TEST_CASE("in the plane: one arc made straight is off by its sagitta, and the others take no part") {
    const double half = pi / around;
    const Mesh mesh = round_ring(2);
    const int f = face_near(mesh, mesh.boundary_index("outer"), {radius, 0, 0});
    const int* const node = mesh.face(f);
    std::vector<double> x = mesh.x;
    for (int k = 0; k < 2; ++k) point(x, node[2], 2)[k] = 0.5 * (point(x, node[0], 2)[k] + point(x, node[1], 2)[k]);
    const auto rows = boundary_distances(mesh, mesh.x, x);
    REQUIRE(rows.size() == 1);
    const double sagitta = radius * (1 - std::cos(half)), chord = 2 * radius * std::sin(half);
    CHECK(mesh.boundaries[rows[0].boundary] == "outer");
    CHECK(rows[0].faces == around);
    CHECK(rows[0].moved == 1);
    CHECK(rows[0].moved_area == doctest::Approx(chord / (chord + (around - 1) * 2 * half * radius)).epsilon(1e-3));
    CHECK(rows[0].largest == doctest::Approx(sagitta).epsilon(1e-12));
    CHECK(rows[0].relative_largest == doctest::Approx(sagitta / chord).epsilon(1e-12));
    // Of a parabola from its chord, to the second order of the angle; the other arcs count with 0.
    CHECK(rows[0].rms == doctest::Approx(sagitta * std::sqrt(8.0 / 15 * rows[0].moved_area)).epsilon(2e-2));
}

TEST_CASE("an octant of a sphere made flat: the distance of its middle is the largest") {
    for (const int degree : {2, 7}) {
        Mesh mesh = linear_mesh(3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 1, 2, 3}, [](const double* p) {
            return p[0] * p[1] * p[2] > 0 ? "sphere" : "sides";
        });
        mesh = with_degree(mesh, degree);
        const auto onto_sphere = [](double* p) {
            const double r = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            for (int k = 0; k < 3; ++k) p[k] /= r;
        };
        const std::vector<double> curved = with_moved(mesh, "sphere", onto_sphere);
        const auto rows = boundary_distances(mesh, curved, mesh.x, only(mesh, "sphere"));
        REQUIRE(rows.size() == 1);
        // In the middle of a triangle of degree 2 a vertex counts -1/9, the middle of an edge 4/9.
        const double middle = degree == 2 ? std::sqrt(3) * (4 * std::sqrt(2) - 1) / 9 : 1;
        const double largest = middle - 1 / std::sqrt(3);
        CHECK(rows[0].largest == doctest::Approx(largest).epsilon(degree == 2 ? 1e-12 : 1e-3));
        CHECK(rows[0].relative_largest == doctest::Approx(rows[0].largest / std::sqrt(2)));
        CHECK(rows[0].rms < rows[0].largest);
        CHECK(rows[0].rms > 0.5 * rows[0].largest);
    }
}

TEST_CASE("a cylinder made of flat faces is off by the sagitta of an element") {
    const int k = 4;
    const double sagitta = 1 - std::cos(0.25 * pi / k), chord = 2 * std::sin(0.25 * pi / k);
    const Mesh mesh = quarter_shell(k, 2);
    const auto rows = boundary_distances(mesh, mesh.x, straight_sided(mesh), only(mesh, "bottom"));
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].moved == 2 * k * k);
    CHECK(rows[0].moved_area == doctest::Approx(1));
    CHECK(rows[0].largest == doctest::Approx(sagitta).epsilon(1e-12));
    CHECK(rows[0].relative_largest == doctest::Approx(sagitta / std::hypot(chord, 1.0 / k)).epsilon(1e-12));
    CHECK(rows[0].rms == doctest::Approx(std::sqrt(8.0 / 15) * sagitta).epsilon(2e-2));
}

TEST_CASE("nodes that slid along the surface have not left it; what is off by little is found") {
    for (const int degree : {1, 2, 3}) {
        const Mesh mesh = with_degree(cube_mesh(3), degree);
        const auto along = [](double* p) {
            const double x = p[0], y = p[1];
            p[0] += 0.08 * std::sin(pi * x) * std::cos(2 * y), p[1] += 0.08 * std::sin(pi * y) * std::sin(3 * x);
        };
        std::vector<double> x = with_moved(mesh, "bottom", along);
        CHECK(boundary_distances(mesh, mesh.x, x).empty());
        const int f = face_near(mesh, mesh.boundary_index("bottom"), {0.5, 0.5, 0});
        point(x, mesh.face(f)[0], 3)[2] -= 1e-9;
        const auto rows = boundary_distances(mesh, mesh.x, x);
        REQUIRE(rows.size() == 1);
        CHECK(rows[0].largest == doctest::Approx(1e-9).epsilon(1e-3));
        CHECK(rows[0].moved == 6);
    }
    // A cylinder of degree 1 is a prism: around its axis by half an element, vertices are off by the sagitta.
    const Mesh ring = ring_mesh(around, 1, 2);
    const double c = std::cos(pi / around), s = std::sin(pi / around);
    const auto turned = with_moved(ring, "inner", [&](double* p) {
        const double x = p[0], y = p[1];
        p[0] = c * x - s * y, p[1] = s * x + c * y;
    });
    const auto rows = boundary_distances(ring, ring.x, turned);
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].largest == doctest::Approx(1 - c).epsilon(1e-12));
}

TEST_CASE("far from the origin the rounding of positions is no distance") {
    Mesh mesh = with_degree(cube_mesh(2), 2);
    for (double& v : mesh.x) v += 1e6;
    std::vector<double> x = with_moved(mesh, "bottom", [](double* p) { p[2] = std::nextafter(p[2], 2e6); });
    CHECK(boundary_distances(mesh, mesh.x, x).empty());
    x = with_moved(mesh, "bottom", [](double* p) { p[2] -= 1e-6; });
    CHECK(boundary_distances(mesh, mesh.x, x).size() > 0);
}

TEST_CASE("the distance of a boundary has the same bits on any number of threads, and no face moves without a reason") {
    const Mesh mesh = quarter_shell(6, 3);
    CHECK(boundary_distances(mesh, mesh.x, mesh.x).empty());
    const std::vector<double> x = wavy(mesh.x, 3, 0.03);
    const auto numbers = [&] {
        std::vector<double> all;
        for (const BoundaryDistance& of : boundary_distances(mesh, mesh.x, x))
            for (const double value :
                 {of.largest, of.rms, of.relative_largest, of.relative_rms, of.moved_area, 1.0 * of.moved})
                all.push_back(value);
        return all;
    };
    const auto results = for_threads(numbers);
    CHECK(results[0].size() == 6 * mesh.boundaries.size());
    for (const auto& result : results) CHECK(result == results[0]);
}

TEST_CASE("the table has a row for each boundary and its columns are below their names") {
    Mesh mesh = with_degree(cube_mesh(2), 1);
    mesh.boundaries[0] = "a rather long name";
    CHECK(distance_table(mesh, {}, "it").empty());
    const std::string text =
        distance_table(mesh, {{0, 8, 2, 0.125, 0.25, 0.125, 0.5, 0.25}, {1, 8, 8, 1, 2, 1, 4, 2}}, "it");
    const std::vector<std::string> lines = pieces(text, '\n');
    REQUIRE(lines.size() == 4);
    CHECK(has(lines[0], "distance of the faces from it"));
    CHECK(lines[2].starts_with("a rather long name"));
    CHECK(has(lines[2], " 12.5 %"));
    for (std::size_t k = 2; k < 4; ++k) CHECK(lines[k].size() == lines[1].size());
}

TEST_CASE("the distance of a polygon from its circle is the sagitta, in any unit") {
    Mesh mesh = ring_mesh(around, 2, radius);
    const double sagitta = radius * (1 - std::cos(pi / around));
    BoundaryTarget target = target_of(mesh, {{"inner", "slide"}, {"outer", "slide"}});
    CHECK(distance_from_surfaces(mesh, target, surfaces_of(mesh, target), mesh.x) == doctest::Approx(sagitta));
    const SlidingSurfaces in_units = surfaces_of(mesh, target, {.origin = {}, .length = 10});
    for (double& v : mesh.x) v /= 10;
    CHECK(distance_from_surfaces(mesh, target, in_units, mesh.x) == doctest::Approx(sagitta / 10));
}

TEST_CASE("faces of a polygon are curved where its sagitta is above the tolerance, in units of the edge") {
    const Mesh mesh = ring_mesh(around, 2, radius);
    const BoundaryTarget target = target_of(mesh, {{"inner", "slide"}, {"outer", "fixed"}});
    const double relative = 0.5 * std::tan(0.5 * pi / around);  // 1 - cos a over 2 sin a
    for (const double factor : {0.99, 1.01}) {
        const auto curved = curved_faces(mesh, target, surfaces_of(mesh, target), mesh.x, factor * relative);
        for (int f = 0; f < mesh.face_count(); ++f)
            CHECK(curved[f] == (factor < 1 && mesh.boundaries[mesh.face_boundary[f]] == "inner"));
    }
}

TEST_CASE("relative distances are measured both ways: a side that became shorter is where it was, but not all of it") {
    const Mesh mesh = square_mesh(2);
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (mesh.x[2 * i] == 1 && mesh.x[2 * i + 1] == 1) x[2 * i + 1] = 0.9;
    const int right = mesh.boundary_index("right"), top = mesh.boundary_index("top");
    for (const BoundaryDistance& of : boundary_distances(mesh, mesh.x, x)) CHECK(of.boundary == top);
    const std::vector<double> relative = relative_face_distances(mesh, mesh.x, x);
    CHECK(relative[face_near(mesh, right, {1, 0.75, 0})] == doctest::Approx(0.1 / 0.4));
    CHECK(relative[face_near(mesh, right, {1, 0.25, 0})] == 0);
    CHECK(relative[face_near(mesh, top, {0.75, 1, 0})] == doctest::Approx(0.1 / 0.5));
    CHECK(relative[face_near(mesh, top, {0.25, 1, 0})] == 0);
    for (const double d : relative_face_distances(mesh, mesh.x, x, only(mesh, "left"))) CHECK(d == 0);
}

TEST_CASE("of faces that slide or have a node that is released: not of others that are free or prescribed") {
    const Mesh mesh = ring_mesh(around, 2, radius);
    const double unit_sagitta = 1 - std::cos(pi / around);
    BoundaryTarget target = target_of(mesh, {{"inner", "slide"}, {"outer", "free"}});
    const SlidingSurfaces sliding = surfaces_of(mesh, target);
    CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) == doctest::Approx(unit_sagitta));
    target = target_of(mesh, {});
    CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) == 0);
    std::vector<char> freed(mesh.nodes(), 0);
    freed[2 * around] = 1;  // on the outer circle
    free_nodes(mesh, freed, target);
    CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) == doctest::Approx(radius * unit_sagitta));
}

TEST_CASE("the distance of curved faces falls with their degree, and that of one which leaves its circle is found") {
    std::vector<double> distances = {1, 1};
    for (int degree = 1; degree <= 6; ++degree) {
        Mesh mesh = round_ring(degree);
        const BoundaryTarget target = target_of(mesh, {{"inner", "slide"}, {"outer", "slide"}});
        const SlidingSurfaces sliding = surfaces_of(mesh, target);
        REQUIRE(sliding.parts() == 2);
        distances.push_back(distance_from_surfaces(mesh, target, sliding, mesh.x));
        CHECK(distances[degree + 1] < (degree > 2 ? 0.05 : 0.2) * distances[degree - 1]);
        if (degree != 5) continue;
        double* const node = point(mesh.x, mesh.face(0)[3], 2);  // within an edge
        node[0] *= 1.01, node[1] *= 1.01;
        CHECK(distance_from_surfaces(mesh, target, sliding, mesh.x) >= 0.01 * std::hypot(node[0], node[1]) / 1.02);
    }
    CHECK(distances.back() < 1e-7);
}

TEST_CASE("nodes that gave way are those of fixed boundaries, and freed ones, that are not at their motion") {
    const Mesh mesh = ring_mesh(around, 2, radius);
    BoundaryTarget target = target_of(mesh, {{"inner", "translate 1 0"}, {"outer", "fixed"}});
    std::vector<double> x = at_target(mesh, target, mesh.x);
    CHECK(off_motion(mesh, target, nullptr, target.node, x).nodes == 0);
    const int inner = mesh.face(face_near(mesh, mesh.boundary_index("inner"), {1, 0, 0}))[0],
              outer = mesh.face(face_near(mesh, mesh.boundary_index("outer"), {radius, 0, 0}))[0];
    point(x, inner, 2)[0] += 0.25;
    point(x, outer, 2)[0] += 0.3;
    point(x, outer, 2)[1] -= 0.4;
    const OffMotion off = off_motion(mesh, target, nullptr, target.node, x);
    CHECK(off.nodes == 2);
    CHECK(off.largest == doctest::Approx(0.5));
    CHECK(off.moved.empty());  // off their targets, but these did not change
    std::vector<double> now = target.node;
    for (std::size_t k = 0; k < mesh.faces.size(); ++k) std::copy_n(point(x, mesh.faces[k], 2), 2, &now[2 * k]);
    const std::vector<MovedNode> moved = off_motion(mesh, target, nullptr, now, x).moved;
    REQUIRE(moved.size() == 1);  // the other one is off its motion, but not freed
    CHECK(moved[0].node == outer);
    CHECK(moved[0].boundary == mesh.boundary_index("outer"));
    CHECK(moved[0].distance == doctest::Approx(0.5));
    CHECK(moved_nodes_csv(mesh, moved) == concat("node,boundary,distance,along\n", mesh.file.node_id[outer], ",outer,",
                                                 moved[0].distance, ",\n"));
}
