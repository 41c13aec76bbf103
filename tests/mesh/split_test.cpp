#include "mesh/split.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "mesh/build.hpp"
#include "mesh/sides.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/sample_mesh.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<int> all_elements(const Mesh& mesh) {
    std::vector<int> elements(mesh.element_count());
    for (int e = 0; e < mesh.element_count(); ++e) elements[e] = e;
    return elements;
}

std::vector<Simplex> all_inner(const Mesh& mesh) {
    std::set<Simplex> all;
    for (const std::vector<Simplex>& inner : inner_simplices(mesh, all_elements(mesh)))
        all.insert(inner.begin(), inner.end());
    return {all.begin(), all.end()};
}

// The unit cube of five tetrahedra: four of them have three faces on the boundary, the fifth has all its edges there.
Mesh cube_of_five() {
    std::vector<double> x;
    for (int i = 0; i < 8; ++i)
        for (const int bit : {1, 2, 4}) x.push_back((i & bit) != 0);
    return linear_mesh(3, x, {0, 1, 2, 4, 3, 2, 1, 7, 5, 4, 7, 1, 6, 7, 4, 2, 1, 2, 4, 7},
                       [](const double*) { return "all"; });
}

// The square or cube, with a line from its first corner to its last, which is a diagonal of every box, and its first
// element once more.
Mesh with_kept_cells(int dim, int degree) {
    RawMesh raw = SampleMesh(dim, 1, 1).raw;
    const auto corner = [&](double at) {
        return static_cast<int>(std::find_if(raw.nodes.begin(), raw.nodes.end(), [&](const RawNode& node) {
            return std::all_of(node.x, node.x + dim, [at](double v) { return v == at; });
        }) - raw.nodes.begin());
    };
    append_element(raw, 1, 7, {corner(0), corner(1)});
    const auto first = std::find_if(raw.elements.begin(), raw.elements.end(),
                                    [&](const RawElement& element) { return element.dim == dim; });
    const std::vector<int> nodes(&raw.element_nodes[first->first], &raw.element_nodes[first->first] + dim + 1);
    append_element(raw, dim, 8, nodes);
    std::vector<std::string> notes;
    return raise_degree(build_mesh(raw, notes), degree);
}

double total_volume(const Mesh& mesh) { return volume(mesh, straight_sided(mesh)); }

void check_near(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) < 1e-13);
}

template <class Values>
void check_begins(const Values& longer, const Values& shorter) {
    REQUIRE(longer.size() >= shorter.size());
    CHECK(std::equal(shorter.begin(), shorter.end(), longer.begin()));
}

// Every side is of two elements or a face of the mesh, which has its nodes in the order of its element.
void check_conforming(const Mesh& mesh) {
    std::vector<Side> sides;
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k <= mesh.dim; ++k)
            sides.push_back(side_of_cell(simplex(mesh.dim), mesh.element(e), k, e * (mesh.dim + 1) + k));
    int outer = 0;
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        CHECK(equal.size() <= 2);
        outer += equal.size() == 1;
    });
    CHECK(outer == mesh.face_count());
    const SideNodes local(mesh.dim, mesh.degree);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int* const element = mesh.element(mesh.face_element[f]);
        const int side = side_number(mesh, mesh.face_element[f], mesh.face_vertices(f));
        REQUIRE(side >= 0);
        std::set<int> in_element, in_face(mesh.face(f), mesh.face(f) + mesh.face_nodes(0));
        for (const int k : local.of(mesh.cell(), side)) in_element.insert(element[k]);
        CHECK(in_element == in_face);
    }
}

void check_ids(const Mesh& before, const Mesh& after) {
    check_begins(after.file.node_id, before.file.node_id);
    check_begins(after.file.element_id, before.file.element_id);
    CHECK(after.file.face_id == before.file.face_id);
    const std::set<long long> nodes(after.file.node_id.begin(), after.file.node_id.end());
    CHECK(static_cast<int>(nodes.size()) == after.nodes());
    std::vector<long long> ids = after.file.element_id;
    ids.insert(ids.end(), after.file.face_id.begin(), after.file.face_id.end());
    for (const KeptCells& kept : after.kept) ids.insert(ids.end(), kept.id.begin(), kept.id.end());
    CHECK(std::set<long long>(ids.begin(), ids.end()).size() == ids.size());
    for (const std::vector<int>* tags : {&after.file.element_physical, &after.file.element_entity})
        CHECK(tags->size() == after.file.element_id.size());
}

}  // namespace

TEST_CASE("elements with two or three faces on the boundary: the edge or the face that is inside") {
    const Mesh square = square_mesh(2);
    int corners = 0;
    for (int e = 0; e < square.element_count(); ++e) {
        const auto faces = std::count(square.face_element.begin(), square.face_element.end(), e);
        if (faces == 2) CHECK(inner_simplices(square, {e})[0].size() == 1);
        corners += faces == 2;
    }
    CHECK(corners == 2);
    CHECK(all_inner(square) == std::vector<Simplex>{{1, 5}, {3, 7}});  // not those of node 4, in the middle
    const Mesh cube = cube_of_five();
    const auto inner = inner_simplices(cube, {0, 4});
    CHECK(inner[0] == std::vector<Simplex>{{1, 2, 4}});
    CHECK(inner[1].size() == 4);
    CHECK(inner_simplices(cube_mesh(1), {3})[0] == std::vector<Simplex>{{0, 7}});
    CHECK(all_inner(linear_mesh(3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 1, 2, 3},
                                [](const double*) { return "all"; })).empty());
}

