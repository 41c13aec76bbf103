// Files without physical groups, whose entities are names; and groups that a file does not have, which none gets.
#include <doctest/doctest.h>

#include "base/error.hpp"
#include "mesh/inner_boundary.hpp"
#include "support/meshes.hpp"
#include "support/msh_formats.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;
using doctest::Contains;

namespace {

using Strings = std::vector<std::string>;

// 3 x 3 quadrilaterals: the inner one is surface 1 with the curves 5 to 8 around it, the others are surface 2 with the
// curves 1 to 4.
std::string plate() {
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n16\n";
    for (int i = 0; i < 16; ++i) text += concat(i + 1, " ", i % 4, " ", i / 4, " 0\n");
    text += "$EndNodes\n$Elements\n25\n";
    const int around[] = {1, 2, 3, 4, 8, 12, 16, 15, 14, 13, 9, 5, 1}, inside[] = {6, 7, 11, 10, 6};
    int id = 0;
    for (int k = 0; k < 12; ++k) text += concat(++id, " 1 2 0 ", k / 3 + 1, " ", around[k], " ", around[k + 1], "\n");
    for (int k = 0; k < 4; ++k) text += concat(++id, " 1 2 0 ", k + 5, " ", inside[k], " ", inside[k + 1], "\n");
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            const int corner = 4 * j + i + 1;
            text += concat(++id, " 3 2 0 ", i == 1 && j == 1 ? 1 : 2, " ", corner, " ", corner + 1, " ", corner + 5,
                           " ", corner + 4, "\n");
        }
    return text + "$EndElements\n";
}

Strings names(const std::vector<GroupCells>& groups) {
    Strings sorted = names_of(groups);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

Mesh built(const std::string& text) {
    std::vector<std::string> notes;
    return build_mesh(parse_mesh(text, "a.msh"), notes);
}

}  // namespace

TEST_CASE("a file without physical groups: curves, surfaces and volumes are names, and none is written") {
    const Mesh mesh = built(plate());
    CHECK(mesh.boundaries == Strings{"curve 1", "curve 2", "curve 3", "curve 4"});
    CHECK(names(inner_groups(mesh)) == Strings{"curve 5", "curve 6", "curve 7", "curve 8"});
    CHECK(names(volume_groups(mesh)) == Strings{"surface 1", "surface 2"});
    for (const Mesh& one : {mesh, refine(mesh, 1), raise_degree(mesh, 2)})
        for (const int version : {22, 41})
            for (const bool binary : {false, true}) {
                const std::string text = msh_text(one, one.x, {.msh_version = version, .binary = binary});
                CHECK(!has(text, "$PhysicalNames"));
                const RawMesh raw = parse_mesh(text, "b.msh");
                for (const PhysicalGroup& group : raw.groups) CHECK(group.is_entity);
                const Mesh again = built(text);
                CHECK(again.boundaries == mesh.boundaries);
                CHECK(names(inner_groups(again)) == names(inner_groups(mesh)));
                CHECK(names(volume_groups(again)) == names(volume_groups(mesh)));
            }
    Mesh cube = cube_mesh(2);
    cube.file.groups.clear();
    std::fill(cube.file.face_physical.begin(), cube.file.face_physical.end(), 0);
    std::fill(cube.file.face_entity.begin(), cube.file.face_entity.end(), 3);
    std::fill(cube.file.element_physical.begin(), cube.file.element_physical.end(), 0);
    std::fill(cube.file.element_entity.begin(), cube.file.element_entity.end(), 2);
    for (const int version : {22, 41}) {
        const Mesh again = built(msh_text(cube, cube.x, {.msh_version = version}));
        CHECK(again.boundaries == Strings{"surface 3"});
        CHECK(names(volume_groups(again)) == Strings{"volume 2"});
    }
}

TEST_CASE("entities are names only where the file has no group of that dimension, and only those that have a number") {
    std::string text = plate();
    text.replace(text.find("1 1 2 0 1 1 2"), 13, "1 1 2 9 1 1 2");
    const Mesh grouped = built(text);
    CHECK(grouped.boundaries == Strings{"tag 9", "untagged"});
    CHECK(names(inner_groups(grouped)).empty());
    CHECK(names(volume_groups(grouped)) == Strings{"surface 1", "surface 2"});
    text = plate();
    text.replace(text.find("1 1 2 0 1 1 2"), 13, "1 1 2 0 0 1 2");
    CHECK(built(text).boundaries == Strings{"curve 1", "curve 2", "curve 3", "curve 4", "untagged"});
    const std::string with_names = "$PhysicalNames\n1\n1 3 \"unused\"\n$EndPhysicalNames\n$Nodes\n";
    text = plate();
    text.replace(text.find("$Nodes\n"), 7, with_names);
    CHECK(built(text).boundaries == Strings{"boundary"});
}

