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
            std::vector<char> chosen = first_elements(mesh, 1);
            add_layer(mesh, chosen);
            const Mesh part = part_of(mesh, chosen, "cut");
            REQUIRE(part.element_count() == std::count(chosen.begin(), chosen.end(), 1));
            CHECK(part.degree == degree);
            for (int e = 0, r = 0; e < mesh.element_count(); ++e) {
                if (!chosen[e]) continue;
                CHECK(part.file.element_id[r] == mesh.file.element_id[e]);
                for (int k = 0; k < mesh.element_nodes(); ++k) {
                    const int here = mesh.element(e)[k], there = part.element(r)[k];
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
            const auto local = LagrangeBasis(mesh.dim, degree).face_nodes();
            int cut_faces = 0;
            Vec<3> sum{};  // of the normals of the straight faces: zero for a closed boundary
            for (int f = 0; f < part.face_count(); ++f) {
                const int* const element = part.element(part.face_element[f]);
                CHECK(std::any_of(local.begin(), local.end(), [&](const std::vector<int>& nodes) {
                    for (int k = 0; k < part.face_nodes(); ++k)
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

TEST_CASE("all elements are the mesh itself, and layers reach all of them") {
    const Mesh mesh = cube_mesh(3);
    const Mesh part = part_of(mesh, first_elements(mesh, mesh.element_count()), "cut");
    CHECK(part.face_count() == mesh.face_count());
    CHECK(part.nodes() == mesh.nodes());
    std::vector<char> chosen = first_elements(mesh, 1);
    int before = 1;
    for (int layer = 0; layer < 3; ++layer) {
        add_layer(mesh, chosen);
        const int now = static_cast<int>(std::count(chosen.begin(), chosen.end(), 1));
        CHECK(now > before);
        before = now;
    }
    CHECK(before == mesh.element_count());
}
