#include "problem/node_targets.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <set>
#include <sstream>

#include "base/index.hpp"
#include "geometry/closest_point.hpp"
#include "geometry/face_patches.hpp"
#include "support/high_order.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::set<int> nodes_of(const Mesh& mesh, const std::string& boundary) {
    std::set<int> nodes;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (mesh.boundaries[mesh.face_boundary[f]] == boundary)
            nodes.insert(mesh.face(f), mesh.face(f) + mesh.face_nodes(0));
    return nodes;
}

// Rows of the nodes of a boundary, or of those that are chosen, moved by dx; as displacements where asked for.
std::string rows_of(const Mesh& mesh, const std::string& boundary, double dx, bool displacement, const char* comma,
                    const std::function<bool(int)>& is_chosen = [](int) { return true; }) {
    std::ostringstream out;
    out.precision(17);
    for (const int i : nodes_of(mesh, boundary)) {
        if (!is_chosen(i)) continue;
        out << mesh.file.node_id[i];
        for (int a = 0; a < mesh.dim; ++a)
            out << comma << (displacement ? 0 : mesh.x[offset(i, mesh.dim, a)]) + (a == 0 ? dx : 0);
        out << '\n';
    }
    return out.str();
}

double max_difference_of(const std::string& a, const std::string& b) {
    const Mesh left = mesh_of(a), right = mesh_of(b);
    double largest = 0;
    for (std::size_t i = 0; i < left.x.size(); ++i) largest = std::max(largest, std::abs(left.x[i] - right.x[i]));
    return largest;
}

// A ring with 12 faces around whose inner boundary is curved in degree p. Only its vertices have the ids of the linear
// ring.
Mesh curved_ring(int degree) {
    Mesh mesh = with_degree(ring_mesh(12, 3, 6), degree);
    mesh.x = mapped(mesh, [](double* x) {
        const double r = std::hypot(x[0], x[1]), angle = std::atan2(x[1], x[0]);
        const double factor = r < 1.5 ? (1 + 0.1 * std::cos(2 * angle)) / r : 1;
        x[0] *= factor, x[1] *= factor;
    });
    for (std::size_t i = ring_mesh(12, 3, 6).file.node_id.size(); i < mesh.file.node_id.size(); ++i)
        mesh.file.node_id[i] = 9000 - static_cast<long long>(i);
    return mesh;
}

// The largest distance of a node of the boundary from the faces of that boundary in another mesh.
double largest_distance(const Mesh& mesh, const std::string& boundary, const Mesh& other) {
    const PatchBasis basis(mesh.dim - 1, other.degree);
    std::vector<Patch> faces;
    for (int f = 0; f < other.face_count(); ++f)
        if (other.boundaries[other.face_boundary[f]] == boundary)
            faces.push_back(FacePatches(other).of(f, other.x)[0]);
    const ClosestPoint closest(basis, faces);
    double largest = 0;
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int i = 0; i < mesh.face_nodes(0) && mesh.boundaries[mesh.face_boundary[f]] == boundary; ++i) {
            const Vec<3> x = positions(mesh, mesh.x, &mesh.face(f)[i], 1)[0];
            largest = std::max(largest, length(closest.find(x).position - x));
        }
    return largest;
}

}  // namespace

