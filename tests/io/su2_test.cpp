#include "io/su2.hpp"

#include <doctest/doctest.h>

#include "base/error.hpp"
#include "check/injectivity.hpp"
#include "check/target_check.hpp"
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

// In an order of its own, with what is no mesh.
const std::string with_others =
    "% a square\n"
    "AOA_OFFSET= 0\n"
    "NDIME= 2\n"
    "\n"
    "NPOIN= 4\n"
    "0 0 0\n1 0 1\n1 1 2\n0 1 3\n"
    "% its boundary\n"
    "NMARK= 4\n"
    "MARKER_TAG= wall\nMARKER_ELEMS= 3\n3 0 1\n3 1 2\n3 2 3\n"
    "MARKER_TAG= inlet\nMARKER_ELEMS= 1\n3 3 0\n"
    "MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 2\nSEND_RECV= 1\n1 0 0\n1 3 0\n"
    "MARKER_TAG= nothing\nMARKER_ELEMS= 0\n"
    "NPERIODIC= 1\n"
    "PERIODIC_INDEX= 0\n"
    "0.00\t0.00\n"
    "% its inside\n"
    "NELEM= 2\n"
    "5 0 1 2 0\n5 0 2 3 1\n"
    "FFD_NBOX= 1\n"
    "  FFD_CORNER_POINTS= 2\n"
    "-1 -1\n"
    "2 2\n"
    "wall 0 0.5 0.5\n"
    "% the end\n";

const std::string two_zones =
    "% two bodies\n"
    "NDIME= 2\n"
    "NZONE= 2\n"
    "IZONE= 1\n"
    "NELEM= 1\n5 0 1 2 0\n"
    "NPOIN= 3\n0 0 0\n1 0 1\n0 1 2\n"
    "NMARK= 2\n"
    "MARKER_TAG= wall\nMARKER_ELEMS= 2\n3 0 1\n3 1 2\n"
    "MARKER_TAG= inlet\nMARKER_ELEMS= 1\n3 2 0\n"
    "FFD_NBOX= 0\n"
    "IZONE= 2\n"
    "NDIME= 2\n"
    "NPOIN= 4\n2 0 0\n3 0 1\n2 1 2\n3 1 3\n"
    "NELEM= 2\n5 0 1 2 0\n5 1 3 2 1\n"
    "NMARK= 2\n"
    "MARKER_TAG= outlet\nMARKER_ELEMS= 2\n3 1 3\n3 3 2\n"
    "MARKER_TAG= wall\nMARKER_ELEMS= 2\n3 2 0\n3 0 1\n"
    "NPERIODIC= 0\n";

std::string text_of_su2(const Mesh& mesh) {
    const TemporaryFolder folder;
    write_su2(folder.path("a.su2"), mesh, mesh.x);
    return text_of(folder.path("a.su2"));
}

// The text read and written again.
std::string written(const std::string& text) {
    std::vector<std::string> notes;
    return text_of_su2(build_mesh(parse_su2(text, "a.su2"), notes));
}

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
    CHECK(mesh.file.node_id == std::vector<long long>{0, 1, 2, 3});
    CHECK(mesh.file.element_id == std::vector<long long>{0, 1});
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

TEST_CASE("SU2 files in many ways: long rows, broken rows, no numbers, any order, CRLF, comments at line ends") {
    const std::string in_the_wild =
        "\r\n% made elsewhere\r\n"
        "AOA_OFFSET=0\r\n"
        "NDIME=2 % plane\r\n"
        "NMARK=2\t% two\r\n"
        "MARKER_TAG=wall % not slippery\r\n"
        "MARKER_ELEMS=3\r\n"
        "3 0\r\n 1\r\n3 1 2 0 0\r\n% in between\r\n\t3 2 3 % last\r\n"
        "MARKER_TAG=\tinlet\r\n"
        "MARKER_ELEMS= 1\r\n"
        "3\r\n3\r\n0 0\r\n"
        "NPOIN= 4 2\r\n"
        "0 0 0.0 0\r\n"
        "1 0 0.0\r\n"
        "1\r\n% a comment\r\n 1 2\r\n"
        "0 1. 3 17\r\n"
        "NELEM=2 % triangles\r\n"
        "5 0\r\n1\r\n\r\n2 0\r\n"
        "5 2 0 3 1 5 5\r\n";
    REQUIRE(looks_like_su2(in_the_wild));
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(parse_su2(in_the_wild, "a.su2"), notes);
    const Mesh plain = build_mesh(parse_su2(square, "a.su2"), notes);
    CHECK(mesh.x == plain.x);
    CHECK(mesh.elements == std::vector<int>{0, 1, 2, 2, 3, 0});  // the second one turned
    CHECK(mesh.faces == plain.faces);
    CHECK(mesh.face_boundary == plain.face_boundary);
    CHECK(mesh.boundaries == plain.boundaries);
}