TEST_CASE("a mesh that is split keeps its nodes, faces, ids and tags, and conforms") {
    for (const Mesh& linear : {square_mesh(1), square_mesh(3), ring_mesh(7, 1, 2), cube_of_five(), cube_mesh(1),
                               cube_mesh(2)})
        for (const int degree : {1, 2, 3, 4}) {
            CAPTURE(linear.dim);
            CAPTURE(degree);
            const Mesh before = raise_degree(linear, degree);
            const std::vector<Simplex> at = all_inner(before);
            REQUIRE(!at.empty());
            const Mesh after = split(before, at);
            check_begins(after.x, before.x);
            check_ids(before, after);
            CHECK(after.faces == before.faces);
            check_conforming(after);
            check_near(after.x, straight_sided(after));
            CHECK(total_volume(after) == doctest::Approx(total_volume(before)).epsilon(1e-13));
            for (int e = 0; e < after.element_count(); ++e) {
                CHECK(volume(after, after.x, e) > 0);
                const std::set<int> vertices(after.element(e), after.element(e) + after.dim + 1);
                for (const Simplex& s : at)
                    CHECK(!std::includes(vertices.begin(), vertices.end(), s.begin(), s.end()));
            }
            CHECK(all_inner(after).empty());
        }
}

TEST_CASE("one edge divides the elements around it, and a face those on both sides") {
    CHECK(split(square_mesh(1), {{0, 3}}).element_count() == 4);
    CHECK(split(cube_mesh(1), {{0, 7}}).element_count() == 12);
    const Mesh cube = split(cube_of_five(), {{1, 2, 4}});
    CHECK(cube.element_count() == 9);
    CHECK(cube.nodes() == 9);
    for (int a = 0; a < 3; ++a) CHECK(cube.x[24 + a] == doctest::Approx(1.0 / 3));
}

TEST_CASE("a curved mesh keeps its shape: new nodes are where its own map has them") {
    for (const Mesh& linear : {square_mesh(2), cube_of_five(), cube_mesh(1)})
        for (const int degree : {2, 3}) {
            const auto bend = [&](double* x) {  // of that degree
                const double y = x[1];
                x[0] += 0.1 * (degree == 2 ? y * y : y * y * y);
                x[1] += 0.1 * x[linear.dim - 1] * y;
            };
            const Mesh straight = raise_degree(linear, degree);
            Mesh curved = straight;
            curved.x = mapped(straight, bend);
            const std::vector<Simplex> at = all_inner(straight);
            const Mesh expected = split(straight, at), after = split(curved, at);
            CHECK(after.elements == expected.elements);
            check_near(after.x, mapped(expected, bend));
        }
}

TEST_CASE("cells of the file inside the mesh are split with it") {
    for (const int dim : {2, 3})
        for (const int degree : {1, 2, 3}) {
            const Mesh before = with_kept_cells(dim, degree);
            REQUIRE(before.kept[1].count() == 1);
            REQUIRE(before.kept[dim].count() == 1);
            const Mesh after = split(before, all_inner(before));
            check_ids(before, after);
            CHECK(after.kept[1].physical == std::vector<int>{7, 7});
            CHECK(after.kept[dim].physical == std::vector<int>{8, 8});
            CHECK(after.kept[1].nodes.size() == 2 * (degree + 1));
            for (int c = 0; c < 2; ++c) {  // evenly spaced from one end to the middle of the diagonal
                const int* const node = &after.kept[1].nodes[offset(c, degree + 1)];
                const auto at = [&](int i) { return after.x[offset(node[i], dim)]; };
                CHECK(std::abs(at(1) - at(0)) == doctest::Approx(0.5));
                for (int k = 1; k < degree; ++k)
                    CHECK(at(k + 1) == doctest::Approx(at(0) + k * (at(1) - at(0)) / degree));
                const int* const again = &after.kept[dim].nodes[offset(c, after.element_nodes())];
                const int* const element = after.element(after.kept[dim].element[c]);
                CHECK(std::set<int>(again, again + after.element_nodes()) ==
                      std::set<int>(element, element + after.element_nodes()));
            }
            CHECK(after.kept[dim].element[0] != after.kept[dim].element[1]);
        }
}

TEST_CASE("a mesh that is split, refined or raised has other nodes than its file") {
    Mesh mesh = square_mesh(1);
    mesh.file.coordinates.first.resize(mesh.x.size());
    CHECK(raise_degree(mesh, 1).file.can_be_patched());
    for (const Mesh& other : {split(mesh, {{0, 3}}), refine(mesh, 1), raise_degree(mesh, 2)})
        CHECK(!other.file.can_be_patched());
}