TEST_CASE("the curved faces of a mesh of higher degree, by the ids of their vertices: to the last bit in that degree") {
    const RingDeck ring;
    const Mesh other = curved_ring(3);
    const std::string inner = "boundary inner=mesh " + ring.folder.write("other.msh", msh_of(other));
    const auto final_mesh = [&](const std::vector<std::string>& settings) {
        const Outcome outcome = ring.run(settings);
        CAPTURE(outcome.out);
        CAPTURE(outcome.error);
        CHECK(outcome.code == 0);
        return mesh_of(ring.output + "/final.msh");
    };
    const Mesh cubic = final_mesh({inner, "degree=3"});
    REQUIRE(cubic.faces.size() == other.faces.size());
    CHECK(summary_of(ring.output).at("nodes_off_target") == "0");
    for (int f = 0; f < cubic.face_count(); ++f)
        for (int i = 0; i < 2 * 4; ++i) {
            if (cubic.boundaries[cubic.face_boundary[f]] != "inner") continue;
            REQUIRE(cubic.file.node_id[cubic.face(f)[0]] == other.file.node_id[other.face(f)[0]]);
            CHECK(point(cubic.x, cubic.face(f)[i / 2], 2)[i % 2] == point(other.x, other.face(f)[i / 2], 2)[i % 2]);
        }
    const std::string slides = inner + "; slide";
    for (const std::vector<std::string>& settings :
         {std::vector<std::string>{inner, "degree=1"}, {inner, "degree=4"}, {inner, "refine=1"},
          {inner, "refine=1", "degree=2"}, {slides, "degree=3"}}) {
        CAPTURE(settings[0] + settings[1]);
        CHECK(largest_distance(final_mesh(settings), "inner", other) < 1e-12);
    }
    const Mesh degree_2 = final_mesh({inner, "degree=2"});  // at the middles of the cubics
    CHECK(largest_distance(degree_2, "inner", other) < 1e-12);
    CHECK(degree_2.degree == 2);
}

TEST_CASE("faces of any order of their vertices, in space; of a lower degree; and faces that are missing") {
    const TemporaryFolder folder;
    folder.write("cube.msh", msh_of(cube_mesh(2)));
    Mesh other = with_degree(cube_mesh(2), 3);
    other.x = mapped(other, [](double* x) { x[2] += 0.1 * (1 - x[2]) * std::sin(2 * x[0]) * (1 + x[1]); });
    for (int f = 0; f < other.face_count(); ++f) {  // from another corner
        const LagrangeBasis basis(2, 3);
        const std::vector<int> before(other.face(f), other.face(f) + basis.count);
        for (int i = 0; i < basis.count; ++i)
            other.faces[offset(f, basis.count, i)] = before[basis.permuted_node(i, {1, 2, 0, 3})];
    }
    folder.write("other.msh", msh_of(other));
    const std::string head = "mesh = cube.msh\noutput = " + folder.path("out") + "\ndegree = 3\n";
    const std::string deck = folder.write("a.deck", head + "boundary all = mesh other.msh\n");
    const Outcome outcome = almesh_with({deck});
    CAPTURE(outcome.error);
    REQUIRE(outcome.code == 0);
    const Mesh mesh = mesh_of(folder.path("out/final.msh"));
    CHECK(largest_distance(mesh, "bottom", other) < 1e-12);
    CHECK(largest_distance(mesh, "sides", other) < 1e-12);

    folder.write("quadratic.msh", msh_of(with_degree(cube_mesh(2), 2)));
    folder.write("linear.msh", msh_of(linear_part(other)));
    const std::string lower = folder.write("b.deck", "mesh = quadratic.msh\noutput = " + folder.path("out") +
                                                         "\nboundary all = mesh linear.msh\n");
    REQUIRE(almesh_with({lower}).code == 0);
    CHECK(largest_distance(mesh_of(folder.path("out/final.msh")), "bottom", linear_part(other)) < 1e-12);

    Mesh changed = other;
    for (long long& id : changed.file.node_id) id = id == 1 ? 999 : id;
    folder.write("other.msh", msh_of(changed));
    const Outcome missing = almesh_with({deck});
    CAPTURE(missing.error);
    CHECK(missing.code == 2);
    CHECK(has(missing.error, "of boundary bottom missing, the first with the vertices 1, "));
}

