// What faces sweep, beside what the elements gain, whose volumes are integrals of the determinant.
#include "check/swept_volumes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "mesh/quadrature.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

template <int n>
std::vector<double> volumes(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<double> volume(mesh.element_count(), 0.0);
    for (int e = 0; e < mesh.element_count(); ++e) {
        const Quadrature rule = cell_quadrature(mesh.cell(e), 3 * mesh.degree);
        const ReferenceElement reference = reference_element(mesh.cell(e), mesh.degree, rule);
        for (int q = 0; q < rule.count; ++q)
            volume[e] += rule.weight[q] * determinant(jacobian_at<n>(mesh.element(e), x, reference, q));
    }
    return volume;
}

std::vector<double> volumes(const Mesh& mesh, const std::vector<double>& x) {
    return mesh.dim == 2 ? volumes<2>(mesh, x) : volumes<3>(mesh, x);
}

// Of the elements, by what their faces sweep.
std::vector<double> gains(const Mesh& mesh, const std::vector<double>& before, const std::vector<double>& now) {
    const std::vector<MeshFace> faces = mesh_faces(mesh);
    const std::vector<double> swept = swept_volumes(mesh, faces, before, now);
    std::vector<double> gain(mesh.element_count(), 0.0);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        gain[faces[f].element] += swept[f];
        if (faces[f].neighbour >= 0) gain[faces[f].neighbour] -= swept[f];
    }
    return gain;
}

// Every node somewhere else, on curved edges and faces.
std::vector<double> shaken(const Mesh& mesh, double by, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-by, by);
    std::vector<double> x = mesh.x;
    for (double& v : x) v += shift(random);
    return x;
}

std::vector<Mesh> all_cells() {
    std::vector<Mesh> meshes = solid_meshes();
    meshes.insert(meshes.end(), {square_mesh(3), mixed_mesh(4), cube_mesh(2)});
    return meshes;
}

}  // namespace

TEST_CASE("an element gains what its faces sweep, to rounding: all cells, straight and curved") {
    for (const Mesh& linear : all_cells())
        for (int degree = 1; degree <= (linear.dim == 2 ? 5 : 3); ++degree) {
            const Mesh mesh = raise_degree(linear, degree);
            const std::vector<double> before = shaken(mesh, 0.1, 1), now = shaken(mesh, 0.1, 2);
            const std::vector<double> was = volumes(mesh, before), is = volumes(mesh, now);
            const std::vector<double> gain = gains(mesh, before, now);
            CAPTURE(mesh.elements_text());
            CAPTURE(degree);
            for (int e = 0; e < mesh.element_count(); ++e) CHECK(std::abs(is[e] - was[e] - gain[e]) < 1e-14);
        }
}

TEST_CASE("each face once, out of its first element; a piston sweeps its area times its way") {
    for (const Mesh& mesh : {square_mesh(3), cube_mesh(2)}) {
        const std::vector<MeshFace> faces = mesh_faces(mesh);
        std::size_t inside = 0;
        for (const MeshFace& face : faces) inside += face.neighbour >= 0;
        CHECK(faces.size() - inside == static_cast<std::size_t>(mesh.face_count()));
        CHECK(2 * inside + mesh.face_count() == static_cast<std::size_t>(mesh.element_count() * (mesh.dim + 1)));
        std::vector<double> now = mesh.x;
        for (int i = 0; i < mesh.nodes(); ++i) now[i * mesh.dim] *= 1.25;
        const std::vector<double> swept = swept_volumes(mesh, faces, mesh.x, now);
        double outward = 0;
        for (std::size_t f = 0; f < faces.size(); ++f)
            if (faces[f].neighbour < 0) outward += swept[f];
        CHECK(outward == doctest::Approx(0.25).epsilon(1e-14));
    }
}
