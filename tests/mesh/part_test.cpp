#include "mesh/part.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "mesh/lagrange.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<char> first_elements(const Mesh& mesh, int count) {
    std::vector<char> chosen(mesh.element_count(), 0);
    std::fill_n(chosen.begin(), count, 1);
    return chosen;
}

}  // namespace

TEST_CASE("a part has its elements in their order, with the positions and ids of their nodes") {
    for (const Mesh& linear : {ring_mesh(8, 3, 4), cube_mesh(2)})
        for (const int degree : {1, 3}) {
            const Mesh mesh = raise_degree(linear, degree);
            const std::vector<char> chosen = surroundings(mesh, first_elements(mesh, 1), 0);
            const MeshPart part = part_of(mesh, chosen, "cut");
            REQUIRE(part.element_count() == std::count(chosen.begin(), chosen.end(), 1));
            CHECK(part.restricted(mesh.x) == part.x);
            CHECK(part.degree == degree);
            for (int e = 0, r = 0; e < mesh.element_count(); ++e) {
                if (!chosen[e]) continue;
                CHECK(part.element_of[r] == e);
                CHECK(part.file.element_id[r] == mesh.file.element_id[e]);
                for (int k = 0; k < mesh.element_nodes(); ++k) {
                    const int here = mesh.element(e)[k], there = part.element(r)[k];
                    CHECK(part.node_of[there] == here);
                    CHECK(part.file.node_id[there] == mesh.file.node_id[here]);
                    for (int a = 0; a < mesh.dim; ++a)
                        CHECK(part.x[offset(there, mesh.dim, a)] == mesh.x[offset(here, mesh.dim, a)]);
                }
                ++r;
            }
        }
}

TEST_CASE("the boundary of a part is closed and oriented outward: its own faces, and those to the rest") {
    for (const Mesh& linear : {ring_mesh(8, 3, 4), cube_mesh(2)})
        for (const int degree : {1, 3}) {
            const Mesh mesh = raise_degree(linear, degree);
            std::vector<char> chosen = first_elements(mesh, 2);
            const Mesh part = part_of(mesh, chosen, "cut");
            CHECK(part.boundaries.back() == "cut");
            REQUIRE(part.boundaries.size() == mesh.boundaries.size() + 1);
            const LagrangeBasis basis(mesh.dim, degree);
            std::vector<std::vector<int>> local;
            for (int k = 0; k <= mesh.dim; ++k) local.push_back(basis.face_nodes(k));
            int cut_faces = 0;
            Vec<3> sum{};  // of the normals of the straight faces: zero for a closed boundary
            for (int f = 0; f < part.face_count(); ++f) {
                const int* const element = part.element(part.face_element[f]);
                CHECK(std::any_of(local.begin(), local.end(), [&](const std::vector<int>& nodes) {
                    for (int k = 0; k < part.face_nodes(0); ++k)
                        if (element[nodes[k]] != part.face(f)[k]) return false;
                    return true;
                }));
                cut_faces += part.boundaries[part.face_boundary[f]] == "cut";
                Vec<3> corner[3]{};
                for (int k = 0; k < part.dim; ++k)
                    std::copy_n(point(part.x, part.face(f)[k], part.dim), part.dim, corner[k].begin());
                const Vec<3> edge = corner[1] - corner[0];
                sum = sum + (part.dim == 2 ? edge : cross(edge, corner[2] - corner[0]));
            }
            CHECK(std::sqrt(dot(sum, sum)) == doctest::Approx(0).scale(1));
            CHECK(cut_faces > 0);
            CHECK(cut_faces < part.face_count());
        }
}

TEST_CASE("all elements are the mesh itself, and surroundings reach all of them") {
    const Mesh mesh = cube_mesh(3);
    const Mesh part = part_of(mesh, first_elements(mesh, mesh.element_count()), "cut");
    CHECK(part.face_count() == mesh.face_count());
    CHECK(part.nodes() == mesh.nodes());
    int before = 1;
    for (const double reach : {0.0, 0.6, 1.2, 2.4}) {
        const std::vector<char> chosen = surroundings(mesh, first_elements(mesh, 1), reach);
        const int now = static_cast<int>(std::count(chosen.begin(), chosen.end(), 1));
        CHECK(now > before);
        before = now;
    }
    CHECK(before == mesh.element_count());
}

TEST_CASE("surroundings without reach are the elements at the vertices; a reach goes through thin layers at once") {
    const int n = 8;
    Mesh mesh = square_mesh(n);
    const std::vector<char> first = first_elements(mesh, 1);
    const std::vector<char> touching = surroundings(mesh, first, 0);
    for (int e = 0; e < mesh.element_count(); ++e) {
        bool touches = false;
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j) touches = touches || mesh.element(e)[k] == mesh.element(0)[j];
        CHECK(touching[e] == touches);
    }
    for (int i = 0; i < mesh.nodes(); ++i) mesh.x[2 * i + 1] *= 0.01;
    const std::vector<char> near = surroundings(mesh, first, 0.5);
    for (int e = 0; e < mesh.element_count(); ++e) {
        const double x = centroid(mesh, mesh.x, mesh.element(e), 3)[0];
        if (x < 1.0 / n) CHECK(near[e]);
        if (x > 2.0 / n) CHECK(!near[e]);
    }
}