TEST_CASE("what an SU2 file has besides the mesh is passed over, and written anew without it") {
    std::vector<std::string> notes;
    const RawMesh raw = parse_su2(with_others, "a.su2");
    CHECK(raw.sections == std::vector<std::string>{"AOA_OFFSET", "NPERIODIC", "PERIODIC_INDEX", "FFD_NBOX",
                                                   "FFD_CORNER_POINTS"});
    const Mesh mesh = build_mesh(raw, notes);
    CHECK(text_of_su2(mesh) ==
          "NDIME= 2\nNELEM= 2\n5 0 1 2 0\n5 0 2 3 1\nNPOIN= 4\n0 0 0\n1 0 1\n1 1 2\n0 1 3\nNMARK= 4\n"
          "MARKER_TAG= wall\nMARKER_ELEMS= 3\n3 0 1\n3 1 2\n3 2 3\nMARKER_TAG= inlet\nMARKER_ELEMS= 1\n3 3 0\n"
          "MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 0\nMARKER_TAG= nothing\nMARKER_ELEMS= 0\n");

    std::string two_of_one_name = square;
    two_of_one_name.replace(two_of_one_name.find("inlet"), 5, "wall");
    CHECK(has(written(two_of_one_name), "NMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 4\n"));
    const std::string without_markers = square.substr(0, square.find("NMARK"));
    CHECK(has(written(without_markers), "NMARK= 0\n"));
}

TEST_CASE("the zones of an SU2 file are one mesh, and one zone where it is written anew") {
    REQUIRE(looks_like_su2(two_zones));
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(parse_su2(two_zones, "a.su2"), notes);
    CHECK(notes.empty());
    CHECK(mesh.nodes() == 7);
    CHECK(mesh.elements == std::vector<int>{0, 1, 2, 3, 4, 5, 4, 6, 5});
    CHECK(mesh.boundaries == std::vector<std::string>{"1:wall", "inlet", "outlet", "2:wall"});
    CHECK(mesh.file.node_id == std::vector<long long>{0, 1, 2, 3, 4, 5, 6});
    CHECK(mesh.file.element_id == std::vector<long long>{0, 1, 2});
    CHECK(mesh.file.element_entity == std::vector<int>{1, 2, 2});
    CHECK(mesh.file.sections == std::vector<std::string>{"NZONE", "FFD_NBOX", "NPERIODIC"});
    CHECK(group_name(mesh.file.groups, 2, 2) == "zone-2");

    const Mesh fine = refine(mesh, 1), again = build_mesh(parse_su2(text_of_su2(fine), "a.su2"), notes);
    CHECK(again.boundaries == mesh.boundaries);
    CHECK(again.element_count() == 12);
    CHECK(again.nodes() == 15);
    CHECK(volume(again, again.x) == volume(mesh, mesh.x));
}

TEST_CASE("a run moves the zones of an SU2 file together, in the file as it is") {
    const TemporaryFolder folder;
    const std::string deck =
        folder.write("zones.deck", "mesh = " + folder.write("zones.su2", two_zones) + "\noutput = " +
                                       folder.path("out") + "\nboundary 2:wall = translate 0.125 0\n"
                                       "boundary outlet = translate 0.125 0\nboundary rest = fixed\n"
                                       "threads = 1\nvtk = none\n");
    const Outcome outcome = almesh_with({deck});
    CAPTURE(outcome.error);
    REQUIRE(outcome.code == 0);
    CHECK(has(outcome.out, "certified valid and injective"));
    std::string expected = two_zones;
    const std::string nodes = "2 0 0\n3 0 1\n2 1 2\n3 1 3\n";
    expected.replace(expected.find(nodes), nodes.size(), "2.125 0 0\n3.125 0 1\n2.125 1 2\n3.125 1 3\n");
    CHECK(text_of(folder.path("out/final.su2")) == expected);
    const Outcome refined = almesh_with({deck, "refine=1"});
    CHECK(refined.code == 0);
    CHECK(has(refined.out, "note: not in the final mesh, which is written anew: NZONE, FFD_NBOX, NPERIODIC"));
}

