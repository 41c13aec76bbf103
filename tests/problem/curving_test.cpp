#include "problem/curving.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <tuple>

#include "support/high_order.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A mesh of degree 3 of which a bump of one boundary folds the elements there; others are curved too, but valid.
Mesh with_bump(const Mesh& linear, double height) {
    Mesh mesh = with_degree(linear, 3);
    const int last = mesh.dim - 1;
    std::vector<char> on_bottom(mesh.nodes(), 0);
    for (std::size_t k = 0; k < mesh.faces.size(); ++k)
        on_bottom[mesh.faces[k]] |= mesh.boundaries[mesh.face_boundary[k / mesh.face_nodes(0)]] == "bottom";
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, mesh.dim);
        if (on_bottom[i]) x[last] += height * std::exp(-80 * std::pow(x[0] - 0.25, 2));
        else if (x[0] > 0.6 && x[0] < 0.99 && x[last] > 0.1 && x[last] < 0.9) x[0] += 0.01 * std::sin(9 * x[last]);
    }
    return mesh;
}

std::string deck_of(const TemporaryFolder& folder, const Mesh& mesh, const std::string& more = "") {
    folder.write("bump.msh", msh_of(mesh));
    return folder.write("bump.deck", "mesh = bump.msh\nthreads = 1\nlocal_repair = 1\noutput = " +
                                         folder.path("results") + "\nboundary all = fixed\n" + more);
}

std::map<long long, std::array<double, 3>> places_of(const Mesh& mesh) {
    std::map<long long, std::array<double, 3>> places;
    for (int i = 0; i < mesh.nodes(); ++i)
        std::copy_n(point(mesh.x, i, mesh.dim), mesh.dim, places[mesh.file.node_id[i]].begin());
    return places;
}

// A quarter of a cylinder in three layers, whose wall and outer surface alone are curved, in arcs of 30 degrees: so the
// faces of the planes beside them are folded. Walls: the file's "bottom" and "top".
Mesh curved_layers(const std::string& cells, int degree, double far = 0) {
    constexpr double radius[] = {1, 1.002, 1.025, 1.3};
    Mesh mesh = solid_mesh(3, cells);
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, 3);
        const double layer = 3 * x[2], angle = x[0] * std::numbers::pi / 2;
        const int below = std::min(2, static_cast<int>(layer + 1e-9));
        const double r = radius[below] + (layer - below) * (radius[below + 1] - radius[below]);
        const double at[] = {r * std::cos(angle), r * std::sin(angle), x[1]};
        std::copy_n(at, 3, x);
    }
    mesh = raise_degree(mesh, degree);
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int k = 0; k < mesh.face_nodes(f); ++k) {
            const std::string& of = mesh.boundaries[mesh.face_boundary[f]];
            double* const x = point(mesh.x, mesh.face(f)[k], 3);
            const double scale = (of == "top" ? 1.3 : 1) / std::hypot(x[0], x[1]);
            for (int a = 0; a < 2 && of != "sides"; ++a) x[a] *= scale;
        }
    for (double& x : mesh.x) x += far;
    return mesh;
}

}  // namespace

TEST_CASE("nodes of planes beside a curved wall slide in them, and the wall stays to the last bit") {
    struct Case {
        const char* cells;
        int degree;
        double far;
    };
    for (const Case& of : {Case{"hhh", 2, 0}, Case{"hhh", 3, 0}, Case{"ppp", 3, 100}}) {
        const char* const cells = of.cells;
        const int degree = of.degree;
        const double far = of.far;
        const TemporaryFolder folder;
        const Mesh mesh = curved_layers(cells, degree, far);
        CAPTURE(cells);
        CAPTURE(degree);
        REQUIRE(!certify(mesh, mesh.x).valid);
        const Outcome outcome = almesh_with({deck_of(folder, mesh), "vtk=none", "local_repair=auto"});
        CAPTURE(outcome.out);
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, ": nodes slide in planes\n"));
        CHECK(!has(outcome.out, "distance of the faces"));
        CHECK(number(summary_of(folder.path("results")), "certified_bound") > 0.3);
        const auto before = places_of(mesh_of(folder.path("bump.msh"))),
                   after = places_of(mesh_of(folder.path("results/final.msh")));
        std::set<long long> moved, listed;
        std::vector<char> is_vertex(mesh.nodes(), 0);
        for (int e = 0; e < mesh.element_count(); ++e)
            for (int k = 0; k < mesh.cell(e).vertices; ++k) is_vertex[mesh.element(e)[k]] = 1;
        for_face_nodes(mesh, [&](int f, std::size_t k) {
            const long long id = mesh.file.node_id[mesh.faces[k]];
            if (after.at(id) == before.at(id)) return;
            moved.insert(id);
            CHECK(mesh.boundaries[mesh.face_boundary[f]] == "sides");
            CHECK(!is_vertex[mesh.faces[k]]);
            double off = 1;
            for (const auto& [axis, at] : {std::pair(0, 0.0), std::pair(1, 0.0), std::pair(2, 0.0), std::pair(2, 1.0)})
                if (std::abs(before.at(id)[axis] - far - at) < 1e-12)
                    off = std::min(off, std::abs(after.at(id)[axis] - far - at));
            CHECK(off <= 1e-13 * (1 + far));
        });
        CHECK(!moved.empty());
        std::istringstream rows(text_of(folder.path("results/moved-nodes.csv")));
        std::string row;
        std::getline(rows, row);
        CHECK(row == "node,boundary,distance,along");
        while (std::getline(rows, row)) {
            CHECK(row.find(",sides,") != std::string::npos);
            CHECK(row.ends_with(",plane"));
            listed.insert(std::stoll(row));
        }
        CHECK(listed == moved);
    }
}

