#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

double element_volume(const Mesh& mesh, int e) {
    double d[3][3] = {};
    for (int v = 0; v < mesh.dim; ++v)
        for (int a = 0; a < mesh.dim; ++a)
            d[v][a] = mesh.x[mesh.element(e)[v + 1] * mesh.dim + a] - mesh.x[mesh.element(e)[0] * mesh.dim + a];
    if (mesh.dim == 2) return 0.5 * (d[0][0] * d[1][1] - d[0][1] * d[1][0]);
    return (d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
            d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0])) / 6;
}

// Every face is an element's face in the order that LagrangeBasis::face_nodes gives.
void check_faces(const Mesh& mesh) {
    const LagrangeBasis basis(mesh.dim, mesh.degree);
    for (int f = 0; f < mesh.face_count(); ++f) {
        bool found = false;
        for (int opposite = 0; opposite <= mesh.dim; ++opposite) {
            const std::vector<int> local = basis.face_nodes(opposite);
            bool same = true;
            for (int i = 0; i < mesh.face_nodes(0); ++i)
                same = same && mesh.element(mesh.face_element[f])[local[i]] == mesh.face(f)[i];
            found = found || same;
        }
        CHECK(found);
    }
}

void check_conforming(const Mesh& mesh) {
    std::map<std::set<int>, int> uses;
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v <= mesh.dim; ++v) {
            std::set<int> face(mesh.element(e), mesh.element(e) + mesh.dim + 1);
            face.erase(mesh.element(e)[v]);
            ++uses[face];
        }
    int boundary = 0;
    for (const auto& use : uses) {
        CHECK(use.second <= 2);
        boundary += use.second == 1;
    }
    CHECK(boundary == mesh.face_count());
}

}  // namespace

TEST_CASE("refinement keeps the volume, conforms and carries boundaries and tags") {
    for (const Mesh& coarse : {square_mesh(2), cube_mesh(2)}) {
        const Mesh fine = refine(coarse, 2);
        const int dim = coarse.dim;
        CHECK(fine.element_count() == coarse.element_count() << (2 * dim));
        CHECK(fine.face_count() == coarse.face_count() << (2 * (dim - 1)));
        double volume = 0, smallest = 1;
        for (int e = 0; e < fine.element_count(); ++e) {
            volume += element_volume(fine, e);
            smallest = std::min(smallest, element_volume(fine, e));
        }
        CHECK(volume == doctest::Approx(1));
        CHECK(smallest > 0);
        check_conforming(fine);
        check_faces(fine);
        for (int f = 0; f < fine.face_count(); ++f) {
            if (fine.boundaries[fine.face_boundary[f]] != "bottom") continue;
            for (int v = 0; v < dim; ++v) CHECK(fine.x[fine.face(f)[v] * dim + dim - 1] == 0);
        }
        CHECK(static_cast<int>(fine.file.node_id.size()) == fine.nodes());
        const std::vector<long long>& id = fine.file.node_id;
        CHECK(std::set<long long>(id.begin(), id.end()).size() == id.size());
        for (int i = 0; i < coarse.nodes(); ++i) CHECK(fine.file.node_id[i] == coarse.file.node_id[i]);
        CHECK(fine.file.element_physical.size() == static_cast<std::size_t>(fine.element_count()));
    }
}

TEST_CASE("uniform refinement has the counts of Table 1") {
    const Mesh ring = ring_mesh(8, 3, 21.0);  // V - E + F = 0, as on the paper's annulus
    const Mesh fine = refine(ring, 1);
    const int edges = (3 * ring.element_count() + ring.face_count()) / 2;
    CHECK(fine.nodes() == ring.nodes() + edges);
    CHECK(fine.element_count() == 4 * ring.element_count());
}

TEST_CASE("raising the degree puts nodes on the lattice and shares them between elements") {
    for (int degree : {2, 3, 4, 5}) {
        const Mesh p = raise_degree(square_mesh(2), degree);
        CHECK(p.nodes() == (2 * degree + 1) * (2 * degree + 1));  // the lattice of a square grid
        check_faces(p);
        const std::vector<double> straight = straight_sided(p);
        for (std::size_t i = 0; i < p.x.size(); ++i)
            CHECK(p.x[i] == doctest::Approx(straight[i]).epsilon(1e-14).scale(1));
    }
    for (int degree : {2, 3, 4}) {
        const Mesh p = raise_degree(cube_mesh(2), degree);
        CHECK(p.nodes() == (2 * degree + 1) * (2 * degree + 1) * (2 * degree + 1));
        check_faces(p);
    }
}

TEST_CASE("raising the degree keeps the shape of a curved mesh") {
    Mesh quadratic = raise_degree(square_mesh(1), 2);
    quadratic.x = wavy(quadratic.x, 2, 0.05);
    const Mesh quintic = raise_degree(quadratic, 5);
    const LagrangeBasis low(2, 2), high(2, 5);
    std::vector<double> N2(low.count), N5(high.count);
    for (const double s : {0.1, 0.3, 0.6}) {
        const double xi[2] = {s, 0.37 * (1 - s)};
        low.values(xi, N2.data());
        high.values(xi, N5.data());
        for (int e = 0; e < 2; ++e)
            for (int a = 0; a < 2; ++a) {
                double p = 0, q = 0;
                for (int i = 0; i < low.count; ++i) p += N2[i] * quadratic.x[quadratic.element(e)[i] * 2 + a];
                for (int i = 0; i < high.count; ++i) q += N5[i] * quintic.x[quintic.element(e)[i] * 2 + a];
                CHECK(p == doctest::Approx(q).epsilon(1e-13));
            }
    }
    CHECK_THROWS_AS(raise_degree(quintic, 2), InputError);
    CHECK_THROWS_AS(refine(quadratic, 1), InputError);
}

TEST_CASE("new nodes never take an id of the mesh they come from") {
    Mesh quadratic = raise_degree(square_mesh(1), 2);
    for (long long& id : quadratic.file.node_id) id += 1000;
    const long long largest = *std::max_element(quadratic.file.node_id.begin(), quadratic.file.node_id.end());
    const Mesh quartic = raise_degree(quadratic, 4);
    const std::vector<long long>& known = quadratic.file.node_id;
    for (int i = 0; i < quartic.nodes(); ++i) {
        const auto at = std::find(known.begin(), known.end(), quartic.file.node_id[i]) - known.begin();
        const bool kept = at != static_cast<std::ptrdiff_t>(known.size());
        CHECK((kept || quartic.file.node_id[i] > largest));
        if (!kept) continue;
        for (int a = 0; a < 2; ++a) CHECK(quartic.x[2 * i + a] == quadratic.x[2 * at + a]);
    }
}

TEST_CASE("a mesh beyond the range of int is refused, not made") {
    CHECK_THROWS_AS(refine(cube_mesh(1), 9), InputError);  // 6 * 8^9 tetrahedra
}

TEST_CASE("refining a straight mesh of degree p refines its linear part") {
    const Mesh cubic = raise_degree(square_mesh(1), 3);
    const Mesh fine = refine(cubic, 1);
    CHECK(fine.degree == 3);
    CHECK(fine.element_count() == 8);
    CHECK(fine.nodes() == 7 * 7);
}
