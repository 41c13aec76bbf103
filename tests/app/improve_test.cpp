// almesh improve FILE, and ideal = regular | size FORMULA | mesh FILE: meshes with inverted elements made valid, and
// valid ones better.
#include "app/improve.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "check/scaled_jacobian.hpp"
#include "mesh/part.hpp"
#include "io/su2.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<char> on_boundary(const Mesh& mesh) {
    std::vector<char> is(mesh.nodes(), 0);
    for (const int i : mesh.faces) is[i] = 1;
    return is;
}

enum class Tangle { pushed, point, random };

Mesh tangled(Mesh mesh, Tangle how) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(0, 1);
    const std::vector<char> fixed = on_boundary(mesh);
    const int first = static_cast<int>(std::find(fixed.begin(), fixed.end(), 0) - fixed.begin());
    const std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i)
        for (int a = 0; a < mesh.dim && !fixed[i]; ++a) {
            double& to = point(mesh.x, i, mesh.dim)[a];
            if (how == Tangle::random) to = number(random);
            if (how == Tangle::point) to = point(x, first, mesh.dim)[a];
            if (how == Tangle::pushed && i == first) to += 0.6;
        }
    return mesh;
}

// The file `name` of the folder is improved; the results are in results/ there.
Outcome improved(const TemporaryFolder& folder, const std::string& name, std::vector<std::string> settings = {}) {
    settings.insert(settings.begin(), {"improve", folder.path(name), "output=" + folder.path("results"), "threads=1"});
    return almesh_with(settings);
}

// Of a mesh file: without nodes, boxes of entities, and what the program says of itself.
std::string without_positions(const std::string& text) {
    std::string rest, section;
    for (const std::string& line : pieces(text, '\n')) {
        if (line.starts_with("$") || line.starts_with("N")) section = line.substr(0, line.find('='));
        if (section == "$Nodes" || section == "$Entities" || section == "NPOIN" || line.empty()) continue;
        if (line.starts_with("almesh ") || line.starts_with("% almesh ")) continue;
        rest += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    const std::string own = "$Comments\n$EndComments\n";
    if (rest.ends_with(own)) rest.resize(rest.size() - own.size());
    return rest;
}

}  // namespace

TEST_CASE("meshes of all cells with inverted, flat and folded elements come out certified") {
    std::vector<Mesh> meshes = {square_mesh(5), quad_mesh(5), mixed_mesh(4), cube_mesh(3)};
    for (const char* layers : {"hhh", "ppp", "hdu"}) meshes.push_back(solid_mesh(3, layers));
    for (const Mesh& mesh : meshes)
        for (const Tangle how : {Tangle::pushed, Tangle::point, Tangle::random}) {
            const TemporaryFolder folder;
            folder.write("tangled.msh", msh_of(tangled(mesh, how)));
            CAPTURE(mesh.elements_text());
            CAPTURE(static_cast<int>(how));
            const Outcome outcome = improved(folder, "tangled.msh");
            CHECK(outcome.code == 0);
            CHECK(has(outcome.out, " invalid in the file, 0 left after "));
            const Mesh result = mesh_of(folder.path("results/final.msh"));
            CHECK(least_corner_jacobian(result, result.x) > 0.05);
        }
}

TEST_CASE("curved meshes too, of all nodes, and only the region around what is inverted before the rest") {
    for (const Mesh& mesh : {square_mesh(4), quad_mesh(4), cube_mesh(2)}) {
        const TemporaryFolder folder;
        folder.write("curved.msh", msh_of(tangled(raise_degree(mesh, 2), Tangle::pushed)));
        const Outcome outcome = improved(folder, "curved.msh");
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, ", 0 left after "));
        CHECK(has(outcome.out, " in 1 region\n"));
    }
}

TEST_CASE("a mesh of which most elements are inverted has the orientation of its boundary") {
    Mesh mesh = square_mesh(9);
    const std::vector<char> fixed = on_boundary(mesh);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (!fixed[i]) mesh.x[2 * i] = 1 - mesh.x[2 * i];
    const TemporaryFolder folder;
    folder.write("mirrored.msh", msh_of(mesh));
    CHECK(improved(folder, "mirrored.msh").code == 0);
}

