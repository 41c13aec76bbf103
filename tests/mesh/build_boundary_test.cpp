#include "mesh/build_boundary.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/small_matrix.hpp"
#include "io/msh.hpp"
#include "mesh/build.hpp"
#include "support/meshes.hpp"
#include "support/sample_mesh.hpp"

using namespace almesh;
using namespace almesh::test;
using doctest::Approx;
using doctest::Contains;

namespace {

using Strings = std::vector<std::string>;

// Two triangles on the unit square, 1-2-3 and 1-3-4, elements 5 and 6; the edges 1 to 4 have tag 7.
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
    Strings notes;
    CHECK_THROWS_WITH_AS(build_mesh(raw, notes), Contains(message), InputError);
}

const double* position(const Mesh& mesh, int node) { return mesh.x.data() + static_cast<std::size_t>(node) * mesh.dim; }

// Volume of the simplex over face f with the given apex: positive where the apex is behind the face.
double volume_behind(const Mesh& mesh, int f, const double* apex) {
    const int* v = mesh.face(f);
    const auto d = [&](int k, int a) { return position(mesh, v[k])[a] - apex[a]; };
    if (mesh.dim == 2) return determinant(Mat<2>{{{d(0, 0), d(0, 1)}, {d(1, 0), d(1, 1)}}}) / 2;
    return determinant(
               Mat<3>{{{d(0, 0), d(0, 1), d(0, 2)}, {d(1, 0), d(1, 1), d(1, 2)}, {d(2, 0), d(2, 1), d(2, 2)}}}) /
           6;
}

}  // namespace

TEST_CASE("boundary faces look outward, whatever way the file turns them") {
    for (int dim : {2, 3})
        for (int degree = 1; degree <= 5; ++degree) {
            CAPTURE(dim);
            CAPTURE(degree);
            Strings notes;
            const Mesh mesh = build_mesh(SampleMesh(dim, degree, 2, true).raw, notes);
            REQUIRE(mesh.face_count() == (dim == 2 ? 8 : 48));
            const double centre[3] = {0.5, 0.5, 0.5};
            const std::vector<MultiIndex> order = gmsh_node_order(dim - 1, degree);
            double sum = 0, bend = 0;
            for (int f = 0; f < mesh.face_count(); ++f) {
                CHECK(volume_behind(mesh, f, centre) > 0);
                sum += volume_behind(mesh, f, centre);
                const int* element = mesh.element(mesh.face_element[f]);
                for (int i = 0; i < mesh.face_nodes(0); ++i) {
                    CHECK(std::count(element, element + mesh.element_nodes(), mesh.face(f)[i]) == 1);
                    for (int a = 0; a < dim; ++a) {
                        double difference = position(mesh, mesh.face(f)[i])[a];
                        for (int v = 0; v < dim; ++v)
                            difference -= order[i][v] * position(mesh, mesh.face(f)[v])[a] / degree;
                        bend = std::max(bend, std::abs(difference));
                    }
                }
            }
            CHECK(sum == Approx(1).epsilon(1e-14));  // divergence theorem: the faces close
            CHECK(bend < 1e-15);
        }
}

TEST_CASE("faces keep ids, tags and names") {
    for (int dim : {2, 3}) {
        Strings notes;
        const RawMesh raw = SampleMesh(dim, 2, 2).raw;
        const Mesh mesh = build_mesh(raw, notes);
        CHECK(mesh.boundaries == (raw.elements[0].physical == 1 ? Strings{"left", "tag 2"} : Strings{"tag 2", "left"}));
        for (int f = 0; f < mesh.face_count(); ++f) {
            const bool left = mesh.boundaries[mesh.face_boundary[f]] == "left";
            CHECK(mesh.file.face_id[f] == f + 1);
            CHECK(mesh.file.face_physical[f] == (left ? 1 : 2));
            CHECK(mesh.file.face_entity[f] == (left ? 21 : 22));
            for (int i = 0; i < mesh.face_nodes(0); ++i)
                if (left) CHECK(position(mesh, mesh.face(f)[i])[0] == 0);
        }
    }
}

