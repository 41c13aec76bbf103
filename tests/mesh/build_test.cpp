#include "mesh/build.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "base/error.hpp"
#include "base/small_matrix.hpp"
#include "mesh/lagrange.hpp"
#include "support/sample_mesh.hpp"
#include "support/solids.hpp"

using namespace almesh;
using doctest::Approx;
using doctest::Contains;

namespace {

Mesh build_quietly(const RawMesh& raw) {
    std::vector<std::string> notes;
    Mesh mesh = build_mesh(raw, notes);
    CHECK(notes.empty());
    return mesh;
}

template <int n>
double volume(const Mesh& mesh, int e) {
    Mat<n> edges;
    for (int v = 1; v <= n; ++v)
        for (int k = 0; k < n; ++k)
            edges[v - 1][k] = mesh.x[mesh.element(e)[v] * n + k] - mesh.x[mesh.element(e)[0] * n + k];
    return determinant(edges) / (n == 2 ? 2 : 6);
}

double volume_of(const Mesh& mesh, int e) { return mesh.dim == 2 ? volume<2>(mesh, e) : volume<3>(mesh, e); }

// Largest distance of a node from its affine position in an element.
double bend(const Mesh& mesh) {
    double largest = 0;
    const std::vector<MultiIndex> order = gmsh_node_order(mesh.dim, mesh.degree);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int i = 0; i < mesh.element_nodes(); ++i)
            for (int a = 0; a < mesh.dim; ++a) {
                double difference = mesh.x[mesh.element(e)[i] * mesh.dim + a];
                for (int v = 0; v <= mesh.dim; ++v)
                    difference -= order[i][v] * mesh.x[mesh.element(e)[v] * mesh.dim + a] / mesh.degree;
                largest = std::max(largest, std::abs(difference));
            }
    return largest;
}

// Two triangles on the unit square, 1-2-3 and 1-3-4, with all four edges tagged; small enough to spoil by hand.
RawMesh square() {
    RawMesh raw;
    raw.path = "square.msh";
    raw.nodes = {{1, {0, 0, 0}, 5}, {2, {1, 0, 0}, 6}, {3, {1, 1, 0}, 7}, {4, {0, 1, 0}, 8}};
    for (int k = 0; k < 4; ++k) append_element(raw, 1, 7, {k, (k + 1) % 4});
    append_element(raw, 2, 9, {0, 1, 2});
    append_element(raw, 2, 9, {0, 2, 3});
    return raw;
}

void check_refused(const RawMesh& raw, const char* message) {
    std::vector<std::string> notes;
    CHECK_THROWS_WITH_AS(build_mesh(raw, notes), Contains(message), InputError);
}

}  // namespace

TEST_CASE("a node without a place is refused by its id, one that no element has is not") {
    for (const double no_number : {NAN, INFINITY}) {
        RawMesh raw = square();
        raw.nodes.push_back({5, {no_number, 0, 0}, 0});
        std::vector<std::string> notes;
        CHECK(build_mesh(raw, notes).nodes() == 4);
        raw.nodes[2].x[1] = no_number;
        CHECK_THROWS_WITH_AS(build_mesh(raw, notes), Contains("square.msh: node 3 is at (1, "), InputError);
        CHECK_THROWS_WITH_AS(build_mesh(raw, notes), Contains("which is no point"), InputError);
    }
}

TEST_CASE("meshes of every dimension and degree come out with volume 1, ids and tags") {
    for (int dim : {2, 3})
        for (int degree = 1; degree <= (dim == 2 ? 7 : 5); ++degree) {
            CAPTURE(dim);
            CAPTURE(degree);
            const RawMesh raw = SampleMesh(dim, degree, 2).raw;
            const Mesh mesh = build_quietly(raw);
            CHECK(mesh.dim == dim);
            CHECK(mesh.degree == degree);
            CHECK(mesh.nodes() == std::pow(2 * degree + 1, dim));
            CHECK(mesh.element_count() == (dim == 2 ? 8 : 48));
            double sum = 0;
            for (int e = 0; e < mesh.element_count(); ++e) sum += volume_of(mesh, e);
            CHECK(sum == Approx(1).epsilon(1e-14));
            CHECK(bend(mesh) < 1e-15);
            const std::size_t faces = mesh.face_count();
            for (int e = 0; e < mesh.element_count(); ++e) {
                CHECK(mesh.file.element_id[e] == raw.elements[faces + e].id);
                CHECK(mesh.file.element_physical[e] == 9);
                CHECK(mesh.file.element_entity[e] == 29);
            }
            for (int i = 0; i < mesh.nodes(); ++i) CHECK(mesh.file.node_id[i] == 10 + 3 * i);
            CHECK(mesh.file.groups.size() == 2);
        }
}

