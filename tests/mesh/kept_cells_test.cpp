#include "mesh/kept_cells.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.hpp"
#include "mesh/build.hpp"
#include "support/sample_mesh.hpp"

using namespace almesh;

namespace {

using Strings = std::vector<std::string>;

int node_at(const RawMesh& raw, double x, double y, double z) {
    for (std::size_t i = 0; i < raw.nodes.size(); ++i)
        if (raw.nodes[i].x[0] == x && raw.nodes[i].x[1] == y && raw.nodes[i].x[2] == z) return static_cast<int>(i);
    return -1;
}

// The cube of 2 x 2 x 2 boxes in degree 1, or the square, with a point at the origin, the edge of the x axis as curve
// 5, and in 3D the face x = 1/2 inside as surface 6.
RawMesh sample_with_cells(int dim) {
    RawMesh raw = SampleMesh(dim, 1, 2).raw;
    const auto at = [&raw](double x, double y, double z) { return node_at(raw, x, y, z); };
    append_element(raw, 0, 4, {at(0, 0, 0)});
    if (dim == 3) append_element(raw, 1, 5, {at(1, 0, 0), at(0.5, 0, 0)});
    if (dim == 3) append_element(raw, 1, 5, {at(0.5, 0, 0), at(0, 0, 0)});
    if (dim == 3) append_element(raw, 2, 6, {at(0.5, 0, 0), at(0.5, 0.5, 0), at(0.5, 0.5, 0.5)});
    else append_element(raw, 1, 6, {at(0.5, 0, 0), at(0.5, 0.5, 0)});
    return raw;
}

Mesh build_quietly(const RawMesh& raw) {
    Strings notes;
    Mesh mesh = build_mesh(raw, notes);
    CHECK(notes == Strings{});
    return mesh;
}

void check_ids_are_unique(const Mesh& mesh) {
    std::multiset<long long> ids(mesh.file.element_id.begin(), mesh.file.element_id.end());
    ids.insert(mesh.file.face_id.begin(), mesh.file.face_id.end());
    for (const KeptCells& kept : mesh.kept) ids.insert(kept.id.begin(), kept.id.end());
    CHECK(std::set<long long>(ids.begin(), ids.end()).size() == ids.size());
}

double coordinate(const Mesh& mesh, int node, int axis) { return mesh.x[offset(node, mesh.dim, axis)]; }

// Length of the kept lines; their nodes are evenly spaced on the x axis from their first vertex to the second.
double length_of_axis(const Mesh& mesh) {
    double length = 0;
    const KeptCells& kept = mesh.kept[1];
    for (int c = 0; c < kept.count(); ++c) {
        const int* const node = &kept.nodes[offset(c, mesh.degree + 1)];
        const double from = coordinate(mesh, node[0], 0), to = coordinate(mesh, node[1], 0);
        length += from - to;
        for (int k = 2; k <= mesh.degree; ++k)
            CHECK(coordinate(mesh, node[k], 0) == doctest::Approx(from + (to - from) * (k - 1) / mesh.degree));
        for (int k = 0; k <= mesh.degree; ++k)
            for (int axis = 1; axis < mesh.dim; ++axis) CHECK(coordinate(mesh, node[k], axis) == 0);
    }
    return length;
}

}  // namespace