TEST_CASE("two tags of one name are one boundary") {
    RawMesh raw = square();
    raw.elements[2].physical = 8;
    raw.groups = {{1, 7, "wall"}, {1, 8, "wall"}, {2, 7, "not this one"}};
    Strings notes;
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(mesh.boundaries == Strings{"wall"});
    CHECK(mesh.file.face_physical == std::vector<int>{7, 7, 8, 7});
}

TEST_CASE("boundary faces in no group are a boundary of their own, with a note") {
    RawMesh raw = square();
    raw.elements[1].physical = 0;
    raw.groups = {{1, 7, "wall"}};
    Strings notes;
    Mesh mesh = build_mesh(raw, notes);
    CHECK(notes == Strings{"1 boundary face in no group is the boundary \"untagged\", the first has the nodes 2, 3 and "
                           "the centre (1, 0.5)"});
    CHECK(mesh.boundaries == Strings{"wall", "untagged"});
    CHECK(mesh.file.face_id == std::vector<long long>{1, 3, 4, 2});
    // What is written has them as they came, in no group; a name that is taken gets another.
    raw.groups = {{1, 7, "untagged"}};
    notes.clear();
    mesh = build_mesh(raw, notes);
    CHECK(mesh.boundaries == Strings{"untagged", "untagged-2"});
    notes.clear();
    Strings same;
    const Mesh again = build_mesh(parse_msh(msh_text(mesh, mesh.x), "b.msh"), same);
    CHECK(same.size() == 1);
    CHECK(again.boundaries == mesh.boundaries);
    CHECK(again.file.face_physical == std::vector<int>{7, 7, 7, 0});
    CHECK(again.file.face_id == mesh.file.face_id);

    raw = SampleMesh(3, 1, 1).raw;
    bool first = true;
    for (RawElement& element : raw.elements)
        if (element.dim == 2 && !std::exchange(first, false)) element.physical = 0;
    build_mesh(raw, notes);
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find("11 boundary faces in no group are the boundary \"untagged\"") == 0);
}

TEST_CASE("boundary faces that lie on each other because nodes are not joined are told as such") {
    RawMesh raw = square();
    raw.nodes.push_back({9, {1, 1, 0}, 9});  // node 3 once more, of the second triangle
    raw.element_nodes[raw.elements[5].first + 1] = 4;
    raw.element_nodes[raw.elements[2].first] = 4;
    for (const bool tagged : {true, false}) {
        if (!tagged) std::erase_if(raw.elements, [](const RawElement& element) { return element.dim == 1; });
        Strings notes;
        build_mesh(raw, notes);
        REQUIRE(notes.size() == 2);
        CHECK(notes[1] == "of the boundary's faces, 1 pair lies on each other, as nodes 3, 9 are at one point: unless "
                          "the mesh is to be cut there, join such nodes (in gmsh: Coherence Mesh)");
    }
}

TEST_CASE("a tagged face of no element is left out, with a note") {
    RawMesh raw = square();
    append_element(raw, 1, 7, {1, 3});
    Strings notes;
    CHECK(build_mesh(raw, notes).face_count() == 4);
    CHECK(notes == Strings{"1 face of the file is the face of no triangle, the first is element 7 (line 1006): "
                           "left out"});
    raw.nodes.push_back({5, {2, 2, 0}, 9});
    append_element(raw, 1, 7, {4, 3});  // node 5 belongs to no element
    notes.clear();
    CHECK(build_mesh(raw, notes).face_count() == 4);
    CHECK(notes == Strings{"2 faces of the file are faces of no triangle, the first is element 7 (line 1006): "
                           "left out"});
}

