#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "geometry/patch.hpp"
#include "geometry/face_patches.hpp"
#include "mesh/build.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/kept_cells.hpp"
#include "mesh/part.hpp"
#include "mesh/sides.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Mesh built(const RawMesh& raw) {
    std::vector<std::string> notes;
    return build_mesh(raw, notes);
}

std::string refusal(const RawMesh& raw) {
    try {
        built(raw);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// Sum of the mean normals of the faces, zero where they close; area: sum of their lengths, of plane faces.
Vec<3> sum_of_normals(const Mesh& mesh, double* area = nullptr) {
    Vec<3> sum{};
    for (int f = 0; f < mesh.face_count(); ++f) {
        const auto vertices = static_cast<int>(mesh.face_vertices(f).size());
        const Vec<3> n = 0.5 * flat_normal(positions(mesh, mesh.x, mesh.face(f), vertices), 2, vertices);
        sum = sum + n;
        if (area) *area += length(n);
    }
    return sum;
}

void check_faces(const Mesh& mesh) {
    const SideNodes nodes(3, mesh.degree);
    std::vector<int> covered(mesh.faces.size(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int e = mesh.face_element[f], side = side_number(mesh, e, mesh.face_vertices(f));
        REQUIRE(side >= 0);
        std::vector<int> of_side;
        for (const int k : nodes.of(mesh.cell(e), side)) of_side.push_back(mesh.element(e)[k]);
        CHECK(of_side == std::vector<int>(mesh.face(f), mesh.face(f) + mesh.face_nodes(f)));
    }
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        CHECK(mesh.face(f) <= &mesh.faces[k]);
        CHECK(&mesh.faces[k] < mesh.face(f) + mesh.face_nodes(f));
        ++covered[k];
    });
    CHECK(covered == std::vector<int>(mesh.faces.size(), 1));
}

// Elements of the given type with these nodes, numbered from 0, which lie at the corners of cubes; tags 1.
RawMesh raw_of(const std::vector<std::pair<const CellType*, std::vector<int>>>& elements) {
    RawMesh raw;
    raw.path = "small.msh";
    constexpr double x[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1},
                               {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};
    for (const double* const at : x)
        raw.nodes.push_back({static_cast<long long>(raw.nodes.size()) + 1, {at[0], at[1], at[2]}, 0});
    for (const auto& [cell, nodes] : elements) {
        raw.elements.push_back({static_cast<long long>(raw.elements.size()) + 1, raw.element_nodes.size(), 0, cell->dim,
                                1, 1, 0, cell});
        raw.element_nodes.insert(raw.element_nodes.end(), nodes.begin(), nodes.end());
    }
    return raw;
}

}  // namespace

TEST_CASE("boundary faces of solids are triangles and quadrilaterals, those of one type together") {
    for (const char* const layers : {"hh", "pp", "hdp", "hdpuh"})
        for (const int degree : {1, 2, 3}) {
            CAPTURE(layers);
            const Mesh mesh = raise_degree(built(solid_block(2, layers, 0.1)), degree);
            const int height = static_cast<int>(std::string(layers).size());
            check_faces(mesh);
            double area = 0;
            CHECK(length(sum_of_normals(mesh, &area)) < 1e-14);
            CHECK(area == doctest::Approx(2 + 2 * height));
            const std::string name = layers;
            const int triangles = name == "pp" ? 16 : name == "hdp" ? 8 : 0;
            const std::vector<ElementGroup> groups = mesh.face_groups();
            REQUIRE(groups.size() == (triangles ? 2 : 1));
            if (triangles) CHECK(groups[0].count == triangles);
            CHECK(groups.back().cell == &quadrilateral());
            CHECK(groups.back().count == 8 * height + (triangles == 16 ? 0 : triangles == 8 ? 4 : 8));
            CHECK(mesh.face_nodes(mesh.face_count() - 1) == (degree + 1) * (degree + 1));
            for (const char* const boundary : {"bottom", "top", "sides"}) CHECK(mesh.boundary_index(boundary) >= 0);
        }
}

TEST_CASE("refined faces of solids are faces of refined solids, and keep their boundaries") {
    const Mesh mesh = built(solid_block(1, "hdp", 0)), fine = refine(mesh, 1);
    check_faces(fine);
    CHECK(fine.face_count() == 4 * mesh.face_count());
    double area = 0;
    CHECK(length(sum_of_normals(fine, &area)) < 1e-14);
    CHECK(area == doctest::Approx(14));
    for (int f = 0; f < fine.face_count(); ++f) {
        CHECK(fine.face_boundary[f] == mesh.face_boundary[f / 4]);
        CHECK(unit_normal(fine, f)[2] == doctest::Approx(unit_normal(mesh, f / 4)[2]));
    }
}