TEST_CASE("zones may touch, lie over each other and move through each other; within a zone that is refused") {
    std::string text = two_zones;  // the second one over the first one
    text.replace(text.find("2 0 0\n3 0 1\n2 1 2\n3 1 3\n"), 24, "0 0 0\n1 0 1\n0 1 2\n1 1 3\n");
    const TemporaryFolder folder;
    const std::string zones = folder.write("zones.su2", text);
    const std::string deck = folder.write("zones.deck", "mesh = zones.su2\noutput = " + folder.path("out") +
                                                            "\nboundary 2:wall = translate 1.25 0\n"
                                                            "boundary outlet = translate 1.25 0\n"
                                                            "boundary rest = fixed\nthreads = 1\nvtk = none\n");
    const Outcome outcome = almesh_with({deck});
    CAPTURE(outcome.error);
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "certified valid and injective"));

    std::vector<std::string> notes;
    Mesh mesh = build_mesh(parse_su2(two_zones, "a.su2"), notes);
    mesh.x = build_mesh(read_mesh(zones), notes).x;
    CHECK(overlapping_elements(mesh, mesh.x, check_target(mesh, mesh.x)) == std::array{-1, -1});
    mesh.file.zones = 1;
    CHECK(overlapping_elements(mesh, mesh.x, check_target(mesh, mesh.x)) != std::array{-1, -1});
}