TEST_CASE("negatively oriented elements are turned with all their nodes") {
    for (int dim : {2, 3})
        for (int degree = 1; degree <= 5; ++degree) {
            CAPTURE(dim);
            CAPTURE(degree);
            std::vector<std::string> notes;
            const Mesh mesh = build_mesh(SampleMesh(dim, degree, 2, true).raw, notes);
            for (int e = 0; e < mesh.element_count(); ++e) CHECK(volume_of(mesh, e) > 0);
            CHECK(bend(mesh) < 1e-15);
            REQUIRE(notes.size() == 1);
            const std::string first = dim == 2 ? "10" : "50";
            CHECK(notes[0] == (dim == 2 ? "4" : "24") + std::string(" elements with negative orientation turned, the "
                                                                    "first is element ") + first);
        }
}

TEST_CASE("a tangled mesh whose elements are numbered in both directions is oriented by the faces that they share") {
    const auto check_same = [](const RawMesh& raw, const RawMesh& turned) {
        std::vector<std::string> notes;
        const Mesh mesh = build_mesh(raw, notes, Folds::keep), oriented = build_mesh(turned, notes, Folds::keep);
        CHECK(oriented.folded.empty());
        REQUIRE(oriented.element_count() == mesh.element_count());
        int inverted = 0;
        for (int e = 0; e < mesh.element_count(); ++e) {
            const double v = almesh::volume(mesh, mesh.x, e);
            CHECK(almesh::volume(oriented, oriented.x, e) == Approx(v).scale(1e-3));
            inverted += v < 0;
        }
        CHECK(inverted > 0);
        CHECK(inverted < mesh.element_count() / 2);
    };
    for (const int dim : {2, 3})
        for (const int degree : {1, 2, 3}) {
            RawMesh raw = SampleMesh(dim, degree, 3).raw, turned = SampleMesh(dim, degree, 3, true).raw;
            const auto tangle = [&](RawMesh& of) {
                const auto inner = std::find_if(of.nodes.begin(), of.nodes.end(), [&](const RawNode& node) {
                    return node.x[0] == 2.0 / 3 && node.x[1] == 2.0 / 3 && (dim == 2 || node.x[2] == 2.0 / 3);
                });
                REQUIRE(inner != of.nodes.end());
                inner->x[0] = 0.1;
            };
            tangle(raw);
            tangle(turned);
            check_same(raw, turned);
        }
    for (const char* layers : {"hhh", "ppp", "hdu"}) {
        RawMesh raw = test::solid_block(3, layers);
        for (RawNode& node : raw.nodes)
            if (node.x[0] > 0.6 && node.x[0] < 0.7 && node.x[1] > 0.6 && node.x[1] < 0.7 && node.x[2] > 0.3 &&
                node.x[2] < 0.7)
                node.x[0] = -0.4;
        const int count = static_cast<int>(raw.nodes.size());
        RawMesh turned = raw;  // and once more beside it, all reversed
        for (int i = 0; i < count; ++i) {
            turned.nodes.push_back(raw.nodes[i]);
            turned.nodes.back().id += 1000000;
            turned.nodes.back().x[0] += 5;
        }
        RawMesh both = turned;
        const std::map<int, std::vector<int>> reversed = {{4, {0, 1, 3, 2}}, {5, {0, 3, 2, 1, 4}},
                                                          {6, {3, 4, 5, 0, 1, 2}}, {8, {4, 5, 6, 7, 0, 1, 2, 3}}};
        for (const bool copy : {false, true})
            for (std::size_t k = 0; k < raw.elements.size(); ++k) {
                RawElement element = raw.elements[k];
                if (element.dim < 3) continue;
                const int* const nodes = &raw.element_nodes[element.first];
                const std::vector<int>& order = reversed.at(element.node_count());
                if (copy) element.first = both.element_nodes.size(), element.id += 1000000;
                for (std::size_t i = 0; i < order.size(); ++i) {
                    const int at = order[i];
                    if (copy) {
                        both.element_nodes.push_back(nodes[i] + count);
                        turned.element_nodes.push_back(nodes[at] + count);
                    } else if (k % 3 == 0) turned.element_nodes[element.first + i] = nodes[at];
                }
                if (!copy) continue;
                both.elements.push_back(element);
                turned.elements.push_back(element);
            }
        check_same(both, turned);
    }
}