TEST_CASE("points, curves and faces inside survive refinement and higher degrees") {
    for (const int dim : {2, 3})
        for (const int refinements : {0, 1, 2})
            for (const int degree : {1, 2, 3, 4}) {
                const Mesh mesh = raise_degree(refine(build_quietly(sample_with_cells(dim)), refinements), degree);
                CAPTURE(refinements);
                CAPTURE(degree);
                CHECK(mesh.kept[0].count() == 1);
                CHECK(coordinate(mesh, mesh.kept[0].nodes[0], 0) + coordinate(mesh, mesh.kept[0].nodes[0], 1) == 0);
                CHECK(mesh.kept[0].physical == std::vector<int>{4});
                if (dim == 3) {
                    CHECK(mesh.kept[1].physical == std::vector<int>(2 << refinements, 5));
                    CHECK(length_of_axis(mesh) == 1);
                }
                const KeptCells& faces = mesh.kept[dim - 1];
                CHECK(faces.physical == std::vector<int>(std::size_t{1} << (refinements * (dim - 1)), 6));
                CHECK(faces.nodes.size() == offset(faces.count(), mesh.face_nodes(0)));
                for (const int node : faces.nodes) CHECK(coordinate(mesh, node, 0) == 0.5);
                const Subcells subcells(mesh);
                for (int c = 0; c < faces.count(); ++c) {
                    const auto first = faces.nodes.begin() + c * mesh.face_nodes(0);
                    CHECK(subcells.nodes(faces.element[c], &*first, simplex(dim - 1)) ==
                          std::vector<int>(first, first + mesh.face_nodes(0)));
                }
                check_ids_are_unique(mesh);
            }
}

TEST_CASE("a mesh of higher degree keeps the order in which the file has the nodes of a cell") {
    RawMesh raw = SampleMesh(3, 3, 1).raw;
    const auto element = std::find_if(raw.elements.begin(), raw.elements.end(),
                                      [](const RawElement& any) { return any.dim == 3; });
    const auto node = [&](int k) { return raw.element_nodes[element->first + k]; };
    append_element(raw, 1, 5, {node(1), node(0), node(5), node(4)});  // edge 0 backwards
    raw.elements.back().degree = 3;
    const Mesh mesh = build_quietly(raw);
    REQUIRE(mesh.kept[1].count() == 1);
    CHECK(mesh.kept[1].nodes == std::vector<int>{node(1), node(0), node(5), node(4)});
    const Mesh linear = linear_part(mesh);
    CHECK(linear.kept[1].nodes.size() == 2);
    CHECK(raise_degree(mesh, 4).kept[1].nodes.size() == 5);
}

TEST_CASE("a point without an element is none of a mesh that is written anew") {
    RawMesh raw = sample_with_cells(2);
    raw.nodes.push_back({500, {7, 8, 0}, 1});
    append_element(raw, 0, 3, {static_cast<int>(raw.nodes.size()) - 1});
    const Mesh mesh = refine(build_quietly(raw), 1);
    CHECK(mesh.file.loose == 1);
    CHECK(mesh.kept[0].physical == std::vector<int>{4});
}

TEST_CASE("curves and untagged faces that are not in the mesh are left out with a note") {
    RawMesh raw = sample_with_cells(3);
    const int last = static_cast<int>(raw.elements.size());
    const int* const first = &raw.element_nodes[raw.elements[last - 10].first];
    append_element(raw, 2, 0, {first[0], first[1], first[2]});  // a face inside the mesh, or on its boundary
    append_element(raw, 1, 5, {node_at(raw, 0, 0, 0), node_at(raw, 1, 0, 0)});  // over two edges
    append_element(raw, 1, 5, {0, 1});
    raw.elements.back().degree = 2;
    raw.element_nodes.push_back(2);
    append_element(raw, 1, 5, {0, 0});
    Strings notes;
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(mesh.kept[2].physical == std::vector<int>{6, 0});
    CHECK(mesh.kept[1].count() == 2);
    CHECK(notes == Strings{concat("3 elements of the file that are no edge or face of the mesh left out, the first is "
                                  "element ",
                                  last + 2, " (line ", 1000 + last + 1, ")")});
}

TEST_CASE("the boundary of a mesh without tagged faces has the ids and entities of the file's untagged ones") {
    RawMesh raw = sample_with_cells(2);
    for (RawElement& element : raw.elements)
        if (element.dim == 1) element.physical = 0;
    Strings notes;
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(notes.size() == 1);
    CHECK(mesh.kept[1].count() == 1);  // the one inside
    for (int f = 0; f < mesh.face_count(); ++f) CHECK(mesh.file.face_entity[f] / 10 == 2);
    check_ids_are_unique(mesh);
}
