// The surface of a mesh that is improved stays within surface_tolerance of the file's, measured here by points on all
// edges; so do surfaces between regions, named points, and the volumes of the regions.
#include "problem/kept_surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/patch.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A ring whose nodes on both circles are at uneven distances from each other.
Mesh uneven_ring() {
    Mesh mesh = ring_mesh(24, 4, 3);
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, 2);
        const double r = std::hypot(x[0], x[1]), even = std::atan2(x[1], x[0]);
        const double angle = even + 0.1 * std::sin(5 * even);
        x[0] = r * std::cos(angle), x[1] = r * std::sin(angle);
    }
    return mesh;
}

// Of points of the edges of x from the edges of y, in units of the edge.
double farthest(const Mesh& mesh, const std::vector<double>& x, const std::vector<double>& y) {
    constexpr int points = 40;
    double largest = 0;
    for (int f = 0; f < mesh.face_count(); ++f) {
        const auto edge = positions(mesh, x, mesh.face(f), 2);
        for (int k = 0; k <= points; ++k) {
            const Vec<3> at = edge[0] + static_cast<double>(k) / points * (edge[1] - edge[0]);
            double nearest = 1e300;
            for (int g = 0; g < mesh.face_count(); ++g) {
                const auto other = positions(mesh, y, mesh.face(g), 2);
                const Vec<3> along = other[1] - other[0];
                const double t = std::clamp(dot(at - other[0], along) / dot(along, along), 0.0, 1.0);
                nearest = std::min(nearest, length(at - other[0] - t * along));
            }
            largest = std::max(largest, nearest / length(edge[1] - edge[0]));
        }
    }
    return largest;
}

Outcome improved(const TemporaryFolder& folder, const std::string& text, std::vector<std::string> settings = {}) {
    const std::string file = folder.write("mesh.msh", text);
    settings.insert(settings.begin(), {"improve", file, "output=" + folder.path("results"), "threads=1"});
    return almesh_with(settings);
}

std::vector<double> positions_after(const TemporaryFolder& folder) {
    return mesh_of(folder.path("results/final.msh")).x;
}

}  // namespace

TEST_CASE("nodes of a round body with straight edges stay to the last bit, or slide as far as surface_tolerance allows") {
    const Mesh mesh = uneven_ring();
    for (const double tolerance : {1e-3, 0.045, 0.3}) {
        const TemporaryFolder folder;
        CAPTURE(tolerance);
        const Outcome outcome = improved(folder, msh_of(mesh), {"surface_tolerance=" + to_text(tolerance)});
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, " of an edge, within surface_tolerance = "));
        const std::vector<double> x = positions_after(folder);
        const double distance = std::max(farthest(mesh, x, mesh.x), farthest(mesh, mesh.x, x));
        CHECK(distance <= tolerance);
        CHECK((distance > 1e-12) == (tolerance > 1e-3));
        CHECK(has(outcome.out, "48 boundary nodes stay: ") == (tolerance == 1e-3));
        for (const int i : mesh.faces)
            for (int a = 0; a < 2 && tolerance == 1e-3; ++a) CHECK(x[2 * i + a] == mesh.x[2 * i + a]);
    }
}