TEST_CASE("what has one side only stays as the file has it, and its folds are told") {
    RawMesh raw;  // a Moebius strip of five triangles
    raw.path = "strip.msh";
    for (int i = 0; i < 5; ++i) {
        raw.nodes.push_back({i + 1, {std::cos(1.2566 * i), std::sin(1.2566 * i), 0}, i});
        append_element(raw, 2, 1, {i, (i + 1) % 5, (i + 2) % 5});
    }
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(raw, notes, Folds::keep);
    CHECK(!mesh.folded.empty());
    CHECK(mesh.elements == raw.element_nodes);
}

TEST_CASE("nodes without an element are no nodes of the mesh") {
    RawMesh raw = square();
    raw.nodes.insert(raw.nodes.begin(), {77, {5, 5, 3}, 4});
    for (int& node : raw.element_nodes) ++node;
    const Mesh mesh = build_quietly(raw);
    CHECK(mesh.file.loose == 1);
    CHECK(mesh.file.node_id == std::vector<long long>{1, 2, 3, 4});
    CHECK(mesh.x == std::vector<double>{0, 0, 1, 0, 1, 1, 0, 1});
    CHECK(mesh.elements == std::vector<int>{0, 1, 2, 0, 2, 3});
}

TEST_CASE("a 2D mesh lies in a plane z = constant") {
    RawMesh raw = square();
    for (RawNode& node : raw.nodes) node.x[2] = 0.5;
    CHECK(build_quietly(raw).file.z == 0.5);
    raw.nodes[2].x[2] = 0.75;
    check_refused(raw, "square.msh: the elements form a surface in space, z goes from 0.5 (node 1) to 0.75 (node 3)");
}

TEST_CASE("stretched elements pass, flat ones do not") {
    for (double height : {2e-5, 1e-10, 1e-14}) {
        RawMesh raw = square();
        for (RawNode& node : raw.nodes) node.x[1] *= height;
        CHECK(build_quietly(raw).element_count() == 2);
        RawMesh cube = SampleMesh(3, 1, 1).raw;
        for (RawNode& node : cube.nodes) node.x[2] *= height;
        CHECK(build_quietly(cube).element_count() == 6);
    }
    RawMesh raw = square();
    for (RawNode& node : raw.nodes) node.x[1] = node.x[0] / 3 + (node.id == 4) * 0.7;
    check_refused(raw,
                  "square.msh:1004: element 5 with the vertices 1, 2, 3 has no volume, the first of 1 such element");
    raw.nodes[3].x[0] = 0.1;
    raw.nodes[3].x[1] = 0.1 / 3;
    check_refused(raw, "has no volume, the first of 2 such elements");
    RawMesh cube = SampleMesh(3, 2, 1).raw;
    for (RawNode& node : cube.nodes) node.x[2] = 0.3 * node.x[0] + 0.1 * node.x[1];
    check_refused(cube, "has no volume, the first of 6 such elements");
}

TEST_CASE("what makes no mesh of one degree is refused") {
    RawMesh raw = square();
    raw.elements.resize(4);
    check_refused(raw, "square.msh: the mesh has no elements of dimension 2 or 3");
    raw = SampleMesh(2, 2, 1).raw;
    append_element(raw, 1, 1, {0, 1});
    check_refused(raw, "sample.msh:1006: element 7 has degree 1, element 1 (line 1000) has degree 2");
}

TEST_CASE("elements of several physical groups have the first, their entity all") {
    RawMesh raw = square();
    raw.entities = {{{1, 4}, {7}}, {{2, 1}, {9, 10}}, {{3, 1}, {1, 2}}};
    const Mesh mesh = build_quietly(raw);
    CHECK(mesh.file.element_physical[0] == 9);
    CHECK(mesh.file.entities[1].physical == std::vector<int>{9, 10});
}
