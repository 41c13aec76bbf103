// Elements that no positions of the free nodes make valid, as almesh improve refuses them.
#include "check/never_valid.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/meshes.hpp"
#include "support/program.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Outcome improved(const Mesh& mesh, const std::vector<std::string>& settings = {}) {
    const TemporaryFolder folder;
    folder.write("mesh.msh", msh_of(mesh));
    std::vector<std::string> arguments = {"improve", folder.path("mesh.msh"), "output=" + folder.path("results")};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    return almesh_with(arguments);
}

int node_at(const Mesh& mesh, const Vec<3>& at) {
    int i = 0;
    while (length(positions(mesh, mesh.x, &i, 1)[0] - at) > 1e-9) ++i;
    return i;
}

void move(Mesh& mesh, const Vec<3>& from, const Vec<3>& to) {
    std::copy_n(to.begin(), mesh.dim, point(mesh.x, node_at(mesh, from), mesh.dim));
}

Mesh of_one_boundary(const Mesh& mesh) {
    return linear_mesh(mesh.dim, mesh.x, mesh.elements, [](const double*) { return "wall"; }, mesh.groups);
}

// Three quadrilaterals, the first of which has two edges on the line y = 0; above each of them three hexahedra in 3D.
Mesh with_flat_corner(int dim) {
    const std::vector<double> plane = {0, 0, 1, 0, 2, 0, 1, 1, 2, 1, 2, 2, 0, 2, 0, 1};
    const std::vector<int> quads = {0, 1, 2, 3, 2, 4, 5, 3, 3, 5, 6, 7};
    const auto name = [](const double*) { return "wall"; };
    if (dim == 2) return linear_mesh(2, plane, quads, name, {{&quadrilateral(), 0, 3, 0}});
    std::vector<double> x;
    for (const double z : {0, 1, 2, 3})
        for (std::size_t i = 0; i < plane.size(); i += 2) x.insert(x.end(), {plane[i], plane[i + 1], z});
    std::vector<int> hexes;
    for (const int layer : {0, 8, 16})
        for (std::size_t e = 0; e < quads.size(); e += 4)
            for (const int above : {0, 8})
                for (int k = 0; k < 4; ++k) hexes.push_back(quads[e + k] + layer + above);
    return linear_mesh(3, x, hexes, name, {{&hexahedron(), 0, 9, 0}});
}

}  // namespace

TEST_CASE("a triangle with two edges in one line of the boundary, wherever its nodes slide") {
    Mesh mesh = of_one_boundary(square_mesh(3));  // the triangle at (1, 0) has two of its edges on the boundary
    move(mesh, {1, 0, 0}, {5.0 / 6, 1.0 / 6, 0});
    const Outcome outcome = improved(mesh);
    CHECK(outcome.code == 2);
    CHECK(has(outcome.error, "element 17 at (0.833333, 0.166667) has edges that meet in one line of the boundary "));
    CHECK(has(outcome.error, "flat wherever its nodes slide: take it out of the mesh, or divide it"));
}

TEST_CASE("a triangle that is inverted between corners, which are fixed; where they slide it is not known to be") {
    Mesh mesh = square_mesh(3);
    move(mesh, {1, 0, 0}, {0.8, 0.2, 0});
    const Outcome outcome = improved(mesh);
    CHECK(outcome.code == 2);
    CHECK(has(outcome.error, "element 17 at (0.822222, 0.177778) is inverted or flat where it lies between nodes "));
    CHECK(has(outcome.error, "that are fixed: let them slide, or take it out of the mesh"));
    CHECK(improved(mesh, {"boundary rest=free", "boundary top=fixed"}).code != 2);
}

TEST_CASE("a quadrilateral and a hexahedron whose edges at a corner are in one line or plane") {
    for (const int dim : {2, 3}) {
        const Outcome outcome = improved(with_flat_corner(dim));
        CHECK(outcome.code == 2);
        CHECK(has(outcome.error, dim == 2 ? " at (1, 0.25) has edges that meet in one line of the boundary wall,"
                                          : " at (1, 0.25, 0.5) has edges that meet in one plane of the boundary "));
    }
}

TEST_CASE("a fixed boundary that crosses itself") {
    Mesh mesh = square_mesh(4);
    move(mesh, {0.5, 0, 0}, {0.9, 0, 0});
    CHECK(improved(mesh).code == 0);  // where it slides it need not
    const Outcome outcome = improved(mesh, {"boundary rest=fixed"});
    CHECK(outcome.code == 2);
    CHECK(has(outcome.error, " crosses another one, and all of the boundary is fixed"));
}
