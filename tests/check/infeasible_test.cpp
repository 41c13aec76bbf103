// Elements that no positions of the nodes that may move make valid: improve lists them and makes all others better.
#include "check/infeasible.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "check/certificate.hpp"
#include "geometry/patch.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Outcome improved(const Mesh& mesh, const std::vector<std::string>& settings = {}) {
    const TemporaryFolder folder;
    folder.write("mesh.msh", msh_of(mesh));
    std::vector<std::string> arguments = {"improve", folder.path("mesh.msh"), "output=" + folder.path("results")};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    return almesh_with(arguments);
}

int node_at(const Mesh& mesh, const Vec<3>& at) {
    int i = 0;
    while (length(positions(mesh, mesh.x, &i, 1)[0] - at) > 1e-9) ++i;
    return i;
}

void move(Mesh& mesh, const Vec<3>& from, const Vec<3>& to) {
    std::copy_n(to.begin(), mesh.dim, point(mesh.x, node_at(mesh, from), mesh.dim));
}

Mesh of_one_boundary(const Mesh& mesh) {
    return linear_mesh(mesh.dim, mesh.x, mesh.elements, [](const double*) { return "wall"; }, mesh.groups);
}

// Three quadrilaterals, the first of which has two edges on the line y = 0; above each of them three hexahedra in 3D.
Mesh with_flat_corner(int dim) {
    const std::vector<double> plane = {0, 0, 1, 0, 2, 0, 1, 1, 2, 1, 2, 2, 0, 2, 0, 1};
    const std::vector<int> quads = {0, 1, 2, 3, 2, 4, 5, 3, 3, 5, 6, 7};
    const auto name = [](const double*) { return "wall"; };
    if (dim == 2) return linear_mesh(2, plane, quads, name, {{&quadrilateral(), 0, 3, 0}});
    std::vector<double> x;
    for (const double z : {0, 1, 2, 3})
        for (std::size_t i = 0; i < plane.size(); i += 2) x.insert(x.end(), {plane[i], plane[i + 1], z});
    std::vector<int> hexes;
    for (const int layer : {0, 8, 16})
        for (std::size_t e = 0; e < quads.size(); e += 4)
            for (const int above : {0, 8})
                for (int k = 0; k < 4; ++k) hexes.push_back(quads[e + k] + layer + above);
    return linear_mesh(3, x, hexes, name, {{&hexahedron(), 0, 9, 0}});
}

// The last triangle is inverted: node (-0.3, 0) is on the wrong side of the edge from (0, -1) to (0, 1).
Mesh with_folded_nose() {
    const std::vector<double> x = {0, -1, 0, 1, -0.3, 0, -1, 0, -1, -1, -1, 1, -2, -2, -2, 2, -2, 0};
    const std::vector<int> triangles = {0, 1, 3, 0, 3, 4, 1, 5, 3, 4, 3, 8, 3, 5, 8, 0, 4, 6, 4, 8, 6, 5, 1, 7, 8, 5, 7,
                                        0, 2, 1};
    const auto name = [](const double* c) { return c[0] > -0.5 && std::abs(c[1]) < 0.9 ? "nose" : "far"; };
    return linear_mesh(2, x, triangles, name);
}

// A row of quadrilaterals with three corners on the floor, of which the middle one has 180 degrees; between them
// triangles, and above a row of other quadrilaterals.
Mesh row_of_flat_corners(int count) {
    std::vector<double> x;
    std::vector<int> elements;
    for (int i = 0; i <= 2 * count; ++i) x.insert(x.end(), {0.5 * i, 0});
    for (int i = 0; i < count; ++i) x.insert(x.end(), {i + (i % 2 ? 0.75 : 0.25), 1});
    for (int i = 0; i < count; ++i) x.insert(x.end(), {i + 0.6, 2});
    const int middle = 2 * count + 1, top = middle + count;
    for (int i = 0; i + 1 < count; ++i) elements.insert(elements.end(), {2 * i + 2, middle + i + 1, middle + i});
    for (int i = 0; i < count; ++i) elements.insert(elements.end(), {2 * i, 2 * i + 1, 2 * i + 2, middle + i});
    for (int i = 0; i + 1 < count; ++i)
        elements.insert(elements.end(), {middle + i, middle + i + 1, top + i + 1, top + i});
    return linear_mesh(2, x, elements, [](const double* c) { return c[1] < 1e-9 ? "floor" : "wall"; },
                       {{&simplex(2), 0, count - 1, 0},
                        {&quadrilateral(), count - 1, 2 * count - 1, static_cast<std::size_t>(3 * (count - 1))}});
}

// Every setting of a boundary in the line `try ...` of a run: "boundary nose=free".
std::vector<std::string> advised(const std::string& out) {
    std::vector<std::string> settings;
    const auto line = out.find("\ntry ");
    for (const std::string& part : pieces(out.substr(line + 5, out.find('\n', line + 1) - line - 5), ';')) {
        const auto begin = part.find("boundary "), equals = part.find(" = "), end = part.find(", if");
        if (begin == std::string::npos || end == std::string::npos) continue;
        for (const std::string word : {"slide", "free"})
            if (has(part.substr(equals, end - equals), word))
                settings.push_back(part.substr(begin, equals - begin) + "=" + word);
    }
    return settings;
}

// Whether the same command accepts what a run advises.
void check_advice(const Mesh& mesh, const Outcome& outcome) {
    CHECK(!has(outcome.out, "split"));
    for (const std::string& setting : advised(outcome.out)) {
        CAPTURE(setting);
        const int code = improved(mesh, {setting}).code;
        CHECK(code != 1);
        CHECK(code != 2);
    }
}

}  // namespace