TEST_CASE("a quadrilateral that goes around the same vertices in another order is another face") {
    const TemporaryFolder folder;
    Mesh mesh = raise_degree(solid_mesh(1, "h"), 3);
    folder.write("cube.msh", msh_of(mesh));
    std::swap(mesh.file.node_id[mesh.element(0)[0]], mesh.file.node_id[mesh.element(0)[1]]);
    folder.write("other.msh", msh_of(mesh));
    const Outcome outcome = almesh_with({folder.write("a.deck", "mesh = cube.msh\noutput = " + folder.path("out") +
                                                                    "\nboundary all = mesh other.msh\n")});
    CAPTURE(outcome.error);
    CHECK(outcome.code == 2);
    CHECK(has(outcome.error, "1 face of boundary bottom missing"));
}

TEST_CASE("places, displacements and another run's mesh lead where the motion itself leads") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const std::string expected = ring.folder.write("expected.msh", text_of(ring.output + "/final.msh"));
    const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
    ring.folder.write("places.csv", "id, x, y\n# places\n" + rows_of(mesh, "inner", 2, false, ", "));
    ring.folder.write("moves.txt", rows_of(mesh, "inner", 2, true, " "));
    for (const std::string motion : {"file places.csv", "file moves.txt displacement", "mesh expected.msh"}) {
        CAPTURE(motion);
        const std::string deck = ring.folder.write(
            "by_file.deck", "mesh = ring.msh\noutput = " + ring.output + "\nboundary inner = " + motion +
                                "\nboundary rest = fixed\nthreads = 1\n");
        const Outcome outcome = almesh_with({deck});
        CAPTURE(outcome.error);
        REQUIRE(outcome.code == 0);
        CHECK(max_difference_of(ring.output + "/final.msh", expected) < 1e-12);
        REQUIRE(almesh_with({ring.output + "/deck.txt"}).code == 0);  // the file is found from there too
    }
}

TEST_CASE("a curved target from a mesh of the same degree, and refined or raised from a linear one") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\ndegree = 2\n");
    REQUIRE(ring.run({"boundary inner=circle 0 0 1", "boundary outer=circle 0 0 6"}).code == 0);
    ring.folder.write("curved.msh", text_of(ring.output + "/final.msh"));
    const std::string deck = ring.folder.write("on_curved.deck", "mesh = curved.msh\noutput = " + ring.output +
                                                                     "\nboundary all = mesh curved.msh\n");
    const Outcome curved = almesh_with({deck, "boundary inner=mesh " + ring.folder.path("curved.msh") + "; rotate 20"});
    CAPTURE(curved.out);
    CHECK(curved.code == 0);
    ring.folder.write("moves.txt", rows_of(mesh_of(ring.folder.path("ring.msh")), "inner", 1, true, " "));
    const Outcome raised = ring.run({"degree=3", "refine=1",
                                     "boundary inner=file " + ring.folder.path("moves.txt") + " displacement"});
    CAPTURE(raised.error);
    CHECK(raised.code == 0);
}

TEST_CASE("errors of node files name the line, the node and the boundary") {
    const RingDeck ring;
    const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
    const std::string good = rows_of(mesh, "inner", 2, false, " ");
    const std::string outer = rows_of(mesh, "outer", 0, false, " ");
    const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
        const Outcome outcome = ring.run({"boundary inner=file " + ring.folder.write("nodes.txt", text)});
        CHECK(outcome.code == 2);
        for (const std::string& part : parts) {
            CAPTURE(outcome.error);
            CHECK(has(outcome.error, part));
        }
    };
    const std::string first_row = good.substr(0, good.find('\n') + 1), rest = good.substr(first_row.size());
    refused(rest, {"nodes.txt: 1 node of boundary inner missing",
                   "`file NAME else fixed`, `else slide` or `else free`"});
    const std::string elsewhere = first_row.substr(0, first_row.find_last_of(' ')) + " 77\n";
    refused(good + elsewhere, {"nodes.txt:13:", "has other numbers in line 1"});
    CHECK(ring.run({"boundary inner=file " + ring.folder.write("nodes.txt", good + first_row)}).code == 0);
    refused(outer.substr(0, outer.find('\n') + 1) + good, {"nodes.txt:1:", "is not on boundary inner"});
    refused("1 2\n" + good, {"nodes.txt:1: expected a coordinate"});
    refused("1 2 3 4\n" + good, {"nodes.txt:1: expected the end of the line, or a third coordinate of 0"});
    refused("1 nan 3\n", {"nodes.txt:1:"});
    refused("# none\n", {"12 nodes of boundary inner missing"});
    CHECK(ring.run({"boundary inner=file nowhere.txt"}).code == 2);
    const Outcome disagree = ring.run({"boundary outer=mesh " + ring.folder.path("other.msh")});
    CHECK(disagree.code == 2);
}