TEST_CASE("a surface between two regions stays, whether it has faces in the file or not, and so do their volumes") {
    Mesh mesh = square_mesh(6);
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, 2);
        const double wave = 0.07 * std::sin(7 * x[0] + 11 * x[1]) * x[0] * (1 - x[0]) * x[1] * (1 - x[1]) * 16;
        x[1] += wave;
        if (x[0] != 0.5) x[0] += wave;
    }
    mesh.file.groups = {{2, 1, "left half"}, {2, 2, "right half"}};
    for (int e = 0; e < mesh.element_count(); ++e)
        mesh.file.element_physical[e] = element_centre(mesh, mesh.x, e)[0] < 0.5 ? 1 : 2;
    const TemporaryFolder folder;
    const Outcome outcome = improved(folder, msh_of(mesh));
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "note: boundary nodes slide along: straight line (5 parts)"));
    const std::vector<double> x = positions_after(folder);
    bool has_slid = false;
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (mesh.x[2 * i] != 0.5) continue;
        CHECK(std::abs(x[2 * i] - 0.5) < 1e-14);
        has_slid = has_slid || x[2 * i + 1] != mesh.x[2 * i + 1];
    }
    CHECK(has_slid);
    const std::string change = "; change of area: left half ";
    REQUIRE(has(outcome.out, change));
    CHECK(std::abs(std::stod(outcome.out.substr(outcome.out.find(change) + change.size()))) < 1e-13);
    // A line for it makes it free.
    CHECK(improved(folder, msh_of(mesh), {"boundary \"between left half and right half\"=free"}).code == 0);
    const std::vector<double> y = positions_after(folder);
    bool has_left = false;
    for (int i = 0; i < mesh.nodes(); ++i)
        has_left = has_left || (mesh.x[2 * i] == 0.5 && std::abs(y[2 * i] - 0.5) > 1e-4);
    CHECK(has_left);
}

TEST_CASE("a named point on a straight side stays, and the nodes beside it slide") {
    Mesh mesh = square_mesh(4);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (double* const x = point(mesh.x, i, 2); x[1] == 0 && x[0] > 0 && x[0] < 1) x[0] += 0.06;
    int fixed = 0;
    while (mesh.x[2 * fixed] != 0.56 || mesh.x[2 * fixed + 1] != 0) ++fixed;
    std::string text = msh_of(mesh);
    const std::string head = "$Elements\n", count = std::to_string(mesh.element_count() + mesh.face_count());
    REQUIRE(has(text, head + count));
    text.replace(text.find(head), head.size() + count.size(),
                 head + std::to_string(mesh.element_count() + mesh.face_count() + 1) + "\n999 15 2 9 9 " +
                     std::to_string(mesh.file.node_id[fixed]));
    const TemporaryFolder folder;
    const Outcome outcome = improved(folder, text);
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "; 1 boundary node stays, being on named points or curves"));
    const std::vector<double> x = positions_after(folder);
    CHECK(x[2 * fixed] == 0.56);
    bool has_slid = false;
    for (int i = 0; i < mesh.nodes(); ++i)
        has_slid = has_slid || (mesh.x[2 * i + 1] == 0 && std::abs(x[2 * i] - mesh.x[2 * i]) > 1e-3);
    CHECK(has_slid);
}

TEST_CASE("where no valid mesh was found with the file's boundary it is left, and that fails if a tolerance is given") {
    Mesh mesh = ring_mesh(16, 3, 6);
    const auto is_outside = [&](int i) { return std::hypot(mesh.x[2 * i], mesh.x[2 * i + 1]) > 5.99; };
    const auto moved = std::find_if(mesh.faces.begin(), mesh.faces.end(), is_outside);
    REQUIRE(moved != mesh.faces.end());
    double* const x = point(mesh.x, *moved, 2);
    const double angle = std::atan2(x[1], x[0]) + 1.4 * 2 * std::numbers::pi / 16;  // past the next node
    x[0] = 6 * std::cos(angle), x[1] = 6 * std::sin(angle);
    for (const bool is_given : {false, true}) {
        const TemporaryFolder folder;
        const Outcome outcome =
            improved(folder, msh_of(mesh), {is_given ? "surface_tolerance=1e-3" : "feature_angle=40"});
        CAPTURE(outcome.out);
        CHECK(has(outcome.out, " of an edge, NOT within surface_tolerance = "));
        CHECK(has(outcome.out, "\ncertified valid and injective"));
        CHECK(outcome.code == (is_given ? 3 : 0));
        CHECK(has(outcome.out, "\ntry a larger surface_tolerance: ") == is_given);
    }
}
