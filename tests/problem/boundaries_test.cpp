#include "problem/boundaries.hpp"

#include <doctest/doctest.h>

#include <map>

#include "base/error.hpp"
#include "deck/make_problem.hpp"
#include "support/meshes.hpp"

using namespace almesh;

namespace {

using Strings = std::vector<std::string>;

Deck parsed(const std::string& text, const Strings& overrides = {}) {
    return parse_deck("mesh = m.msh\n" + text, "a.deck", overrides);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A square of 4 x 4 cells around an inclusion of 2 x 2, whose side inside is the group `interface`; left and right of
// x = 0.5 the outer boundary is `left` and `right`. The interface is in `hot` too where there are two groups.
Mesh square_with_inclusion(bool two_groups = false) {
    Mesh mesh = test::square_mesh(4);
    mesh.file.groups.push_back({2, 101, "inclusion"});
    mesh.file.groups.push_back({1, 50, "interface"});
    mesh.file.groups.push_back({1, 51, "hot"});
    const auto is_inside = [](const std::array<double, 3>& c) {
        return c[0] > 0.25 && c[0] < 0.75 && c[1] > 0.25 && c[1] < 0.75;
    };
    for (int e = 0; e < mesh.element_count(); ++e)
        if (is_inside(centroid(mesh, mesh.x, mesh.element(e), 3))) mesh.file.element_physical[e] = 101;
    KeptCells& kept = mesh.kept[1];
    for (int copy = 0; copy < (two_groups ? 2 : 1); ++copy)
        for (int e = 0; e < mesh.element_count(); ++e) {
            if (mesh.file.element_physical[e] != 101) continue;
            for (const CellFace& side : mesh.cell().faces) {
                const int nodes[] = {mesh.element(e)[side[0]], mesh.element(e)[side[1]]};
                const std::array<double, 3> c = centroid(mesh, mesh.x, nodes, 2);
                if (is_inside({c[0] * 0.999 + 0.0005, c[1] * 0.999 + 0.0005}) &&
                    !(std::abs(c[0] - 0.25) < 1e-9 || std::abs(c[0] - 0.75) < 1e-9 || std::abs(c[1] - 0.25) < 1e-9 ||
                      std::abs(c[1] - 0.75) < 1e-9))
                    continue;
                const int first = copy == 0 ? e % 2 : 0;  // some the other way round
                kept.nodes.insert(kept.nodes.end(), {nodes[first], nodes[1 - first]});
                kept.element.push_back(e);
                kept.id.push_back(1000 + kept.count());
                kept.physical.push_back(50 + copy);
                kept.entity.push_back(7);
            }
        }
    return mesh;
}

std::string error_of(const std::string& text, const Strings& overrides = {}, bool two_groups = false) {
    Mesh mesh = square_with_inclusion(two_groups);
    Strings notes;
    try {
        assign_boundaries(parsed(text, overrides), mesh, notes);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("what only the mesh can tell") {
    const std::string known = test::square_mesh(4).boundaries[0];
    CHECK(error_of("boundary rest = fixed\nboundary " + known + " = fixed\nwall = " + known) == "");
    CHECK(has(error_of("boundary iner = fixed"), "a.deck:2: the mesh has no boundary \"iner\", only \""));
    CHECK(has(error_of("boundary iner = fixed"), "\"interface\""));
    CHECK(has(error_of("wall = outer"), "a.deck:2: wall: the mesh has no boundary \"outer\""));
    CHECK(has(error_of("", {"wall=x"}), "command line: wall: the mesh has no boundary \"x\""));
    CHECK(error_of("boundary all = translate 8 0 0") ==
          "a.deck:2: boundary \"all\": `translate 8 0 0` needs 2 components in 2D");
    CHECK(has(error_of("volume steel = fixed"), "a.deck:2: the mesh has no volume \"steel\", only \"domain\", \"inclusion\""));
}

TEST_CASE("a surface inside the mesh is a boundary where a line moves it, and free otherwise") {
    Mesh mesh = square_with_inclusion();
    const std::size_t outer = mesh.boundaries.size();
    const int outer_faces = mesh.face_count();
    Strings notes;
    assign_boundaries(parsed("boundary all = fixed"), mesh, notes);
    CHECK(mesh.boundaries.size() == outer);
    CHECK(notes == Strings{"inside the mesh, and free as the deck has no line for them: \"interface\""});

    notes.clear();
    assign_boundaries(parsed("boundary all = fixed\nboundary interface = translate 0.1 0"), mesh, notes);
    CHECK(notes.empty());
    REQUIRE(mesh.face_count() == outer_faces + 8);
    CHECK(mesh.kept[1].count() == 0);
    double area = 0;  // by Green: neighbours are oriented alike
    for (int f = outer_faces; f < mesh.face_count(); ++f) {
        CHECK(mesh.boundaries[mesh.face_boundary[f]] == "interface");
        CHECK(mesh.is_inner(f));
        CHECK(mesh.file.face_id[f] >= 1000);
        const double *a = point(mesh.x, mesh.face(f)[0], 2), *b = point(mesh.x, mesh.face(f)[1], 2);
        area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    CHECK(std::abs(area) == doctest::Approx(0.25));
}

TEST_CASE("faces of two groups are moved by the line of either, and two that disagree are refused") {
    for (const std::string name : {"interface", "hot"}) {
        Mesh mesh = square_with_inclusion(true);
        Strings notes;
        assign_boundaries(parsed("boundary all = fixed\nboundary " + name + " = translate 0.1 0"), mesh, notes);
        CHECK(mesh.boundaries.back() == name);
        CHECK(mesh.kept[1].count() == 8);  // written once more, as they came
    }
    CHECK(error_of("boundary interface = fixed\nboundary hot = fixed", {}, true) == "");
    CHECK(has(error_of("boundary interface = fixed\nboundary hot = translate 1 0", {}, true),
              "a.deck:3: boundary \"hot\" and boundary \"interface\" (a.deck:2) have faces in common, the first with id "));
}

TEST_CASE("all sides of a volume follow its motion") {
    Mesh mesh = square_with_inclusion();
    const int outer_faces = mesh.face_count();
    Strings notes;
    assign_boundaries(parsed("boundary all = fixed\nvolume inclusion = rotate 10 about 0.5 0.5"), mesh, notes);
    CHECK(mesh.face_count() == outer_faces + 16);  // of eight triangles, those between them once
    CHECK(mesh.boundaries.back() == "volume inclusion");
    Mesh all = square_with_inclusion();
    assign_boundaries(parsed("boundary rest = fixed\nvolume domain = rotate 10 about 0.5 0.5"), all, notes);
    for (int f = 0; f < outer_faces; ++f) CHECK(all.boundaries[all.face_boundary[f]] == "volume domain");
    CHECK(has(error_of("volume domain = fixed\nboundary interface = translate 1 0"), "and their motions disagree"));
    for (const std::string motion : {"slide", "file a.csv else slide", "file a.csv else free"})
        CHECK_THROWS_WITH_AS(parsed("volume domain = " + motion), doctest::Contains("neither slides nor is free"),
                             UsageError);
    CHECK_NOTHROW(parsed("volume domain = file a.csv else fixed"));
    CHECK(parsed("volume \"my part\" = fixed").boundaries[0].name == "volume my part");
    CHECK(has(resolved(parsed("volume \"my part\" = translate 1 2")), "volume \"my part\" = translate 1 2\n"));
}

TEST_CASE("faces that the file does not name are selected by where they are, how they look, or as smooth parts") {
    const auto counts = [](const std::string& text) {
        Mesh mesh = test::cube_mesh(2);
        Strings notes;
        assign_boundaries(parsed(text), mesh, notes);
        std::map<std::string, int> faces;
        for (const int b : mesh.face_boundary) ++faces[mesh.boundaries[b]];
        CHECK(faces.size() == mesh.boundaries.size());
        return faces;
    };
    CHECK(counts("select lid = z > 0.99\nboundary lid = translate 0 0 0.1\nboundary rest = fixed").at("lid") == 8);
    CHECK(counts("select lid = nz > 0.99 and x <= 0.5\nboundary all = fixed").at("lid") == 4);
    CHECK(counts("select ends = nx < -0.5 or nx > 0.5\nboundary all = fixed").at("ends") == 16);
    CHECK(counts("select one = part 1\nselect others = part 2 3 4 5 6\nboundary all = fixed") ==
          std::map<std::string, int>{{"one", 8}, {"others", 40}});
    CHECK(counts("select whole = part 1\nfeature_angle = 100\nboundary all = fixed").at("whole") == 48);
    // A later selection takes faces from an earlier one.
    CHECK(counts("select a = z > 0.99\nselect b = z > 0.99 and x > 0.5\nboundary all = fixed").at("a") == 4);

    const auto message = [&](const std::string& text) -> std::string {
        try {
            counts(text);
        } catch (const UsageError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(has(message("select lid = z > 2"), "a.deck:2: select \"lid\" takes no face of the boundary: almesh info m.msh"));
    CHECK(has(message("select lid = part 9"), "feature_angle=30 numbers its parts"));
    CHECK(has(message("select lid = part x"), "a.deck:2: select \"lid\": `x` is no number of a part"));
    CHECK(has(message("select lid = z + 1"), "select \"lid\": `z + 1`, column 6: expected <, <=, > or >="));
    CHECK(has(message("select lid = nq > 1"), "unknown name `nq`"));
    CHECK(has(message("select " + test::cube_mesh(2).boundaries[0] + " = z > 0.5"), "has a boundary of this name already"));
    CHECK(parsed("select a = z > 1", {"select a=z > 2"}).selections.back().text == "z > 2");
    CHECK_THROWS_WITH_AS(parsed("", {"select a=z > 1", "select a=z > 2"}),
                         doctest::Contains("select \"a\" is already set (command line)"), UsageError);
    const std::string text = resolved(parsed("select \"the lid\" = z>0.99  and nz > 0"));
    CHECK(has(text, "select \"the lid\" = z>0.99  and nz > 0\n"));
}