TEST_CASE("where nodes that slide go past the corners of a hole they stay where they are") {
    const Mesh square = square_mesh(9);
    std::vector<char> chosen;
    for (int e = 0; e < square.element_count(); ++e) {
        const Vec<3> at = element_centre(square, square.x, e);
        chosen.push_back(std::max(std::abs(at[0] - 0.5), std::abs(at[1] - 0.5)) > 1.0 / 6);
    }
    const Mesh part = part_of(square, chosen, "hole");
    const auto is_of_hole = [](const double* at) { return std::hypot(at[0] - 0.5, at[1] - 0.5) < 0.3; };
    Mesh mesh = linear_mesh(2, part.x, part.elements,
                            [&](const double* centre) { return is_of_hole(centre) ? "hole" : "outside"; });
    const std::vector<char> fixed = on_boundary(mesh);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (double* const at = point(mesh.x, i, 2); fixed[i] && is_of_hole(at)) at[0] = 1 - at[0], at[1] = 1 - at[1];
    const TemporaryFolder folder;
    folder.write("turned.msh", msh_of(mesh));
    const Outcome outcome = improved(folder, "turned.msh");
    CHECK(outcome.code == 0);
    CHECK(outcome.error == "");
    CHECK(has(outcome.out, "stay where they are"));
    const Mesh after = mesh_of(folder.path("results/final.msh"));
    for (const int i : mesh.faces)
        for (int a = 0; a < 2 && is_of_hole(point(mesh.x, i, 2)); ++a) CHECK(after.x[2 * i + a] == mesh.x[2 * i + a]);
}

TEST_CASE("the least scaled Jacobian of a valid mesh is never lower afterwards, and the boundary keeps its shape") {
    for (const char* name :
         {"circle", "square", "bump", "circle-quads", "kinds", "cube", "block", "plate", "inclusion"}) {
        const TemporaryFolder folder;
        const std::string file = std::string("inputs/meshes/") + name + ".msh";
        CAPTURE(file);
        const Outcome outcome = almesh_with({"improve", file, "output=" + folder.path("results")});
        CHECK(outcome.code == 0);
        const Mesh before = mesh_of(file), after = mesh_of(folder.path("results/final.msh"));
        CHECK(least_corner_jacobian(after, after.x) >= least_corner_jacobian(before, before.x));
        CHECK(certify(after, after.x).min_scaled_jacobian >= certify(before, before.x).min_scaled_jacobian);
        REQUIRE(has(outcome.out, "  after "));
        CHECK(words(outcome.out.substr(outcome.out.find("  after ")))[1] ==
              rounded_down(least_corner_jacobian(after, after.x), 4));
    }
}

TEST_CASE("the file is written as it came but for positions: groups, faces inside or in no group, other sections") {
    const std::string msh = text_of("inputs/meshes/inclusion.msh");  // 4.1, with faces between two groups
    const Mesh mesh = mesh_of("inputs/meshes/inclusion.msh");
    std::string ungrouped = msh_of(square_mesh(5)), no_faces;
    ungrouped.erase(ungrouped.find("$PhysicalNames"), ungrouped.find("$Nodes") - ungrouped.find("$PhysicalNames"));
    std::size_t faces = 0;
    for (const std::string& line : pieces(ungrouped, '\n')) {
        const auto cells = words(line);
        const bool is_face = cells.size() == 7 && cells[1] == "1" && cells[2] == "2";
        faces += is_face;
        if (!is_face && !line.empty()) no_faces += line + "\n";
    }
    REQUIRE(faces == 20);
    no_faces.replace(no_faces.find("$Elements\n70\n"), 13, "$Elements\n50\n");
    const std::string extra = "$Comments\nby hand\n$EndComments\n"
                              "$NodeData\n1\n\"u\"\n1\n0\n3\n0\n1\n1\n1 2.5\n$EndNodeData\n";
    const std::string msh22 = msh_text(mesh, mesh.x, {FileFormat::Kind::msh, 22});
    const std::string msh40 = msh_text(mesh, mesh.x, {FileFormat::Kind::msh, 40});
    const TemporaryFolder other;
    write_su2(other.path("mesh.su2"), mesh, mesh.x);
    const std::string su2 = text_of(other.path("mesh.su2"));
    for (const std::string& text : {msh + extra, msh22 + extra, msh40 + extra, su2, ungrouped, no_faces}) {
        const bool is_su2 = !text.starts_with("$");
        const TemporaryFolder folder;
        folder.write(is_su2 ? "mesh.su2" : "mesh.msh", text);
        REQUIRE(improved(folder, is_su2 ? "mesh.su2" : "mesh.msh").code == 0);
        const std::string final = text_of(folder.path(is_su2 ? "results/final.su2" : "results/final.msh"));
        CHECK(final != text);
        CHECK(without_positions(final) == without_positions(text));
    }
}

TEST_CASE("where no mesh is better the file's is written, with its positions") {
    const TemporaryFolder folder;
    const Outcome outcome = almesh_with({"improve", "inputs/meshes/rotor.msh", "output=" + folder.path("results")});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "the mesh stays as it is"));
    CHECK(mesh_of(folder.path("results/final.msh")).x == mesh_of("inputs/meshes/rotor.msh").x);
}