TEST_CASE("faces in two groups are a boundary of both, and are written as they came") {
    RawMesh raw = square();
    append_element(raw, 1, 8, {1, 0});  // edge 1 once more, the other way round
    Strings notes;
    Mesh mesh = build_mesh(raw, notes);
    CHECK(notes.empty());
    CHECK(mesh.boundaries == Strings{"tag 7 + tag 8", "tag 7"});
    CHECK(mesh.boundary_groups == std::vector<Strings>{{"tag 7", "tag 8"}, {"tag 7"}});
    CHECK(mesh.boundaries_in("tag 7") == std::vector<char>{1, 1});
    CHECK(mesh.boundaries_in("tag 8") == std::vector<char>{1, 0});
    CHECK(mesh.file.face_id == std::vector<long long>{1, 2, 3, 4});
    CHECK(mesh.kept[1].nodes == std::vector<int>{1, 0});
    Mesh again = build_mesh(parse_msh(msh_text(mesh, mesh.x), "b.msh"), notes);
    CHECK(again.boundary_groups == std::vector<Strings>{{"tag 7", "tag 8"}, {"tag 7"}});
    CHECK(again.kept[1].id == std::vector<long long>{7});

    raw.elements.back().physical = 7;  // the same face twice
    mesh = build_mesh(raw, notes);
    CHECK(mesh.boundaries == Strings{"tag 7"});
    CHECK(mesh.kept[1].id == std::vector<long long>{7});

    raw = square();  // by the curve, as in MSH 4
    raw.elements[3].entity = 4;
    raw.entities = {{{1, 4}, {7, 8}}};
    CHECK(build_mesh(raw, notes).boundary_groups == std::vector<Strings>{{"tag 7"}, {"tag 7", "tag 8"}});
    CHECK(notes.empty());
}

TEST_CASE("tagged faces inside the mesh are kept beside its boundary") {
    RawMesh raw = square();
    append_element(raw, 1, 8, {0, 2});
    Strings notes;
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(mesh.face_count() == 4);
    CHECK(mesh.kept[1].nodes == std::vector<int>{0, 2});
    CHECK(mesh.kept[1].physical == std::vector<int>{8});
    CHECK(notes.empty());
}

TEST_CASE("elements in two groups are there once, and are written as they came") {
    RawMesh raw = square();
    append_element(raw, 2, 10, {2, 0, 1});
    append_element(raw, 2, 11, {0, 2, 1});  // turned
    Strings notes;
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(mesh.element_count() == 2);
    CHECK(notes == Strings{"2 elements given more than once, the first is element 7 (line 1006)"});
    CHECK(mesh.kept[2].nodes == std::vector<int>{2, 0, 1, 0, 2, 1});
    CHECK(mesh.kept[2].element == std::vector<int>{0, 0});
    CHECK(mesh.kept[2].physical == std::vector<int>{10, 11});
    const Mesh fine = refine(mesh, 1);
    CHECK(fine.kept[2].count() == 8);
    CHECK(fine.kept[2].element == std::vector<int>{0, 1, 2, 3, 0, 1, 2, 3});
    const Mesh curved = raise_degree(mesh, 3);
    notes.clear();
    const Mesh again = build_mesh(parse_msh(msh_text(curved, curved.x), "b.msh"), notes);
    CHECK(again.kept[2].count() == 2);
    CHECK(again.element_count() == 2);
}

TEST_CASE("faces of three elements are refused") {
    RawMesh raw = square();
    raw.nodes.push_back({5, {0.2, 0.8, 0}, 9});
    append_element(raw, 2, 9, {0, 2, 4});
    check_refused(raw,
                  "element 7 is the third at the face with the nodes 1, 3, after element 5 (line 1004) and element 6");
}

TEST_CASE("neighbours and their boundary share all nodes of a face") {
    // Two P2 triangles: the node in the middle of the diagonal, or of the first edge, gets a copy.
    for (bool boundary : {false, true}) {
        RawMesh raw = SampleMesh(2, 2, 1).raw;
        const int copy = static_cast<int>(raw.nodes.size());
        const RawElement& changed = boundary ? raw.elements.front() : raw.elements.back();
        const auto begin = raw.element_nodes.begin() + static_cast<std::ptrdiff_t>(changed.first);
        const auto node = boundary ? begin + 2 : std::find_if(begin, begin + 6, [&](int i) {
            return raw.nodes[i].x[0] == 0.5 && raw.nodes[i].x[1] == 0.5;
        });
        raw.nodes.push_back(raw.nodes[*node]);
        raw.nodes.back().id = 9999;
        *node = copy;
        check_refused(raw,
                      boundary ? "has the vertices of a face of element" : "share the vertices of a face, but not");
    }
}