TEST_CASE("zones may cross each other and move into each other, parts of one mesh may not; both may meet in a node") {
    std::vector<std::string> notes;
    Mesh mesh = build_mesh(parse_su2(two_zones, "a.su2"), notes);
    struct Move {
        double scale, dx, dy;  // of the second zone
        const char* fault;
    };
    for (const auto& [scale, dx, dy, fault] : {Move{1, -1.7, 0.1, "in the target it crosses"},
                                               Move{0.125, 0.0625, 0.25, "through the one made of"},
                                               Move{1, -1, 0, ""}}) {
        std::vector<double> target = mesh.x;
        for (int i = 3; i < mesh.nodes(); ++i) {
            target[offset(i, 2)] = scale * mesh.x[offset(i, 2)] + dx;
            target[offset(i, 2, 1)] = scale * mesh.x[offset(i, 2, 1)] + dy;
        }
        mesh.file.zones = 2;
        CHECK(check_target(mesh, target).faults.empty());
        mesh.file.zones = 1;
        const TargetReport report = check_target(mesh, target);
        REQUIRE(report.faults.empty() == std::string(fault).empty());
        if (!report.faults.empty()) CHECK(has(report.faults[0].why, fault));
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
    has_error("5 0 1 2 0", "12 0 1 2 3 0 1 2 3 0",
              "a.su2:4: hexahedra (type 12) are not read here: only triangles and quadrilaterals of degree 1 to 7");
    has_error("5 0 1 2 0", "5 0 1 7 0", "a.su2:4: node 7 is not there: the file has 4");
    has_error("5 0 1 2 0", "5 0 1", "a.su2:4:");
    has_error("1 1\n", "1 nan\n", "a.su2:10:");
    has_error("3 3 0\n", "", "the file is cut off: 1 elements announced, only 0 are there");
    has_error("NMARK= 2\n", "NPOIN= 4\n", "a.su2:12: NPOIN is there twice");
    has_error("NPOIN= 4 4\n", "NDIME= 3\n", "a.su2:6: NDIME is there twice");
    has_error("MARKER_TAG= inlet", "inlet", "a.su2:18: expected `MARKER_TAG= VALUE`, got `inlet`");
    has_error("MARKER_TAG= inlet", "MARKER_TAG= in\033let", "a name with control characters");
    has_error("NDIME= 2\n", "", "NDIME has to come first");
    has_error("NDIME= 2\n", "NZONE= 2\nNDIME= 2\n", "a.su2:4: of several zones each has to begin with IZONE= NUMBER");
    has_error("MARKER_ELEMS= 3", "MARKER_ELEMS= -3", "out of range");
    has_error("NELEM= 2", "NELEM= 1",
              "a.su2:5: expected `KEYWORD= VALUE`, got `5\t0 2 3`: more rows than NELEM announces");
    has_error("NMARK= 2\n", "NMARK= 1\n",
              "a.su2:18: MARKER_TAG outside of NMARK: are there more markers than it says?");
    has_error("5\t0 2 3\n", "5\n", "a.su2:5: a row of at least 4 numbers has 1 or less, and the next line does not");
    has_error("5 0 1 2 0", "5 0 1", "a.su2:4: a row of at least 4 numbers has 3 or less");
    has_error("0 1 3\n", "0\n", "a.su2:11: a row of at least 2 numbers has 1 or less");
    has_error("5 0 1 2 0", "10 0 1 2 3 0", 
              "a.su2:4: tetrahedra (type 10) are not read here: only triangles and quadrilaterals of degree 1 to 7");
    has_error("5 0 1 2 0", "705 0 1 2 0", "a.su2:4: triangles (type 705) are not read here: only");
    has_error("3 1 2\n", "5 1 2 3\n",
              "a.su2:16: triangles (type 5) are not read as faces: only lines of degree 1 to 7");
    has_error("5 0 1 2 0", "18 0 1 2 0", "a.su2:4: elements of this type (type 18) are not read");
    has_error("5 0 1 2 0\n5\t0 2 3\n", "205 0 1 2 0\n5\n", "a.su2:4: a row of at least 11 numbers has 6 or less");
    has_error("NPOIN= 4 4\n0 0 0\n1 0 1\n\n1 1\n0 1 3\n", "", "there is no NPOIN");
    has_error("NELEM= 2\n5 0 1 2 0\n5\t0 2 3\n", "", "there is no NELEM");
}

TEST_CASE("errors of SU2 meshes of several zones") {
    CHECK(error_of(two_zones, "% two", "% two") == "");
    const auto has_error = [](const std::string& replaced, const std::string& by, const std::string& expected) {
        const std::string error = error_of(two_zones, replaced, by);
        CAPTURE(error);
        CHECK(has(error, expected));
    };
    has_error("NZONE= 2", "NZONE= 0", "a.su2:3: the number of zones `0` is out of range");
    has_error("NZONE= 2", "NZONE= 3", "NZONE announces 3 zones, only 2 are there");
    has_error("NZONE= 2", "NZONE= 1", "a.su2:20: IZONE= 2 is out of order: NZONE= COUNT comes first");
    has_error("IZONE= 2", "IZONE= 3", "a.su2:20: IZONE= 3 is out of order");
    has_error("IZONE= 2\n", "", "a.su2:21: NPOIN is there twice: a zone begins with IZONE= NUMBER");
    has_error("IZONE= 2\nNDIME= 2", "IZONE= 2\nNDIME= 3",
              "a.su2:21: NDIME= 3 after NDIME= 2: put such zones in a file");
    has_error("5 1 3 2 1", "5 1 4 2 1", "a.su2:29: node 4 is not there: the zone has 4");
    has_error("NELEM= 1\n5 0 1 2 0\n", "", "there is no NELEM in zone 1");
}

TEST_CASE("a run reads SU2 and writes it, curved elements as those of its high-order solver") {
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
    std::filesystem::remove_all(folder.path("out"));
    REQUIRE(almesh_with({deck, "final=input"}).code == 0);
    CHECK(mesh_of(folder.path("out/final.su2")).file.format.ending == ".su2");
    CHECK(!std::filesystem::exists(folder.path("out/final.msh")));
    const Outcome raised = almesh_with({deck, "final=input", "degree=2"});
    CHECK(raised.code == 0);
    CHECK(has(raised.out, "note: final.su2 has elements of degree 2, which of SU2 only the high-order solver reads"));
    REQUIRE(almesh_with({deck, "degree=2"}).code == 0);
    const Mesh in_su2 = mesh_of(folder.path("out/final.su2")), in_msh = mesh_of(folder.path("out/final.msh"));
    CHECK(in_su2.degree == 2);
    CHECK(in_su2.x == in_msh.x);
    CHECK(in_su2.elements == in_msh.elements);
    CHECK(in_su2.faces == in_msh.faces);
}

TEST_CASE("points and elements are numbered by their order, whatever stands at the end of their rows") {
    CHECK(error_of(square, "0 1 3\n", "0 1 x\n") == "");
    std::string other = square;
    for (const auto& [from, to] : {std::pair("0 0 0\n", "0 0 7\n"), {"1 0 1\n", "1 0 9 2.5\n"}, {"0 1 3\n", "0 1 8\n"},
                                   {"5 0 1 2 0", "5 0 1 2 30"}})
        other.replace(other.find(from), std::string(from).size(), to);
    const RawMesh a = parse_su2(square, "a.su2"), b = parse_su2(other, "a.su2");
    REQUIRE(b.nodes.size() == 4);
    for (int i = 0; i < 4; ++i) CHECK(b.nodes[i].id == i);
    CHECK(b.element_nodes == a.element_nodes);
    // Faces come after the elements, wherever they stand.
    const RawMesh faces_first = parse_su2(with_others, "a.su2");
    for (const RawElement& element : faces_first.elements) CHECK((element.id < 2) == (element.dim == 2));
}

TEST_CASE("node files have SU2's numbers, and its positions go to and from MSH, where ids are greater by 1") {
    const TemporaryFolder folder;
    folder.write("a.su2", "NDIME= 2\nNELEM= 4\n9 0 1 4 3\n9 1 2 5 4\n9 3 4 7 6\n9 4 5 8 7\n"
                          "NPOIN= 9\n0 0\n1 0\n2 0\n0 1\n1 1\n2 1\n0 2\n1 2\n2 2\nNMARK= 2\n"
                          "MARKER_TAG= bottom\nMARKER_ELEMS= 2\n3 0 1\n3 1 2\n"
                          "MARKER_TAG= rest\nMARKER_ELEMS= 6\n3 2 5\n3 5 8\n3 8 7\n3 7 6\n3 6 3\n3 3 0\n");
    folder.write("places.csv", "0,0,-0.1\n1,1,-0.2\n2,2,-0.1\n");
    const std::string deck = folder.write("a.deck", "mesh = a.su2\nthreads = 1\nvtk = none\nfinal = both\noutput = " +
                                                        folder.path("out") + "\nboundary bottom = file places.csv\n"
                                                        "boundary rest = file places.csv else slide\n");
    const Outcome moved = almesh_with({deck});
    CAPTURE(moved.error);
    REQUIRE(moved.code == 0);
    const RawMesh su2 = read_mesh(folder.path("out/final.su2")), msh = read_mesh(folder.path("out/final.msh"));
    CHECK(su2.nodes[1].x[1] == -0.2);
    for (int i = 0; i < 9; ++i) {
        CHECK(msh.nodes[i].id == i + 1);
        CHECK(std::equal(msh.nodes[i].x, msh.nodes[i].x + 2, su2.nodes[i].x));
    }
    std::filesystem::copy(folder.path("out/final.msh"), folder.path("moved.msh"));
    std::filesystem::copy(folder.path("out/final.su2"), folder.path("moved.su2"));
    for (const std::string other : {"moved.msh", "moved.su2"}) {
        REQUIRE(almesh_with({deck, "final=su2", "boundary bottom=mesh " + folder.path(other),
                             "boundary rest=mesh " + folder.path(other)}).code == 0);
        CHECK(read_mesh(folder.path("out/final.su2")).nodes[1].x[1] == -0.2);
        CHECK(almesh_with({"quality", folder.path("a.su2"), "before=" + folder.path(other)}).error == "");
        CHECK(almesh_with({deck, "start=" + folder.path(other)}).code == 0);
    }
    folder.write("places.csv", "9,0,-0.1\n");
    CHECK(has(almesh_with({deck}).error, "node 9 is not on boundary"));
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
