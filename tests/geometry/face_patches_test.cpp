#include "geometry/face_patches.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "geometry/closest_point.hpp"
#include "mesh/build.hpp"
#include "mesh/lagrange.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Mesh curved_solid(int degree) {
    std::vector<std::string> notes;
    Mesh mesh = raise_degree(build_mesh(solid_block(1, "hdp"), notes), degree);
    mesh.x = wavy(mesh.x, 3, 0.07);
    return mesh;
}

Vec<3> value(const Bernstein& basis, const Patch& patch, const double* l) {
    Vec<3> sum{};
    for (int a = 0; a < basis.count; ++a) {
        double B = basis.multinomial[a];
        for (int k = 0; k <= basis.dim; ++k) B *= std::pow(l[k], basis.index[a][k]);
        sum = sum + B * patch[a];
    }
    return sum;
}

}  // namespace

TEST_CASE("the patches of a face are the face itself, two of a quadrilateral") {
    for (const int degree : {1, 2, 3, 4}) {
        CAPTURE(degree);
        const Mesh mesh = curved_solid(degree);
        const FacePatches faces(mesh);
        CHECK(faces.basis.bernstein.degree == 2 * degree);
        CHECK(faces.count() == 2 + 2 * (4 * 3 + 1));
        for (int f = 0; f < mesh.face_count(); ++f) {
            const LagrangeBasis basis(mesh.face_cell(f), degree);
            const std::vector<Patch> patches = faces.of(f, mesh.x);
            REQUIRE(static_cast<int>(patches.size()) == faces.cut(f).count());
            for (std::size_t k = 0; k < patches.size(); ++k) {
                CHECK(faces.face[faces.first[f] + k] == f);
                for (int v = 0; v < 3; ++v) {
                    const int node = faces.corner(faces.first[f] + static_cast<int>(k), v);
                    CHECK(patches[k][v] == positions(mesh, mesh.x, &node, 1)[0]);
                }
                for (const auto& [s, t] : {std::array{0.2, 0.3}, {0.0, 0.6}, {0.5, 0.5}, {0.1, 0.85}}) {
                    const double l[] = {1 - s - t, s, t};
                    std::vector<double> N(basis.count);
                    basis.values(faces.cut(f).point(static_cast<int>(k), {l[0], l[1], l[2], 0}).data(), N.data());
                    Vec<3> at{};
                    for (int i = 0; i < basis.count; ++i)
                        at = at + N[i] * positions(mesh, mesh.x, &mesh.face(f)[i], 1)[0];
                    CHECK(length(at - value(faces.basis.bernstein, patches[k], l)) < 1e-13);
                }
            }
        }
    }
}

TEST_CASE("patches that meet share the numbers of the nodes along their side, and nodes at one point only these") {
    for (const int degree : {1, 2, 3}) {
        const Mesh mesh = curved_solid(degree);
        const FacePatches faces(mesh);
        std::vector<int> all(mesh.face_count());
        for (int f = 0; f < mesh.face_count(); ++f) all[f] = f;
        const std::vector<std::vector<int>> nodes = faces.nodes_of(all);
        REQUIRE(static_cast<int>(nodes.size()) == faces.count());
        std::map<int, Vec<3>> place;
        for (int patch = 0; patch < faces.count(); ++patch) {
            const int f = faces.face[patch];
            const std::vector<Vec<3>> at = faces.cut(f).nodes_of(
                faces.part(patch), positions(mesh, mesh.x, mesh.face(f), mesh.face_nodes(f)));
            for (std::size_t i = 0; i < at.size(); ++i) {
                const auto [known, is_new] = place.try_emplace(nodes[patch][i], at[i]);
                CHECK(length(known->second - at[i]) < 1e-14);
            }
        }
        for (auto a = place.begin(); a != place.end(); ++a)
            for (auto b = std::next(a); b != place.end(); ++b) CHECK(length(a->second - b->second) > 1e-3);
    }
}

TEST_CASE("the point closest to one off a curved quadrilateral is the one at whose foot it stands") {
    const Mesh mesh = curved_solid(3);
    const FacePatches faces(mesh);
    std::vector<Patch> patches;
    for (int f = 0; f < mesh.face_count(); ++f)
        for (const Patch& patch : faces.of(f, mesh.x)) patches.push_back(patch);
    const ClosestPoint closest(faces.basis, patches);
    const PatchNormal normal(2, faces.basis.bernstein.degree);
    for (int patch = 0; patch < faces.count(); ++patch)
        for (const auto& [s, t] : {std::array{0.3, 0.3}, {0.15, 0.5}}) {
            const double l[] = {1 - s - t, s, t};
            const Vec<3> foot = value(faces.basis.bernstein, patches[patch], l);
            const Vec<3> n = unit(value(normal.basis, normal.coefficients(patches[patch]), l));
            CHECK(length(closest.find(foot + 0.02 * n).position - foot) < 1e-9);
        }
}
