// `almesh quality FILE before=FILE`.
#include <doctest/doctest.h>

#include <cmath>

#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// The rows of the table of distances: cells by boundary.
std::map<std::string, std::vector<std::string>> distances_in(const std::string& out) {
    std::map<std::string, std::vector<std::string>> rows;
    const std::vector<std::string> lines = pieces(out, '\n');
    for (std::size_t k = 0; k < lines.size(); ++k)
        if (lines[k].starts_with("distance of the faces from those of "))
            for (k += 2; k < lines.size() && !lines[k].empty(); ++k) {
                const auto cells = words(lines[k]);
                rows[std::string(cells[0])].assign(cells.begin() + 1, cells.end());
            }
    return rows;
}

// A ring of degree 2 with straight sides, and the same with its inner circle scaled by `factor`.
struct Rings {
    TemporaryFolder folder;
    Mesh mesh = with_degree(ring_mesh(8, 2, 3), 2);
    std::string before = folder.write("before.msh", msh_of(mesh)), after;

    explicit Rings(double factor) {
        Mesh moved = mesh;
        moved.x = mapped(mesh, [factor](double* p) {
            if (std::hypot(p[0], p[1]) < 1 + 1e-9) p[0] *= factor, p[1] *= factor;
        });
        after = folder.write("after.msh", msh_of(moved));
    }
};

}  // namespace

TEST_CASE("quality with before= tells how far each boundary is from the mesh as it was, and nothing where it is there") {
    const Rings rings(0.9);
    const Outcome outcome = almesh_with({"quality", rings.after, "before=" + rings.before, "threads=1"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "those of " + rings.before));
    const auto rows = distances_in(outcome.out);
    REQUIRE(rows.size() == 1);
    const std::vector<std::string>& inner = rows.at("inner");
    CHECK(inner[0] == "8");
    CHECK(inner[1] == "8");
    CHECK(inner[2] == "100.0");
    // All sides of an octagon moved inwards in parallel; its vertices are as far from both of theirs.
    const double apothem = std::cos(std::acos(-1.0) / 8);
    CHECK(parse_double(inner[4]).value() == doctest::Approx(0.1 * apothem).epsilon(1e-2));
    CHECK(parse_double(inner[5]).value() == doctest::Approx(0.1 * apothem).epsilon(1e-2));

    const Outcome same = almesh_with({"quality", rings.before, "before=" + rings.before});
    CHECK(same.code == 0);
    CHECK(has(same.out, "all faces are where " + rings.before + " has them\n"));
    CHECK(distances_in(same.out).empty());
    const std::string without = almesh_with({"quality", rings.before}).out;
    CHECK(!has(without, "faces"));
}

TEST_CASE("quality with before=: nodes go by their ids, and a mesh of a lower degree is raised") {
    const Rings rings(0.9);
    const std::string expected = almesh_with({"quality", rings.after, "before=" + rings.before}).out;
    Mesh numbered = rings.mesh;  // the first node last
    std::vector<int> last(numbered.nodes());
    for (int i = 0; i < numbered.nodes(); ++i) last[i] = (i + numbered.nodes() - 1) % numbered.nodes();
    for (int i = 0; i < numbered.nodes(); ++i) {
        std::copy_n(point(rings.mesh.x, i, 2), 2, point(numbered.x, last[i], 2));
        numbered.file.node_id[last[i]] = rings.mesh.file.node_id[i];
    }
    for (std::vector<int>* const nodes : {&numbered.elements, &numbered.faces})
        for (int& i : *nodes) i = last[i];
    const std::string other = rings.folder.write("other.msh", msh_of(numbered));
    CHECK(distances_in(almesh_with({"quality", rings.after, "before=" + other}).out) == distances_in(expected));
    const std::string linear = rings.folder.write("linear.msh", msh_of(ring_mesh(8, 2, 3)));
    CHECK(distances_in(almesh_with({"quality", rings.after, "before=" + linear}).out) == distances_in(expected));
}

TEST_CASE("quality with before= refuses another mesh, a finer degree and a file that is none") {
    const Rings rings(0.9);
    Mesh renumbered = rings.mesh;
    for (long long& id : renumbered.file.node_id) id += 1000;
    Mesh shifted = rings.mesh;
    for (long long& id : shifted.file.element_id) id += 1000;
    const std::vector<Mesh> others = {renumbered, shifted, with_degree(ring_mesh(8, 1, 3), 2),
                                      with_degree(ring_mesh(8, 2, 3), 3), with_degree(cube_mesh(1), 2)};
    for (const Mesh& mesh : others) {
        const std::string other = rings.folder.write("other.msh", msh_of(mesh));
        const Outcome outcome = almesh_with({"quality", rings.after, "before=" + other});
        CHECK(outcome.code == 2);
        CHECK(has(outcome.error, other + ": this is not the same mesh as it was before"));
    }
    CHECK(almesh_with({"quality", rings.after, "before=" + rings.folder.path("none.msh")}).code == 2);
    CHECK(almesh_with({"quality", "before=" + rings.before}).code == 2);  // no such mesh
    CHECK(has(almesh_with({"info", rings.after, "before=" + rings.before}).error, "`before`"));
    CHECK(has(almesh_with({"--help"}).out, "before=FILE"));
}