TEST_CASE("elements that are inverted in the file are repaired, and nodes away from them keep its bits") {
    for (const double far : {0.0, 1e5}) {
        const TemporaryFolder folder;
        Mesh mesh = with_bump(square_mesh(8), 0.12);
        REQUIRE(!certify(mesh, mesh.x).valid);
        for (double& x : mesh.x) x += far;
        CAPTURE(far);
        const Outcome outcome = almesh_with({deck_of(folder, mesh)});
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, " elements straightened, to be curved again in parts:"));
        const auto summary = summary_of(folder.path("results"));
        CHECK(summary.at("status") == "converged");
        CHECK(summary.at("certified_injective") == "yes");
        CHECK(summary.at("nodes_off_target") == "0");
        CHECK(std::stod(summary.at("elements")) == mesh.element_count());
        CHECK(almesh_with({"quality", folder.path("results/final.msh")}).code == 0);
        const auto before = places_of(mesh_of(folder.path("bump.msh"))),
                   after = places_of(mesh_of(folder.path("results/final.msh")));
        int moved = 0;
        for (const auto& [id, place] : before) {
            moved += after.at(id) != place;
            if (place[0] - far > 0.9 || place[1] - far == 0) CHECK(after.at(id) == place);
        }
        CHECK(moved > 0);
        CHECK(moved < mesh.nodes() / 2);
    }
}

namespace {

void check_bump(const Mesh& linear, int degree) {
    const TemporaryFolder folder;
    Mesh mesh = raise_degree(linear, degree);
    const int last = mesh.dim - 1;
    double low = 0;
    for (int i = 0; i < mesh.nodes(); ++i) low = std::min(low, point(mesh.x, i, mesh.dim)[last]);
    for (int i = linear.nodes(); i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, mesh.dim);
        if (x[last] < low + 1e-9) x[last] += 0.35 * std::exp(-40 * std::pow(x[0] - 0.5, 2));
    }
    CAPTURE(mesh.elements_text());
    CAPTURE(degree);
    REQUIRE(!certify(mesh, mesh.x).valid);
    const Outcome outcome = almesh_with({deck_of(folder, mesh), "vtk=none"});
    CAPTURE(outcome.out);
    CHECK(outcome.code == 0);
    CHECK(almesh_with({"quality", folder.path("results/final.msh")}).code == 0);
}

}  // namespace

TEST_CASE("a bump that inverts elements of any type: certified, with the boundary as it is or flatter") {
    for (const Mesh& linear : {square_mesh(6), mixed_mesh(8), cube_mesh(3)})
        for (const int degree : {2, 3}) check_bump(linear, degree);
    for (const char* layers : {"hhh", "hdpuh"}) check_bump(solid_mesh(3, layers), 2);
}

TEST_CASE("a bump that inverts solid cells of degree 3: certified, too" * doctest::test_suite("long")) {
    for (const char* layers : {"hhh", "hdpuh"}) check_bump(solid_mesh(3, layers), 3);
}

TEST_CASE("a folded CAD surface is mended where it is folded: nodes around slide along it, the others stay") {
    const TemporaryFolder folder;
    const Outcome outcome = almesh_with({"inputs/cad/torus.deck", "local_repair=1", "output=" + folder.path("torus")});
    CAPTURE(outcome.out);
    CHECK((outcome.code == 0 || outcome.code == 5));  // 5: the deck's expectations are of the mesh as a whole
    CHECK(has(outcome.out, ": nodes slide\n"));
    CHECK(summary_of(folder.path("torus")).at("certified_injective") == "yes");
    CHECK(summary_of(folder.path("torus")).at("straight_faces") == "0");
    const auto before = places_of(mesh_of("inputs/cad/torus.msh")),
               after = places_of(mesh_of(folder.path("torus/final.msh")));
    int stayed = 0;
    for (const auto& [id, place] : before) stayed += after.at(id) == place;
    CHECK(stayed > static_cast<int>(before.size()) / 2);
    CHECK(stayed < static_cast<int>(before.size()));
}

