// Ideal elements of their own, regular cells of given volumes, or mapped by given matrices: DistortionParams::regular.
#include <doctest/doctest.h>

#include "mesh/regular_cell.hpp"
#include "support/energy_checks.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<Mesh> all_meshes() {
    std::vector<Mesh> meshes = solid_meshes();
    for (const Mesh& mesh : {square_mesh(2), quad_mesh(2), mixed_mesh(3), cube_mesh(1)}) meshes.push_back(mesh);
    for (std::size_t k = 0, count = meshes.size(); k < count; ++k) meshes.push_back(raise_degree(meshes[k], 2));
    return meshes;
}

AssembledParams regular(const Mesh& mesh, Objective objective, Assembly assembly = Assembly::simd) {
    AssembledParams params = with(objective, assembly);
    for (int e = 0; e < mesh.element_count(); ++e) params.regular.push_back(0.1 + 0.01 * e);
    return params;
}

AssembledParams mapped(const Mesh& mesh, Objective objective, Assembly assembly = Assembly::simd) {
    AssembledParams params = with(objective, assembly);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.dim * mesh.dim; ++k)
            params.regular.push_back(k % (mesh.dim + 1) == 0 ? 1 + 0.1 * k : 0.3 * std::sin(e + k));
    return params;
}

// One element, regular and of this volume.
Mesh regular_mesh(const CellType& cell, int degree, double volume) {
    Mesh mesh;
    mesh.dim = cell.dim;
    mesh.degree = degree;
    mesh.groups = groups_of({&cell}, degree);
    mesh.x = regular_nodes(cell, degree);
    for (int i = 0; i < mesh.nodes(); ++i) mesh.elements.push_back(i);
    for (double& x : mesh.x) x *= std::pow(volume / cell.volume(), 1.0 / cell.dim);
    mesh.file.element_id = {1};
    return mesh;
}

}  // namespace

TEST_CASE("the regular cell of the right size, and no other, has no distortion") {
    for (const CellType& cell : cell_types()) {
        if (cell.dim < 2) continue;
        for (const int degree : {1, 2})
            for (const Assembly assembly : assemblies) {
                const Mesh mesh = regular_mesh(cell, degree, 0.3);
                CAPTURE(cell.name);
                AssembledParams params = with(Objective::size_shape, assembly);
                params.regular = {0.3};
                const auto E = make_energy(mesh, mesh.x, params);
                CHECK(E->domain_volume() == doctest::Approx(0.3));
                CHECK(E->energy(mesh.x) < 1e-20);
                std::vector<double> larger = mesh.x;
                for (double& x : larger) x *= 1.1;
                CHECK(E->energy(larger) > 1e-5);
                CHECK(E->energy(stretched(mesh.x, mesh.dim)) > 0.01);
            }
    }
}

TEST_CASE("the regular cell mapped by the matrix of an element has no distortion, and no other") {
    const Mat<3> T = {{{0.9, 0.2, -0.1}, {0.1, 0.3, 0.2}, {-0.2, 0.1, 0.5}}};
    for (const CellType& cell : cell_types()) {
        if (cell.dim < 2) continue;
        for (const int degree : {1, 2})
            for (const Assembly assembly : assemblies) {
                Mesh mesh = regular_mesh(cell, degree, cell.volume());
                CAPTURE(cell.name);
                AssembledParams params = with(Objective::size_shape, assembly);
                for (int i = 0; i < cell.dim; ++i)
                    for (int j = 0; j < cell.dim; ++j) params.regular.push_back(T[i][j]);
                const std::vector<double> x = mesh.x;
                for (std::size_t k = 0; k < x.size(); ++k) {
                    mesh.x[k] = 0;
                    const std::size_t a = k % cell.dim;
                    for (int j = 0; j < cell.dim; ++j)
                        mesh.x[k] += params.regular[a * cell.dim + j] * x[k - a + j];
                }
                const auto E = make_energy(mesh, {}, params);
                CHECK(E->domain_volume() == doctest::Approx(volume(mesh, mesh.x)));
                CHECK(E->energy(mesh.x) < 1e-18);
                CHECK(E->energy(stretched(mesh.x, mesh.dim)) > 1e-3);
            }
    }
}

TEST_CASE("both assemblies agree, with parts of a mesh too, and derivatives have slope 2") {
    for (const Mesh& mesh : all_meshes()) {
        const std::vector<double> x = wavy(stretched(mesh.x, mesh.dim), mesh.dim, 0.01);
        for (const Objective objective : {Objective::squared, Objective::size_shape, Objective::tangled}) {
            for (const auto& ideal : {regular, mapped}) {
                const auto simd = make_energy(mesh, {}, ideal(mesh, objective, Assembly::simd));
                const auto plain = make_energy(mesh, {}, ideal(mesh, objective, Assembly::plain));
                check_same(*simd, *plain, x);
                std::vector<char> moves(mesh.nodes(), 0);
                moves[mesh.element(0)[0]] = moves[mesh.element(0)[1]] = 1;
                Restriction around;
                const auto part = simd->part(x, moves, around);
                const std::vector<int>& node = around.node;
                std::vector<double> y;
                for (const int i : node) y.insert(y.end(), point(x, i, mesh.dim), point(x, i, mesh.dim) + mesh.dim);
                std::vector<double> g = gradient(*simd, x), of_part = gradient(*part, y);
                for (int i = 0; i < 2 * mesh.dim; ++i)
                    CHECK(of_part[i] == doctest::Approx(point(g, node[i / mesh.dim], mesh.dim)[i % mesh.dim]));
            }
        }
        check_slopes(*make_energy(mesh, {}, regular(mesh, Objective::squared)), x);
        check_slopes(*make_energy(mesh, {}, mapped(mesh, Objective::squared)), x);
    }
}