TEST_CASE("ideal = size: edges as long as the formula has them") {
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(square_mesh(10)));
    REQUIRE(improved(folder, "square.msh", {"ideal=size \"0.04 + 0.12*x\"", "objective=size_shape"}).code == 0);
    const Mesh mesh = mesh_of(folder.path("results/final.msh"));
    double left = 0, right = 0;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const double x = element_centre(mesh, mesh.x, e)[0];
        if (x < 0.3) left = std::max(left, volume(mesh, mesh.x, e));
        if (x > 0.8) right = std::max(right, volume(mesh, mesh.x, e));
    }
    CHECK(right > 2 * left);
    CHECK(has(text_of(folder.path("results/deck.txt")), "\nideal = size \"0.04 + 0.12*x\"\n"));
}

TEST_CASE("ideal = mesh: a moved mesh is untangled towards the mesh before the motion") {
    const TemporaryFolder folder;
    const Mesh before = ring_mesh(12, 3, 6);
    folder.write("before.msh", msh_of(before));
    folder.write("moved.msh", msh_of(tangled(before, Tangle::pushed)));
    const std::string ideal = "ideal=mesh \"" + folder.path("before.msh") + "\"";
    REQUIRE(improved(folder, "moved.msh", {ideal, "boundary rest=fixed", "objective=squared"}).code == 0);
    const std::vector<double> x = mesh_of(folder.path("results/final.msh")).x;
    for (std::size_t k = 0; k < x.size(); ++k) CHECK(std::abs(x[k] - before.x[k]) < 1e-6);
    folder.write("other.msh", msh_of(ring_mesh(12, 4, 6)));
    const Outcome outcome = improved(folder, "moved.msh", {"ideal=mesh \"" + folder.path("other.msh") + "\""});
    CHECK(outcome.code == 2);
    CHECK(has(outcome.error, "other.msh: it has 96 elements, the mesh of the run 72"));
}

TEST_CASE("an element that the boundary keeps flat is refused, with its place; another one is told to be left") {
    const TemporaryFolder folder;
    Mesh mesh = square_mesh(3);
    const std::vector<char> fixed = on_boundary(mesh);
    const auto is_in_corner = [&](int e) {
        return std::all_of(mesh.element(e), mesh.element(e) + 3, [&](int i) { return fixed[i]; });
    };
    int corner = 0, vertex = 0;
    while (!is_in_corner(corner)) ++corner;
    const auto at = [&](int k) { return point(mesh.x, mesh.element(corner)[k], 2); };
    const auto is_edge = [&](int k) { return at(k)[0] == at((k + 1) % 3)[0] || at(k)[1] == at((k + 1) % 3)[1]; };
    while (!is_edge(vertex) || !is_edge((vertex + 2) % 3)) ++vertex;  // with the right angle
    for (const double to : {0.5, 1.2}) {
        Mesh flat = mesh;
        for (int a = 0; a < 2; ++a) {
            const double middle = 0.5 * (at((vertex + 1) % 3)[a] + at((vertex + 2) % 3)[a]);
            point(flat.x, mesh.element(corner)[vertex], 2)[a] += 2 * to * (middle - at(vertex)[a]);
        }
        folder.write("flat.msh", msh_of(flat));
        const Outcome outcome = improved(folder, "flat.msh");
        CHECK(outcome.code == (to == 0.5 ? 2 : 3));
        CHECK(has(outcome.error + outcome.out, to == 0.5 ? "2 faces on the boundary, which lie in one line"
                                                         : "1 element invalid in the file, 1 left after "));
    }
}

TEST_CASE("what cannot be improved, and what does not go with it, is refused") {
    const TemporaryFolder folder;
    folder.write("ring.msh", msh_of(ring_mesh(12, 3, 6)));
    CHECK(has(almesh_with({"improve"}).error, "improve takes a mesh file"));
    for (const char* setting : {"frames=0, 1", "start=coarse", "split=auto", "local_repair=1", "method=harmonic"}) {
        const Outcome outcome = improved(folder, "ring.msh", {setting});
        CAPTURE(setting);
        CHECK(outcome.code == 1);
        CHECK(has(outcome.error, " does not go with "));
    }
    CHECK(has(improved(folder, "ring.msh", {"ideal=size \"x\""}).error, "it has to be a positive length everywhere"));
    CHECK(has(improved(folder, "ring.msh", {"ideal=size \"1 + t\""}).error, "it may name x, y, z, not the time"));
    CHECK(has(improved(folder, "ring.msh", {"ideal=regula"}).error, "did you mean `regular`"));
}