TEST_CASE("where sliding is not wanted faces are flatter than they came, as few and by as little as can be") {
    const TemporaryFolder folder;
    const Outcome outcome = almesh_with({"inputs/cad/torus.deck", "surface=straighten", "local_repair=1", "vtk=ascii",
                                         "output=" + folder.path("torus")});
    CAPTURE(outcome.out);
    CHECK((outcome.code == 0 || outcome.code == 5));
    CHECK(has(outcome.out, ": faces are flatter\n"));
    CHECK(has(outcome.out, " of 314 faces were made flat, or flatter than in the file\n"));
    CHECK(has(outcome.out, " off the surface):\n"));
    CHECK(text_of(folder.path("torus/moved-nodes.csv")).find(",torus,") != std::string::npos);
    const auto summary = summary_of(folder.path("torus"));
    CHECK(summary.at("certified_injective") == "yes");
    CHECK(summary.at("freed_nodes") == "0");
    CHECK(number(summary, "straight_faces") > 0);
    CHECK(number(summary, "straight_faces") < 60);
    CHECK(number(summary, "boundary_distance") > 0);
    CHECK(number(summary, "relative_boundary_distance") < 0.15);
    CHECK(has(text_of(folder.path("torus/boundary.vtk")), "flat"));
}

TEST_CASE("a mesh in thin layers, all of whose elements at a curved wall are inverted") {
    const TemporaryFolder folder;
    const Outcome outcome = almesh_with({"inputs/cad/layers.deck", "local_repair=1",
                                         "output=" + folder.path("layers")});
    CHECK((outcome.code == 0 || outcome.code == 5));  // 5: the deck's expectations are of the mesh as a whole
    CHECK(has(outcome.out, ": nodes slide in planes\n"));
    CHECK(number(summary_of(folder.path("layers")), "boundary_distance") == 0);
}

TEST_CASE("elements above min_certified_bound are left, those below are made better") {
    for (const double least : {0.0, 0.02, 0.1}) {
        const TemporaryFolder folder;
        const Outcome outcome = almesh_with({"inputs/cad/torus.deck", "local_repair=1",
                                             "min_certified_bound=" + to_text(least), "output=" + folder.path("out")});
        CAPTURE(least);
        const auto summary = summary_of(folder.path("out"));
        CHECK(summary.at("certified_injective") == "yes");
        CHECK(number(summary, "certified_bound") > least);
        if (least == 0) CHECK(number(summary, "certified_bound") < 0.02);
    }
}

TEST_CASE("where no element is inverted in the file nothing moves") {
    const TemporaryFolder folder;
    const Mesh mesh = with_bump(square_mesh(8), 0.01);
    const Outcome outcome = almesh_with({deck_of(folder, mesh)});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "no element is invalid in the file: nothing moves"));
    CHECK(places_of(mesh_of(folder.path("results/final.msh"))) == places_of(mesh_of(folder.path("bump.msh"))));
    CHECK(summary_of(folder.path("results")).at("newton_iterations") == "0");
}

TEST_CASE("a mesh with straight sides has nothing to repair") {
    const RingDeck ring;
    const Outcome outcome = ring.run({"boundary inner=fixed", "local_repair=1"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "no element is invalid in the file: nothing moves"));
}

TEST_CASE("a part that cannot be repaired alone grows, to the whole mesh at last") {
    const TemporaryFolder folder;
    const Mesh mesh = with_bump(square_mesh(3), 0.3);
    const Outcome outcome = almesh_with({deck_of(folder, mesh)});
    CHECK(outcome.code == 0);
    CHECK(almesh_with({"quality", folder.path("results/final.msh")}).code == 0);
}

TEST_CASE("local_repair = 1 is refused where the mesh is to change") {
    const TemporaryFolder folder;
    const std::string deck = deck_of(folder, with_bump(square_mesh(8), 0.12));
    for (const char* setting : {"boundary all=translate 1 0", "boundary all=slide", "refine=1", "degree=4",
                                "surface=keep", "surface=slide", "delta=0.1"}) {
        const Outcome outcome = almesh_with({deck, setting});
        CHECK(outcome.code == 1);
        CHECK(has(outcome.error, "does not go with local_repair = 1"));
    }
    CHECK(almesh_with({deck, "local_repair=0"}).code == 0);
}

TEST_CASE("mending is interrupted with a certified mesh, and has the same bits for any number of threads") {
    const TemporaryFolder folder;
    const std::string deck = deck_of(folder, with_bump(square_mesh(8), 0.12));
    REQUIRE(almesh_with({deck}).code == 0);
    const std::string whole = text_of(folder.path("results/final.msh"));
    REQUIRE(almesh_with({deck, "max_seconds=1e-9"}).code == 3);
    CHECK(summary_of(folder.path("results")).at("certified_injective") == "yes");
    CHECK(number(summary_of(folder.path("results")), "straight_faces") > 0);
    REQUIRE(almesh_with({deck, "threads=3"}).code == 0);
    CHECK(text_of(folder.path("results/final.msh")) == whole);
}