TEST_CASE("nodes that a file leaves out stay, slide along the circle that the boundary was, or go where they like") {
    const RingDeck ring;
    const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
    const auto is_listed = [&](int i) { return mesh.x[offset(i, 2)] > 0.3; };
    ring.folder.write("nodes.txt", rows_of(mesh, "inner", 0.3, true, " ", is_listed));
    for (const std::string more : {"degree=1", "degree=3", "refine=1"})
        for (const std::string word : {"fixed", "slide", "free"}) {
            CAPTURE(more + ' ' + word);
            const Outcome outcome = ring.run(
                {more, "boundary inner=file " + ring.folder.path("nodes.txt") + " displacement else " + word});
            CAPTURE(outcome.error);
            REQUIRE(outcome.code == 0);
            const Mesh moved = mesh_of(ring.output + "/final.msh");
            double farthest = 0, off_circle = 0;
            for (const int i : nodes_of(mesh, "inner")) {
                const double *const x = point(mesh.x, i, 2), *const X = point(moved.x, i, 2);
                REQUIRE(moved.file.node_id[i] == mesh.file.node_id[i]);
                if (is_listed(i)) CHECK(std::hypot(X[0] - x[0] - 0.3, X[1] - x[1]) < 1e-15);
                if (is_listed(i)) continue;
                farthest = std::max(farthest, std::hypot(X[0] - x[0], X[1] - x[1]));
                off_circle = std::max(off_circle, std::abs(std::hypot(X[0], X[1]) - 1));
            }
            CHECK((farthest > 0.01) == (word != "fixed"));
            CHECK((off_circle > 0.01) == (word == "free"));
            CHECK((off_circle < 1e-12) == (word != "free"));
        }
}

TEST_CASE("in space: left out on a plane, beside a boundary that keeps the nodes that they share") {
    const TemporaryFolder folder;
    const Mesh mesh = cube_mesh(3);
    folder.write("cube.msh", msh_of(mesh));
    const auto is_listed = [&](int i) {
        return std::hypot(mesh.x[i * 3] - 1.0 / 3, mesh.x[i * 3 + 1] - 1.0 / 3) < 0.1;
    };
    folder.write("nodes.txt", rows_of(mesh, "bottom", 0.1, true, " ", is_listed));
    for (const std::string word : {"fixed", "slide", "free"})
        for (const std::string degree : {"1", "2"}) {
            CAPTURE(word + degree);
            const std::string deck =
                folder.write("a.deck", "mesh = cube.msh\noutput = " + folder.path("out") + "\ndegree = " + degree +
                                           "\nboundary bottom = file nodes.txt displacement else " + word +
                                           "; translate 0 0 -0.1\n"
                                           "boundary sides = expression \"x\" \"y\" \"z - 0.1*(1 - z)\"\n"
                                           "boundary top = fixed\n");
            const Outcome outcome = almesh_with({deck});
            CAPTURE(outcome.error);
            REQUIRE(outcome.code == 0);
            const Mesh moved = mesh_of(folder.path("out/final.msh"));
            double farthest = 0, off_plane = 0;
            for (const int i : nodes_of(mesh, "bottom")) {
                const double *const x = point(mesh.x, i, 3), *const X = point(moved.x, i, 3);
                const bool is_inside = x[0] > 0 && x[0] < 1 && x[1] > 0 && x[1] < 1;
                if (!is_listed(i)) off_plane = std::max(off_plane, std::abs(X[2] + 0.1));
                const double away = std::hypot(X[0] - x[0] - 0.1 * is_listed(i), X[1] - x[1]);
                if (is_inside && !is_listed(i)) farthest = std::max(farthest, away);
                else CHECK(away < 1e-15);
            }
            CHECK((farthest > 1e-3) == (word != "fixed"));
            CHECK((off_plane > 1e-3) == (word == "free"));
            CHECK((off_plane < 1e-12) == (word != "free"));
        }
}

