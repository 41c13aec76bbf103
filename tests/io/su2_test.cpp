#include "io/su2.hpp"

#include <doctest/doctest.h>

#include "base/error.hpp"
#include "mesh/build.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::string square =
    "% a square\n"
    "NDIME= 2\n"
    "NELEM= 2\n"
    "5 0 1 2 0\n"
    "5\t0 2 3\n"
    "NPOIN= 4 4\n"
    "0 0 0\n"
    "1 0 1\n"
    "\n"
    "1 1\n"
    "0 1 3\n"
    "NMARK= 2\n"
    "MARKER_TAG= wall\n"
    "MARKER_ELEMS= 3\n"
    "3 0 1\n3 1 2\n3 2 3\n"
    "MARKER_TAG= inlet\n"
    "MARKER_ELEMS= 1\n"
    "3 3 0\n";

std::string error_of(std::string text, const std::string& replaced, const std::string& by) {
    const std::size_t at = text.find(replaced);
    REQUIRE(at != std::string::npos);
    text.replace(at, replaced.size(), by);
    try {
        parse_su2(text, "a.su2");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("an SU2 mesh: elements, points and markers, with or without their numbers, comments and blank lines") {
    REQUIRE(looks_like_su2(square));
    CHECK(!looks_like_su2("$MeshFormat\n2.2 0 8\n"));
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(parse_su2(square, "a.su2"), notes);
    CHECK(mesh.dim == 2);
    CHECK(mesh.element_count() == 2);
    CHECK(mesh.x == std::vector<double>{0, 0, 1, 0, 1, 1, 0, 1});
    CHECK(mesh.boundaries == std::vector<std::string>{"wall", "inlet"});
    CHECK(mesh.face_count() == 4);
    CHECK(mesh.file.node_id == std::vector<long long>{1, 2, 3, 4});
}

TEST_CASE("what is written is read again, to the last bit, in 2D and 3D") {
    const TemporaryFolder folder;
    for (const Mesh& mesh : {ring_mesh(12, 3, 6), cube_mesh(2)}) {
        write_su2(folder.path("a.su2"), mesh, mesh.x);
        const Mesh again = mesh_of(folder.path("a.su2"));
        CHECK(again.x == mesh.x);
        CHECK(again.elements == mesh.elements);
        CHECK(again.face_count() == mesh.face_count());
        REQUIRE(again.boundaries.size() == mesh.boundaries.size());
        for (const std::string& name : mesh.boundaries) {
            int count = 0;
            for (int f = 0; f < mesh.face_count(); ++f)
                count += (mesh.boundaries[mesh.face_boundary[f]] == name) -
                         (again.boundaries[again.face_boundary[f]] == name);
            CHECK(count == 0);
        }
    }
}

TEST_CASE("errors of SU2 meshes name the line and what is wrong") {
    CHECK(error_of(square, "% a", "% a") == "");
    const auto has_error = [](const std::string& replaced, const std::string& by, const std::string& expected) {
        const std::string error = error_of(square, replaced, by);
        CAPTURE(error);
        CHECK(has(error, expected));
    };
    has_error("NDIME= 2", "NDIME= 4", "a.su2:2: 2 or 3 `4` is out of range");
    has_error("5 0 1 2 0", "9 0 1 2 3 0", "a.su2:4: quadrilaterals (type 9) are not read");
    has_error("5 0 1 2 0", "5 0 1 7 0", "a.su2:4: node 7 is not there: the file has 4");
    has_error("5 0 1 2 0", "5 0 1", "a.su2:4:");
    has_error("0 1 3\n", "0 1 2\n", "points have to be numbered");
    has_error("1 1\n", "1 nan\n", "a.su2:10:");
    has_error("3 3 0\n", "", "the file is cut off: 1 elements announced, only 0 are there");
    has_error("NMARK= 2\n", "NPOIN= 4\n", "a.su2:12: NPOIN is there twice");
    has_error("NPOIN= 4 4\n", "NDIME= 3\n", "a.su2:6: NDIME is there twice");
    has_error("MARKER_TAG= inlet", "inlet", "expected `KEYWORD= VALUE`, got `inlet`");
    has_error("MARKER_TAG= inlet", "MARKER_TAG= in\033let", "a name with control characters");
    has_error("NDIME= 2\n", "", "NDIME has to come first");
    has_error("NDIME= 2\n", "NZONE= 2\nNDIME= 2\n", "several zones");
    has_error("MARKER_ELEMS= 3", "MARKER_ELEMS= -3", "out of range");
}

TEST_CASE("a run reads SU2 and writes it; not where elements are curved") {
    const TemporaryFolder folder;
    const Mesh mesh = ring_mesh(12, 3, 6);
    write_su2(folder.path("ring.su2"), mesh, mesh.x);
    const std::string deck = folder.write("ring.deck", "mesh = ring.su2\noutput = " + folder.path("out") +
                                                           "\nboundary inner = translate 1 0\nboundary rest = fixed\n"
                                                           "final = both\nthreads = 1\nvtk = none\n");
    const Outcome outcome = almesh_with({deck});
    CAPTURE(outcome.error);
    REQUIRE(outcome.code == 0);
    CHECK(mesh_of(folder.path("out/final.su2")).x == mesh_of(folder.path("out/final.msh")).x);
    const Outcome curved = almesh_with({deck, "degree=2"});
    CHECK(curved.code == 1);
    CHECK(has(curved.error, "SU2 has linear elements only"));
    std::filesystem::remove_all(folder.path("out"));
    REQUIRE(almesh_with({deck, "final=input"}).code == 0);
    CHECK(mesh_of(folder.path("out/final.su2")).file.format.kind == FileFormat::Kind::su2);
    CHECK(!std::filesystem::exists(folder.path("out/final.msh")));
    const Outcome raised = almesh_with({deck, "final=input", "degree=2"});
    CHECK(raised.code == 0);
    CHECK(has(raised.out, "note: SU2 meshes are linear: the mesh of degree 2 is written as final.msh"));
    CHECK(mesh_of(folder.path("out/final.msh")).degree == 2);
}

TEST_CASE("elements and faces have the numbers that VTK gives their shapes") {
    const TemporaryFolder folder;
    for (const auto& [mesh, element, face] :
         {std::tuple(square_mesh(1), "5 ", "3 "), std::tuple(cube_mesh(1), "10 ", "5 ")}) {
        write_su2(folder.path("a.su2"), mesh, mesh.x);
        int elements = 0, faces = 0;
        std::string section;
        for (const std::string& line : pieces(text_of(folder.path("a.su2")), '\n')) {
            if (line.find('=') != std::string::npos) section = line.substr(0, line.find('='));
            else if (section == "NELEM") elements += line.starts_with(element);
            else if (section == "MARKER_ELEMS") faces += line.starts_with(face);
        }
        CHECK(elements == mesh.element_count());
        CHECK(faces == mesh.face_count());
    }
}
