#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "base/error.hpp"
#include "io/mesh_format.hpp"
#include "io/msh.hpp"
#include "mesh/build.hpp"
#include "support/msh_formats.hpp"
#include "support/sample_mesh.hpp"

using namespace almesh;
using test::msh_text;

namespace {

Mesh sample(int dim, int degree) {
    std::vector<std::string> notes;
    return build_mesh(SampleMesh(dim, degree, 2).raw, notes);
}

// Positions whose decimals are long.
std::vector<double> moved(const Mesh& mesh) {
    std::vector<double> x = mesh.x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 1e-3 * std::sin(static_cast<double>(i)) / 3;
    return x;
}

Mesh read_back(const std::string& text) {
    std::vector<std::string> notes;
    Mesh mesh = build_mesh(parse_msh(text, "written.msh"), notes);
    CHECK(notes.empty());
    return mesh;
}

// Node ids of each cell by the cell's id.
std::map<long long, std::vector<long long>> cells_by_id(const Mesh& mesh, const std::vector<int>& node,
                                                        const std::vector<long long>& id) {
    std::map<long long, std::vector<long long>> cells;
    const std::size_t size = node.size() / id.size();
    for (std::size_t k = 0; k < node.size(); ++k) cells[id[k / size]].push_back(mesh.file.node_id[node[k]]);
    return cells;
}

std::map<long long, std::pair<int, int>> tags_by_id(const std::vector<long long>& id, const std::vector<int>& physical,
                                                    const std::vector<int>& entity) {
    std::map<long long, std::pair<int, int>> tags;
    for (std::size_t k = 0; k < id.size(); ++k) tags[id[k]] = {physical[k], entity[k]};
    return tags;
}

std::map<long long, std::vector<double>> positions_by_id(const Mesh& mesh, const std::vector<double>& x) {
    std::map<long long, std::vector<double>> positions;
    for (std::size_t k = 0; k < x.size(); ++k) positions[mesh.file.node_id[k / mesh.dim]].push_back(x[k]);
    return positions;
}

}  // namespace

TEST_CASE("what is written reads back with the same ids, tags, names and bits") {
    for (int dim : {2, 3})
        for (int degree = 1; degree <= (dim == 2 ? 7 : 4); ++degree) {
            CAPTURE(dim);
            CAPTURE(degree);
            const Mesh mesh = sample(dim, degree);
            const std::vector<double> x = moved(mesh);
            const Mesh back = read_back(msh_text(mesh, x));
            CHECK(back.degree == degree);
            CHECK(positions_by_id(back, back.x) == positions_by_id(mesh, x));
            CHECK(cells_by_id(back, back.elements, back.file.element_id) ==
                  cells_by_id(mesh, mesh.elements, mesh.file.element_id));
            CHECK(cells_by_id(back, back.faces, back.file.face_id) ==
                  cells_by_id(mesh, mesh.faces, mesh.file.face_id));
            CHECK(tags_by_id(back.file.element_id, back.file.element_physical, back.file.element_entity) ==
                  tags_by_id(mesh.file.element_id, mesh.file.element_physical, mesh.file.element_entity));
            CHECK(tags_by_id(back.file.face_id, back.file.face_physical, back.file.face_entity) ==
                  tags_by_id(mesh.file.face_id, mesh.file.face_physical, mesh.file.face_entity));
            REQUIRE(back.file.groups.size() == 2);
            CHECK(back.file.groups[0].name == "left");
            CHECK(back.file.groups[1].dim == dim);
            CHECK(back.file.node_id == mesh.file.node_id);  // and the same order
        }
}

TEST_CASE("an MSH 2.2 file to the letter") {
    RawMesh raw;
    raw.nodes = {{1, {0, 0, 0}, 0}, {4, {0.1, 0, 0}, 0}, {2, {0, 1e-5, 0}, 0}};
    for (int k = 0; k < 3; ++k) append_element(raw, 1, 7, {k, (k + 1) % 3});
    append_element(raw, 2, 0, {0, 1, 2});
    raw.groups = {{1, 7, "the wall"}};
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(msh_text(mesh, mesh.x) == R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
1 7 "the wall"
$EndPhysicalNames
$Nodes
3
1 0 0 0
4 0.1 0 0
2 0 1e-05 0
$EndNodes
$Elements
4
1 1 2 7 0 1 4
2 1 2 7 0 4 2
3 1 2 7 0 2 1
4 2 2 0 0 1 4 2
$EndElements
)");
}

TEST_CASE("where ids and tags are as large as numbers get, free ones are found for what is new") {
    Mesh mesh = sample(2, 1);
    constexpr int last = std::numeric_limits<int>::max();
    std::fill(mesh.file.face_entity.begin(), mesh.file.face_entity.end(), last);
    mesh.file.node_id.back() = std::numeric_limits<long long>::max();
    const Mesh raised = raise_degree(mesh, 2), back = read_back(msh_text(raised, raised.x));
    CHECK(back.nodes() == raised.nodes());
    CHECK(*std::min_element(back.file.node_id.begin(), back.file.node_id.end()) == 1);
    CHECK(back.file.face_entity == mesh.file.face_entity);
}

TEST_CASE("elements without a physical group stay without one") {
    Mesh mesh = sample(3, 1);
    std::fill(mesh.file.element_physical.begin(), mesh.file.element_physical.end(), 0);
    CHECK(read_back(msh_text(mesh, mesh.x)).file.element_physical == mesh.file.element_physical);
}

TEST_CASE("to a file, and to a place where none can be") {
    const Mesh mesh = sample(2, 1);
    const auto path = std::filesystem::temp_directory_path() / ("almesh_msh_writer_test_" + std::to_string(getpid()));
    write_msh(path.string(), mesh, mesh.x);
    CHECK(read_mesh(path.string()).nodes.size() == 9);
    std::filesystem::remove(path);
    CHECK_THROWS_AS(write_msh("/no/such/folder/a.msh", mesh, mesh.x), InputError);
}

TEST_CASE("every version, text and binary, is read as the same mesh") {
    for (const int version : {22, 41})
        for (const bool binary : {false, true})
            for (const int dim : {2, 3})
                for (const int degree : {1, 2, 4}) {
                    CAPTURE(version);
                    CAPTURE(binary);
                    const FileFormat format{.msh_version = version, .binary = binary};
                    const Mesh mesh = sample(dim, degree);
                    const std::vector<double> x = moved(mesh);
                    const std::string text = msh_text(mesh, x, format);
                    const Mesh back = read_back(text);
                    CHECK(back.file.format == format);
                    CHECK(positions_by_id(back, back.x) == positions_by_id(mesh, x));
                    CHECK(cells_by_id(back, back.elements, back.file.element_id) ==
                          cells_by_id(mesh, mesh.elements, mesh.file.element_id));
                    CHECK(tags_by_id(back.file.face_id, back.file.face_physical, back.file.face_entity) ==
                          tags_by_id(mesh.file.face_id, mesh.file.face_physical, mesh.file.face_entity));
                }
}