TEST_CASE("a node that a file leaves out goes where another boundary takes it, unless it is to slide elsewhere") {
    const TemporaryFolder folder;
    const Mesh mesh = square_mesh(4);
    folder.write("square.msh", msh_of(mesh));
    folder.write("nodes.txt", rows_of(mesh, "bottom", 0.05, true, " ", [&](int i) { return mesh.x[2 * i] == 0.5; }));
    const auto run = [&](const std::string& word, const std::string& left = "0 0.1") {
        return almesh_with({folder.write("a.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                                                       "\nboundary bottom = file nodes.txt displacement else " + word +
                                                       "\nboundary left = translate " + left +
                                                       "\nboundary right = fixed\n"
                                                       "boundary top = free\n")});
    };
    const Outcome free = run("free");
    CAPTURE(free.error);
    REQUIRE(free.code == 0);
    const Mesh moved = mesh_of(folder.path("out/final.msh"));
    for (const int i : nodes_of(mesh, "bottom")) {
        if (mesh.x[2 * i] == 0) CHECK(std::hypot(moved.x[2 * i], moved.x[2 * i + 1] - 0.1) < 1e-15);
        if (mesh.x[2 * i] == 1) CHECK(std::hypot(moved.x[2 * i] - 1, moved.x[2 * i + 1]) < 1e-15);
    }
    CHECK(has(run("fixed").error, "lies on two boundaries whose motions disagree"));
    CHECK(has(run("slide").error, "lies on the boundary bottom, which slides, and on another one"));
    CHECK(run("slide", "-0.1 0").code == 0);  // along the bottom
}

TEST_CASE("between the vertices that a file has, nodes of a curved mesh that it leaves out go along") {
    const RingDeck ring(curved_ring(3), "threads = 1\n");
    const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
    const std::string path = ring.folder.write(
        "nodes.txt", rows_of(mesh, "inner", 0.5, true, " ", [&](int i) { return mesh.file.node_id[i] < 5000; }));
    for (const std::string word : {"fixed", "slide", "free"}) {
        const Outcome outcome = ring.run({"boundary inner=file " + path + " displacement else " + word});
        CAPTURE(outcome.error);
        REQUIRE(outcome.code == 0);
        const Mesh moved = mesh_of(ring.output + "/final.msh");
        for (const int i : nodes_of(mesh, "inner"))
            CHECK(std::hypot(moved.x[i * 2] - mesh.x[i * 2] - 0.5, moved.x[i * 2 + 1] - mesh.x[i * 2 + 1]) < 1e-12);
    }
}

TEST_CASE("all and rest stand for the boundaries that are not named") {
    const RingDeck ring;
    const std::string head = "mesh = ring.msh\noutput = " + ring.output + "\n";
    CHECK(almesh_with({ring.folder.write("a.deck", head + "boundary all = rotate 20\n")}).code == 0);
    const std::string rest = head + "boundary inner = rotate 20\nboundary rest = fixed\n";
    CHECK(almesh_with({ring.folder.write("b.deck", rest)}).code == 0);
    const Outcome none = almesh_with({ring.folder.write("c.deck", head)});
    CHECK(none.code == 1);
    CHECK(has(none.error, "2 boundary lines missing"));
}
