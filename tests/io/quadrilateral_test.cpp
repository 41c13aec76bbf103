// Meshes of triangles and quadrilaterals in every format.
#include <doctest/doctest.h>

#include <map>

#include "base/index.hpp"
#include "io/foreign_cells.hpp"
#include "io/mesh_format.hpp"
#include "io/msh_samples.hpp"
#include "mesh/build.hpp"
#include "mesh/lagrange.hpp"
#include "support/msh_formats.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A cell on these vertices of 3 x 2 points on the plane, its nodes on a curved map of these.
struct MixedMesh : Mesh {
    explicit MixedMesh(int p, bool with_triangles = true) {
        degree = p;
        if (with_triangles) add_group(simplex(2), {{0, 1, 4}, {0, 4, 3}});
        else add_group(quadrilateral(), {{0, 1, 4, 3}});
        add_group(quadrilateral(), {{1, 2, 5, 4}});
        if (!with_triangles) groups = {{&quadrilateral(), 0, 2, 0}};
        for (const auto& [from, to] : {std::pair(0, 1), {1, 2}, {2, 5}, {5, 4}, {4, 3}, {3, 0}}) {
            append_nodes(faces, simplex(1), {from, to});
            face_boundary.push_back(from == 2);
            file.face_id.push_back(50 + from);
            file.face_physical.push_back(from == 2 ? 8 : 7);
            file.face_entity.push_back(file.face_physical.back());
        }
        face_element = {0, element_count() - 1, element_count() - 1, element_count() - 1, element_count() - 2,
                        element_count() - 2};
        boundaries = {"wall", "outlet"};
        file.groups = {{1, 7, "wall"}, {1, 8, "outlet"}, {2, 9, "inside"}};
        for (int e = 0; e < element_count(); ++e) file.element_id.push_back(10 + 3 * e);
        file.element_physical.assign(element_count(), 9);
        file.element_entity.assign(element_count(), 1);
        for (int i = 0; i < nodes(); ++i) file.node_id.push_back(i + 1);
    }

private:
    std::map<std::array<int, 2>, int> node_;

    void add_group(const CellType& cell, const std::vector<std::vector<int>>& cells) {
        const int first = groups.empty() ? 0 : groups.back().first + groups.back().count;
        groups.push_back({&cell, first, static_cast<int>(cells.size()), elements.size()});
        for (const std::vector<int>& vertices : cells) append_nodes(elements, cell, vertices);
    }

    void append_nodes(std::vector<int>& to, const CellType& cell, const std::vector<int>& vertices) {
        const LagrangeBasis linear(cell, 1), basis(cell, degree);
        for (int i = 0; i < basis.count; ++i) {
            std::vector<double> N(linear.count);
            linear.values(basis.point(i).data(), N.data());
            double at[2] = {};
            for (int v = 0; v < linear.count; ++v) {
                at[0] += N[v] * (vertices[v] % 3);
                at[1] += N[v] * (vertices[v] / 3);
            }
            const std::array<int, 2> key = {static_cast<int>(std::lround(420 * at[0])),
                                            static_cast<int>(std::lround(420 * at[1]))};
            const auto [it, is_new] = node_.try_emplace(key, nodes());
            if (is_new) x.insert(x.end(), {at[0] + 0.1 * at[1] * at[1], at[1] - 0.1 * at[0] * at[0]});
            to.push_back(it->second);
        }
    }
};

void check_nodes(const RawMesh& raw, const RawElement& element, const Mesh& mesh, const int* nodes) {
    REQUIRE(raw.element_nodes.size() >= element.first + element.node_count());
    for (int k = 0; k < element.node_count(); ++k)
        for (int a = 0; a < 2; ++a)
            CHECK(raw.nodes[raw.element_nodes[element.first + k]].x[a] == mesh.x[offset(nodes[k], 2, a)]);
}

// Elements and, where the format has them, boundary faces as in the mesh, in its order.
void check_same(const RawMesh& raw, const Mesh& mesh, bool with_faces = true) {
    CHECK(static_cast<int>(raw.nodes.size()) == mesh.nodes());
    int e = 0;
    std::map<std::string, int> faces;
    for (const RawElement& element : raw.elements) {
        CHECK(element.degree == mesh.degree);
        if (element.dim == 2) {
            CHECK(&element.cell() == &mesh.cell(e));
            check_nodes(raw, element, mesh, mesh.element(e++));
            continue;
        }
        const std::string group = group_name(raw.groups, 1, element.physical);
        for (int f = 0, before = faces[group]++; f < mesh.face_count(); ++f)
            if (mesh.boundaries[mesh.face_boundary[f]] == group && before-- == 0)
                check_nodes(raw, element, mesh, mesh.face(f));
    }
    CHECK(e == mesh.element_count());
    if (with_faces) CHECK(faces == std::map<std::string, int>{{"wall", 5}, {"outlet", 1}});
}

std::string su2_text(const Mesh& mesh) {
    const TemporaryFolder folder;
    write_su2(folder.path("a.su2"), mesh, mesh.x);
    return text_of(folder.path("a.su2"));
}

}  // namespace