TEST_CASE("entities in decks: motions of boundaries, inner curves and volumes, and what there is where a name is wrong") {
    const TemporaryFolder folder;
    folder.write("plate.msh", plate());
    const std::string deck = folder.write("plate.deck", "mesh = plate.msh\nthreads = 1\nvtk = none\nboundary all = fixed\n"
                                                        "volume \"surface 1\" = rotate 20 about 1.5 1.5\noutput = " +
                                                            folder.path("out") + "\n");
    const Outcome turned = almesh_with({deck});
    CAPTURE(turned.error);
    CHECK(turned.code == 0);
    CHECK(has(text_of(folder.path("out/final.msh")), "17 3 2 0 2 1 2 6 5\n"));
    const std::string bulge = "boundary \"curve 2\"=expression \"x + 0.05*y*(3-y)\" \"y\"";
    CHECK(almesh_with({deck, bulge, "boundary \"curve 5\"=rotate 20 about 1.5 1.5"}).code == 0);
    const Outcome refined = almesh_with({deck, "refine=1", "final=both"});
    REQUIRE(refined.code == 0);
    CHECK(!has(text_of(folder.path("out/final.msh")), "$PhysicalNames"));
    CHECK(has(text_of(folder.path("out/final.su2")), "MARKER_TAG= curve 4\n"));
    CHECK(has(almesh_with({deck, "boundary \"curve 9\"=fixed"}).error,
              "the mesh has no boundary \"curve 9\", only \"curve 1\", \"curve 2\", \"curve 3\", \"curve 4\", "
              "\"curve 5\""));
    CHECK(has(almesh_with({deck, "volume \"surface 3\"=fixed"}).error,
              "the mesh has no volume \"surface 3\", only \"surface 2\", \"surface 1\""));
    CHECK(has(almesh_with({"info", folder.path("plate.msh")}).out, "boundary \"curve 1\" = fixed\n"));
}

TEST_CASE("faces in no group come back as they are in the file, and none where it has none") {
    std::string text = plate();
    text.replace(text.find("1 1 2 0 1 1 2"), 13, "1 1 2 9 1 1 2");
    const std::string dropped = "12 1 2 0 4 5 1\n";
    text.replace(text.find(dropped), dropped.size(), "");
    text.replace(text.find("$Elements\n25"), 12, "$Elements\n24");
    const Mesh mesh = built(text);
    CHECK(mesh.boundaries == Strings{"tag 9", "untagged"});
    CHECK(mesh.face_count() == 12);
    for (const Mesh& one : {mesh, refine(mesh, 1)})
        for (const int version : {22, 41}) {
            const std::string again = msh_text(one, one.x, {.msh_version = version});
            CHECK(!has(again, "untagged"));
            const RawMesh raw = parse_mesh(again, "b.msh");
            int faces = 0, in_group = 0;
            for (const RawElement& element : raw.elements) {
                faces += element.dim == 1;
                in_group += element.dim == 1 && element.physical != 0;
            }
            CHECK(faces == 15 * one.element_count() / 9 / (one.element_count() > 9 ? 2 : 1));
            CHECK(in_group == (one.element_count() > 9 ? 2 : 1));
            CHECK(built(again).boundaries == mesh.boundaries);
        }
}

TEST_CASE("SU2 gets the markers of the file and no others, and is told where faces have none") {
    const TemporaryFolder folder;
    folder.write("a.su2", "NDIME= 2\nNELEM= 2\n9 0 1 4 3 0\n9 1 2 5 4 1\nNPOIN= 6\n0 0\n1 0\n2 0\n0 1\n1 1\n2 1\n"
                          "NMARK= 1\nMARKER_TAG= lower\nMARKER_ELEMS= 2\n3 0 1\n3 1 2\n");
    const std::string deck = folder.write("a.deck", "mesh = a.su2\nthreads = 1\nvtk = none\nboundary all = fixed\noutput = " +
                                                        folder.path("out") + "\n");
    const std::string told = "note: 8 faces of the boundary are in no marker of final.su2";
    const Outcome same = almesh_with({deck}), refined = almesh_with({deck, "refine=1"});
    CHECK(same.code == 0);
    CHECK(!has(same.out, "in no marker"));
    REQUIRE(refined.code == 0);
    CHECK(has(refined.out, told));
    CHECK(has(text_of(folder.path("out/final.su2")), "NMARK= 1\nMARKER_TAG= lower\nMARKER_ELEMS= 4\n"));
}