TEST_CASE("a triangle with two edges in one line of the boundary, wherever its nodes slide") {
    Mesh mesh = of_one_boundary(square_mesh(3));  // the triangle at (1, 0) has two of its edges on the boundary
    move(mesh, {1, 0, 0}, {5.0 / 6, 1.0 / 6, 0});
    move(mesh, {2.0 / 3, 2.0 / 3, 0}, {0.5, 0.75, 0});
    const Outcome outcome = improved(mesh);
    CHECK(outcome.code == 3);
    CHECK(has(outcome.out, "note: 1 element invalid whatever the nodes inside do: all others are made better\n"));
    CHECK(has(outcome.out, "  17  (0.833333, 0.166667)  0  flat by edges that stay in one line of boundary wall\n"));
    CHECK(has(outcome.out, "\ntry a mesh file in which these elements are divided or left out\n"));  // it slides
    CHECK(!has(outcome.out, "certified valid and"));
}

TEST_CASE("a triangle that is inverted between corners, which stay: advice that may be followed, and helps") {
    const Mesh mesh = with_folded_nose();
    const Outcome fixed = improved(mesh, {"boundary nose=fixed", "boundary far=fixed"}), slides = improved(mesh);
    for (const Outcome* outcome : {&fixed, &slides}) {
        CHECK(outcome->code == 3);
        CHECK(has(outcome->out, "  flat or inverted by boundary nodes that stay\n"));
    }
    CHECK(advised(fixed.out) == std::vector<std::string>{"boundary nose=slide", "boundary nose=free",
                                                         "boundary far=slide", "boundary far=free"});
    CHECK(advised(slides.out) == std::vector<std::string>{"boundary nose=free", "boundary far=free"});
    check_advice(mesh, fixed);
    check_advice(mesh, slides);
    for (const std::string far : {"fixed", "slide"})
        CHECK(improved(mesh, {"boundary nose=free", "boundary far=" + far}).code == 0);  // one that is free is free
}

TEST_CASE("a quadrilateral and a hexahedron whose edges at a corner are in one line or plane") {
    for (const int dim : {2, 3})
        for (const std::string hold : {"slide", "fixed"}) {
            const Mesh mesh = with_flat_corner(dim);
            const Outcome outcome = improved(mesh, {"boundary all=" + hold});
            CAPTURE(outcome.out);
            CAPTURE(outcome.error);
            CHECK(outcome.code == 3);
            CHECK(has(outcome.out, hold == "fixed" ? "flat or inverted by boundary nodes that stay\n"
                                   : dim == 2      ? "flat by edges that stay in one line of boundary wall\n"
                                                   : "flat by edges that stay in one plane of boundary "));
            CHECK(has(outcome.out, hold == "fixed" ? " = slide, if its nodes need not " : "try a mesh file in which "));
            check_advice(mesh, outcome);
        }
}

TEST_CASE("many elements that the boundary makes flat: ten are shown, all in a file, and the others become better") {
    const Mesh mesh = row_of_flat_corners(12);
    const TemporaryFolder folder;
    const std::string file = folder.write("mesh.msh", msh_of(mesh)), results = folder.path("results");
    const auto rows = [&] { return pieces(text_of(results + "/invalid.csv"), '\n').size(); };
    const Outcome better = almesh_with({"improve", file, "boundary all=fixed", "output=" + results});
    CAPTURE(better.out);
    CHECK(better.code == 3);
    CHECK(has(better.out, "note: 12 elements invalid whatever "));
    CHECK(has(better.out, "\n  all 12 are listed in " + results + "/invalid.csv\n"));
    CHECK(rows() == 13);  // with the head
    const Mesh before = mesh_of(file);
    std::vector<std::string> notes;
    const Mesh after = build_mesh(read_mesh(results + "/final.msh"), notes, Folds::keep);
    CHECK(after.x != before.x);
    const Certificate certificate = certify(after, after.x);
    CHECK(certificate.uncertified.size() == 12);
    for (const int e : certificate.uncertified) CHECK(certificate.certified_bound[e] > -1e-9);  // flat, not inverted

    const std::string deck = folder.write("move.deck", "mesh = mesh.msh\noutput = " + results +
                                                           "\nboundary all = translate 1 0\nthreads = 1\n");
    const Outcome refused = almesh_with({deck});
    CHECK(refused.code == 2);
    CHECK(has(refused.error, "12 elements with straight sides and a corner of 180 degrees or more (id, centre, "));
    CHECK(has(refused.error, "\n  all 12 are listed in " + results + "/invalid.csv\ntry almesh improve "));
    CHECK(has(refused.error, ", or ideal = regular, which "));
    CHECK(rows() == 13);
    const Outcome moved = almesh_with({deck, "ideal=regular"});
    CAPTURE(moved.out);
    CHECK(moved.code == 3);
    CHECK(has(moved.out, "note: 12 elements invalid whatever "));
    CHECK(has(moved.out, "every boundary node is where its motion takes it"));
    CHECK(!has(almesh_with({deck, "frames=0 1"}).error, "ideal = regular"));  // does not go with frames
}

TEST_CASE("a fixed boundary that crosses itself") {
    Mesh mesh = square_mesh(4);
    move(mesh, {0.5, 0, 0}, {0.9, 0, 0});
    CHECK(improved(mesh).code == 0);  // where it slides it need not
    const Outcome outcome = improved(mesh, {"boundary rest=fixed"});
    CHECK(outcome.code == 3);
    CHECK(has(outcome.out, "  no positions were found at which it is valid\n"));
    CHECK(has(outcome.out, "try boundary bottom = slide or free, if its nodes need not keep their positions; "));
    check_advice(mesh, outcome);
}