TEST_CASE("a part of a mixed mesh is closed by faces of both types") {
    const Mesh mesh = raise_degree(built(solid_block(2, "hdpuh", 0.1)), 2);
    std::vector<char> chosen(mesh.element_count(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        chosen[e] = &mesh.cell(e) == &prism() || &mesh.cell(e) == &hexahedron();
    const MeshPart part = part_of(mesh, chosen, "cut");
    check_faces(part);
    CHECK(length(sum_of_normals(part)) < 1e-13);
    CHECK(part.face_groups().size() == 2);
    int cut = 0;
    for (int f = 0; f < part.face_count(); ++f) cut += part.face_boundary[f] == part.cut();
    CHECK(cut == 2 * 4 + 2 * 8);
}

TEST_CASE("quadrilateral faces inside the mesh are kept, or made a boundary") {
    RawMesh raw = raw_of({{&hexahedron(), {0, 1, 2, 3, 4, 5, 6, 7}}, {&hexahedron(), {4, 5, 6, 7, 8, 9, 10, 11}},
                          {&quadrilateral(), {6, 5, 4, 7}}, {&quadrilateral(), {3, 2, 1, 0}}});
    raw.groups = {{2, 1, "wall"}};
    Mesh mesh = built(raw);
    REQUIRE(mesh.kept[4].count() == 1);
    CHECK(mesh.kept[4].nodes == std::vector<int>{6, 5, 4, 7});
    CHECK(raise_degree(mesh, 3).kept[4].nodes.size() == 16);
    const Mesh cubic = raise_degree(mesh, 3);
    for (const int node : cubic.kept[4].nodes) CHECK(cubic.x[3 * node + 2] == doctest::Approx(1));
    for (int i = 0; i < 16; ++i) CHECK(cubic.x[3 * cubic.face(0)[i] + 2] == 0);
    make_inner_boundaries(mesh, {"wall"}, {});
    check_faces(mesh);
    CHECK(mesh.kept[4].count() == 0);
    CHECK(std::count(mesh.inner.begin(), mesh.inner.end(), 1) == 1);
    CHECK(mesh.face_count() == 11);
}

TEST_CASE("quadrilaterals around whose vertices no face of the mesh goes in this order are left out") {
    std::vector<int> between = {4, 5, 6, 7};
    do {
        std::vector<int> outside;
        for (const int node : between) outside.push_back(node - 4);
        RawMesh raw = raw_of({{&hexahedron(), {0, 1, 2, 3, 4, 5, 6, 7}}, {&hexahedron(), {4, 5, 6, 7, 8, 9, 10, 11}},
                              {&quadrilateral(), between}, {&quadrilateral(), outside}});
        raw.elements.back().physical = 0;
        const bool is_face = between[0] % 2 == between[2] % 2;  // these are across from each other
        CAPTURE(between[1]);
        CAPTURE(between[2]);
        std::vector<std::string> notes;
        Mesh mesh = build_mesh(raw, notes);
        CHECK(mesh.kept[4].count() == (is_face ? 1 : 0));
        CHECK(std::count(mesh.file.face_id.begin(), mesh.file.face_id.end(), 4) == (is_face ? 1 : 0));
        CHECK(has(notes.back(), "that are no edge or face of the mesh left out") == !is_face);
    } while (std::next_permutation(between.begin(), between.end()));
}

TEST_CASE("the first element that is turned, or has no volume, is the first one in the file") {
    std::vector<std::string> notes;
    build_mesh(raw_of({{&hexahedron(), {4, 5, 6, 7, 0, 1, 2, 3}}, {&simplex(3), {8, 9, 11, 4}}}), notes);
    CHECK(has(notes.back(), "2 elements with negative orientation turned, the first is element 1"));
    CHECK(has(refusal(raw_of({{&hexahedron(), {0, 1, 2, 3, 0, 1, 2, 3}}, {&simplex(3), {8, 9, 10, 11}}})),
              "element 1 with the vertices 1, 2, 3, 4, 1, 2, 3, 4 has no volume, the first of 2 such elements"));
}

TEST_CASE("a quadrilateral on the four vertices of a tetrahedron is no face of it") {
    RawMesh raw = raw_of({{&simplex(3), {0, 1, 3, 4}}, {&quadrilateral(), {0, 1, 3, 4}}});
    raw.elements.back().physical = 0;
    CHECK(built(raw).kept[4].count() == 0);
}

TEST_CASE("faces that do not match are refused with both elements") {
    const std::vector<int> below = {0, 1, 2, 3, 4, 5, 6, 7};
    const std::string hanging = refusal(raw_of({{&hexahedron(), below}, {&prism(), {4, 5, 6, 8, 9, 10}}}));
    CHECK(has(hanging, "element 2 has the face with the nodes"));
    CHECK(has(hanging, "of element 1: faces must match; put a pyramid"));
    const std::string one_half = refusal(raw_of({{&hexahedron(), below}, {&simplex(3), {5, 6, 7, 9}}}));
    CHECK(has(one_half, "half of the face"));
    CHECK(refusal(raw_of({{&hexahedron(), below}, {&pyramid(), {4, 5, 6, 7, 9}}})).empty());
    RawMesh twisted = raw_of({{&hexahedron(), below}, {&pyramid(), {4, 6, 5, 7, 9}}});
    twisted.nodes[6].x[0] = twisted.nodes[6].x[1] = 3;
    const std::string crossed = refusal(twisted);
    CHECK(has(crossed, "of a common face in different orders around it"));
    const std::string tagged = refusal(raw_of({{&hexahedron(), below}, {&quadrilateral(), {0, 2, 1, 3}}}));
    CHECK(has(tagged, "in another order around it"));
}