TEST_CASE("quadrilaterals, alone or beside triangles, are read as they are written, in every format") {
    for (int degree = 1; degree <= 7; ++degree)
        for (const bool with_triangles : {false, true}) {
            const MixedMesh mesh(degree, with_triangles);
            std::vector<std::string> notes;
            CAPTURE(degree);
            for (const int version : {22, 41})
                for (const bool binary : {false, true}) {
                    const std::string text = msh_text(mesh, mesh.x, {.msh_version = version, .binary = binary});
                    const RawMesh raw = parse_mesh(text, "a.msh");
                    check_same(raw, mesh);
                    const Mesh built = build_mesh(raw, notes);
                    CHECK(notes.empty());
                    if (raw.format == FileFormat()) CHECK(msh_text(built, built.x) == text);
                    CHECK(raw.elements.back().id == mesh.file.element_id.back());
                    CHECK(raw.elements.back().physical == 9);
                }
            check_same(parse_mesh(su2_text(mesh), "a.su2"), mesh);
            for (const VtkFormat format : {VtkFormat::ascii, VtkFormat::binary})
                check_same(parse_mesh(vtk_text({"t", 2, degree, mesh.x, mesh.elements, 2, {},
                                                {{"id", 1, std::vector<double>(mesh.element_count())}}, {},
                                                mesh.groups}, format), "a.vtk"), mesh, false);
        }
}

TEST_CASE("the numbers of quadrilaterals in files") {
    const int msh[] = {3, 10, 36, 37, 38, 47, 48}, su2[] = {9, 109, 209, 309, 409, 509, 609};
    for (int degree = 1; degree <= 7; ++degree) {
        const MixedMesh mesh(degree);
        CHECK(has(msh_text(mesh, mesh.x), concat("\n16 ", msh[degree - 1], " 2 9 1 ")));
        CHECK(has(su2_text(mesh), concat("\n", su2[degree - 1], " ")));
    }
    const MixedMesh mesh(1);
    const std::string vtk = vtk_text({"t", 2, 1, mesh.x, mesh.elements, 2, {}, {}, {}, mesh.groups});
    CHECK(has(vtk, "CELLS 3 13\n3 0 1 2\n3 0 2 3\n4 1 4 5 2\nCELL_TYPES 3\n5\n5\n9\n"));
}

TEST_CASE("SU2's elements keep the order of the file, and of degree 2 and 3 have their nodes row by row") {
    CHECK(su2_node_order(simplex(2), 2) == std::vector<int>{0, 3, 1, 5, 4, 2});
    CHECK(su2_node_order(simplex(2), 3) == std::vector<int>{0, 3, 4, 1, 8, 9, 5, 7, 6, 2});
    CHECK(su2_node_order(quadrilateral(), 1) == std::vector<int>{0, 1, 2, 3});
    CHECK(su2_node_order(quadrilateral(), 2) == std::vector<int>{0, 4, 1, 7, 8, 5, 3, 6, 2});
    CHECK(su2_node_order(simplex(3), 2) == std::vector<int>{0, 4, 1, 6, 5, 2, 7, 9, 8, 3});
    MixedMesh mesh(1);
    mesh.file.element_id = {12, 13, 11};
    std::vector<std::string> notes;
    const std::string text = su2_text(mesh);
    CHECK(su2_text(build_mesh(parse_su2(text, "a.su2"), notes)) == text);
    CHECK(has(text, "NELEM= 3\n9 1 4 5 2 0\n5 0 1 2 1\n5 0 2 3 2\n"));
    const RawMesh raw = parse_su2("NDIME= 2\nNELEM= 1\n109 0 1 2 3 4 5 6 7 8 0\nNPOIN= 9\n0 0\n1 0\n2 0\n0 1\n1 1\n"
                                  "2 1\n0 2\n1 2\n2 2\nNMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 1\n103 0 1 2\n",
                                  "a.su2");
    CHECK(raw.elements[0].degree == 2);
    CHECK(raw.element_nodes == std::vector<int>{0, 2, 8, 6, 1, 5, 7, 3, 4, 0, 2, 1});
}

TEST_CASE("quadrilaterals of 8 nodes get a ninth one, with an id of its own") {
    const std::string nodes[] = {"0 0 0", "2 0 0", "2 2 0", "0 2 0", "1 0.5 0", "2 1 0", "1 2 0", "0 1 0"};
    std::string msh = "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n1 8\n1 1 0 8\n",
                vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n";
    for (int k = 0; k < 8; ++k) {
        msh += concat(11 + k, " ", nodes[k], "\n");
        vtk += nodes[k] + "\n";
    }
    msh += "$EndNodes\n$Elements\n1 1\n5 2 16 1\n1 11 12 13 14 15 16 17 18\n$EndElements\n";
    vtk += "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n23\n";
    for (const std::string& text : {msh, vtk}) {
        const RawMesh raw = parse_mesh(text, "a");
        CHECK(raw.elements[0].degree == 2);
        CHECK(raw.element_nodes == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8});
        CHECK(raw.nodes[8].id == raw.nodes[7].id + 1);
        CHECK(raw.nodes[8].x[0] == 1);
        CHECK(raw.nodes[8].x[1] == 1.25);
        CHECK(raw.notes == std::vector<std::string>{"1 quadrilateral of 8 nodes: completed to 9 each, by nodes in the "
                                                    "middle of faces and cells"});
    }
}