TEST_CASE("large meshes report the same first error, and all there is to count, for any number of threads") {
    const RawMesh good = SampleMesh(3, 1, 9).raw;  // 1000 nodes
    RawMesh twice = good, third = good, untagged = good, inside = good;
    const auto node = [&good](int tetrahedron) { return &good.element_nodes[good.elements[tetrahedron + 972].first]; };
    for (const int k : {400, 40, 4000}) append_element(twice, 3, 9, {node(k), node(k) + 4});
    for (const int k : {400, 40, 4000}) append_element(third, 3, 9, {node(k)[0], node(k)[1], node(k)[2], node(k + 90)[3]});
    for (const int k : {1212, 2184, 3156}) append_element(inside, 2, 9, {node(k), node(k) + 3});
    bool first = true;
    for (RawElement& element : untagged.elements)
        if (element.dim == 2 && !std::exchange(first, false)) element.physical = 0;
    const int before = max_threads();
    for (const int threads : {1, 2, 3, 5}) {
        set_threads(threads);
        check_refused(third, "is the third at the face with the nodes");
        Strings notes;
        CHECK(build_mesh(twice, notes).kept[3].id == std::vector<long long>{5347, 5348, 5349});
        build_mesh(untagged, notes);
        REQUIRE(notes.size() == 2);
        CHECK(notes[0] == "3 elements given more than once, the first is element 5347 (line 6346)");
        CHECK(notes[1].find("971 boundary faces in no group are the boundary \"untagged\"") == 0);
        notes.clear();
        CHECK(build_mesh(inside, notes).kept[2].id == std::vector<long long>{5347, 5348, 5349});
        CHECK(notes.empty());
    }
    set_threads(before);
}

TEST_CASE("the same mesh for any number of threads") {
    Strings notes;
    const RawMesh raw = SampleMesh(3, 1, 6, true).raw;
    const int before = max_threads();
    set_threads(1);
    const Mesh mesh = build_mesh(raw, notes);
    for (int threads : {2, 3, 5}) {
        set_threads(threads);
        const Mesh other = build_mesh(raw, notes);
        CHECK(other.elements == mesh.elements);
        CHECK(other.faces == mesh.faces);
        CHECK(other.face_element == mesh.face_element);
    }
    set_threads(before);
}

TEST_CASE("a mesh without tagged faces has the boundary of its elements, in connected parts") {
    for (const bool ring : {true, false}) {
        Mesh mesh = ring ? ring_mesh(12, 3, 6) : cube_mesh(2);
        RawMesh raw = parse_msh(msh_text(mesh, mesh.x), "a.msh");
        for (RawElement& element : raw.elements)
            if (element.dim < mesh.dim) element.physical = 0;
        Strings notes;
        const Mesh built = build_mesh(raw, notes);
        CHECK(built.face_count() == mesh.face_count());
        REQUIRE(notes.size() == 1);
        if (ring) {
            CHECK(built.boundaries == Strings{"boundary-1", "boundary-2"});
            CHECK(notes[0] == "no tagged boundary faces: the boundary is that of the elements, in parts: "
                              "boundary-1 (12 faces), boundary-2 (12 faces)");
        } else {
            CHECK(built.boundaries == Strings{"boundary"});
        }
        // What is written has the faces as they came, in no group.
        Strings none;
        const Mesh again = build_mesh(parse_msh(msh_text(built, built.x), "b.msh"), none);
        CHECK(none == notes);
        CHECK(again.boundaries == built.boundaries);
        CHECK(volume(again, again.x) == doctest::Approx(volume(mesh, mesh.x)));
    }
}
