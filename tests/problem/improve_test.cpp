// almesh improve FILE, and ideal = regular | size FORMULA | mesh FILE: meshes with inverted elements made valid, and
// valid ones better.
#include "problem/improve.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "check/boundary_distance.hpp"
#include "check/scaled_jacobian.hpp"
#include "mesh/part.hpp"
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

TEST_CASE("curved meshes too, whose sides inside come out straight where the boundary is") {
    for (const Mesh& mesh : {square_mesh(4), quad_mesh(4), cube_mesh(2)}) {
        const TemporaryFolder folder;
        folder.write("curved.msh", msh_of(tangled(raise_degree(mesh, 2), Tangle::pushed)));
        const Outcome outcome = improved(folder, "curved.msh");
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, ", 0 left after "));
        CHECK(has(outcome.out, ": improved with straight sides, and curved again; certified bound from -"));
        const Mesh after = mesh_of(folder.path("results/final.msh"));
        CHECK(certify(after, after.x).min_certified_bound > 0.999 * (mesh.is_simplicial() ? 1 : 0.7));
    }
}

TEST_CASE("a curved mesh of which some nodes have been thrown far, of one region with nearly all elements") {
    Mesh mesh = raise_degree(mesh_of("inputs/meshes/circle.msh"), 2);
    const std::vector<char> fixed = on_boundary(mesh);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> far(-10, 10);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (!fixed[i] && random() % 25 == 0)
            for (int a = 0; a < 2; ++a) mesh.x[2 * i + a] += far(random);
    const TemporaryFolder folder;
    folder.write("thrown.msh", msh_of(mesh));
    const Outcome outcome = improved(folder, "thrown.msh");
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, ", 0 left after "));
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

TEST_CASE("nodes of the boundary that have been pushed past others along it, or onto them, slide back") {
    // The first node that is on one side or face alone goes by so much.
    const auto pushed = [](Mesh mesh, double by, bool around) {
        const Mesh before = mesh;
        for (const int i : before.faces) {
            const double* const x = point(before.x, i, mesh.dim);
            if (around ? std::hypot(x[0], x[1]) < 5.99 : x[1] != 0 || x[0] == 0 || x[mesh.dim - 1] == 1) continue;
            if (mesh.dim == 3 && x[2] == 0) continue;
            double* const to = point(mesh.x, i, mesh.dim);
            if (around) {
                to[0] = x[0] * std::cos(by) - x[1] * std::sin(by);
                to[1] = x[0] * std::sin(by) + x[1] * std::cos(by);
            } else to[0] += by;
            break;
        }
        return mesh;
    };
    const std::vector<Mesh> meshes = {square_mesh(5),      quad_mesh(5), mixed_mesh(4), cube_mesh(4),
                                      solid_mesh(4, "hhhh"), solid_mesh(4, "pppp"), ring_mesh(16, 3, 6)};
    for (const Mesh& mesh : meshes) {
        const bool around = &mesh == &meshes.back();
        const double neighbour = around ? 2 * std::numbers::pi / 16 : mesh.x[1 * mesh.dim] - mesh.x[0];
        for (const double by : {1.0, 1.4}) {
            const TemporaryFolder folder;
            const Mesh tangled = pushed(mesh, by * neighbour, around);
            folder.write("tangled.msh", msh_of(tangled));
            CAPTURE(mesh.elements_text());
            CAPTURE(by);
            const Outcome outcome = improved(folder, "tangled.msh");
            CHECK(outcome.code == 0);
            CHECK(has(outcome.out, ", 0 left after "));
            const Mesh after = mesh_of(folder.path("results/final.msh"));
            CHECK(after.x != tangled.x);
            for (const int i : mesh.faces) {
                const double *const x = point(after.x, i, mesh.dim), *const was = point(mesh.x, i, mesh.dim);
                for (int a = 0; a < mesh.dim && !around; ++a)
                    if (was[a] == 0 || was[a] == 1) CHECK(std::abs(x[a] - was[a]) < 1e-12);
                if (around) CHECK(std::abs(std::hypot(x[0], x[1]) - std::hypot(was[0], was[1])) < 1e-9);
            }
        }
    }
}

TEST_CASE("the end of a slit stays where it is while nodes inside and of the boundary are untangled") {
    Mesh mesh = square_mesh(6);  // the slit is between (1/2, 1/2) and the side at x = 1
    std::vector<int> other(mesh.nodes(), -1);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (const double* const x = point(mesh.x, i, 2); x[1] == 0.5 && x[0] > 0.5) other[i] = 0;
    for (int i = 0, count = mesh.nodes(); i < count; ++i)
        if (other[i] == 0) {
            other[i] = static_cast<int>(mesh.x.size()) / 2;
            mesh.x.insert(mesh.x.end(), {mesh.x[2 * i], mesh.x[2 * i + 1]});
        }
    for (int e = 0; e < mesh.element_count(); ++e) {
        if (element_centre(mesh, mesh.x, e)[1] < 0.5) continue;
        for (int k = 0; k < 3; ++k)
            if (int& i = mesh.elements[3 * e + k]; i < static_cast<int>(other.size()) && other[i] >= 0) i = other[i];
    }
    const Mesh slit = linear_mesh(2, mesh.x, mesh.elements, [](const double*) { return "boundary"; });
    Mesh pushed = slit;
    const auto is_at = [&](int i, double x, double y) {
        return std::hypot(slit.x[2 * i] - x, slit.x[2 * i + 1] - y) < 1e-9;
    };
    int tip = 0, inside = 0, side = 0;
    while (!is_at(tip, 0.5, 0.5)) ++tip;
    while (!is_at(side, 1.0 / 6, 0)) ++side;
    while (!is_at(inside, 1.0 / 3, 5.0 / 6)) ++inside;
    pushed.x[2 * inside] += 0.3;
    pushed.x[2 * side] += 0.25;
    const TemporaryFolder folder;
    folder.write("slit.msh", msh_of(pushed));
    const Outcome outcome = improved(folder, "slit.msh");
    CHECK(has(outcome.out, " slide along: straight line (7 parts)"));
    CHECK(has(outcome.out, ", 0 left after "));
    const Mesh after = mesh_of(folder.path("results/final.msh"));
    CHECK(after.x[2 * tip] == pushed.x[2 * tip]);
    CHECK(after.x[2 * tip + 1] == pushed.x[2 * tip + 1]);
}

TEST_CASE("the corners of a hole that is turned by 180 degrees stay, and nodes between them slide") {
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
    const Mesh after = mesh_of(folder.path("results/final.msh"));
    int corners = 0;
    for (const int i : mesh.faces) {
        const double* const at = point(mesh.x, i, 2);
        if (!is_of_hole(at) || std::abs(std::abs(at[0] - 0.5) - std::abs(at[1] - 0.5)) > 1e-9) continue;
        ++corners;
        for (int a = 0; a < 2; ++a) CHECK(after.x[2 * i + a] == mesh.x[2 * i + a]);
    }
    CHECK(corners == 8);  // each of two faces
    for (const BoundaryDistance& of : boundary_distances(mesh, mesh.x, after.x)) CHECK(of.relative_largest < 1e-9);
}

TEST_CASE("the least scaled Jacobian of a valid mesh is never lower afterwards, and the boundary keeps its shape") {
    for (const char* name :
         {"circle", "square", "bump", "circle-quads", "kinds", "cube", "block", "plate", "inclusion", "layer", "piston",
          "sphere-shell", "inclusion-3d", "twist"}) {
        const TemporaryFolder folder;
        const std::string file = std::string("inputs/meshes/") + name + ".msh";
        CAPTURE(file);
        const Outcome outcome = almesh_with({"improve", file, "output=" + folder.path("results")});
        CHECK(outcome.code == 0);
        const Mesh before = mesh_of(file), after = mesh_of(folder.path("results/final.msh"));
        CHECK(least_corner_jacobian(after, after.x) >= least_corner_jacobian(before, before.x));
        CHECK(certify(after, after.x).valid);
        if (before.degree > 1) CHECK(certify(after, after.x).min_certified_bound >= certify(before, before.x).min_certified_bound);
        for (const BoundaryDistance& of : boundary_distances(before, before.x, after.x))
            CHECK(of.relative_largest <= 1e-3);
        REQUIRE(has(outcome.out, "  after "));
        CHECK(words(outcome.out.substr(outcome.out.find("  after ")))[1] ==
              rounded_down(least_corner_jacobian(after, after.x), 4));
    }
}

TEST_CASE("the least scaled Jacobian of all cells is raised, unless another objective is asked for") {
    for (const Mesh& mesh : {square_mesh(6), quad_mesh(5), solid_mesh(3, "hdu")}) {
        const TemporaryFolder folder;
        folder.write("tangled.msh", msh_of(tangled(mesh, Tangle::random)));
        const auto least = [&](const std::vector<std::string>& settings, bool raises) {
            CHECK(has(improved(folder, "tangled.msh", settings).out, " raised from ") == raises);
            const Mesh after = mesh_of(folder.path("results/final.msh"));
            return least_corner_jacobian(after, after.x);
        };
        const double raised = least({}, true), of_objective = least({"objective=deviation"}, false);
        CHECK(raised > (mesh.is_simplicial() ? 1.005 : 0.9999) * of_objective);
        CHECK(least({"objective=minimax"}, true) > of_objective);
    }
}

TEST_CASE("stop = valid ends when the mesh is valid, and moves nothing that was") {
    const Mesh mesh = tangled(cube_mesh(4), Tangle::pushed);
    const TemporaryFolder folder;
    folder.write("tangled.msh", msh_of(mesh));
    CHECK(improved(folder, "tangled.msh", {"stop=valid"}).code == 0);
    const Mesh valid = mesh_of(folder.path("results/final.msh"));
    int moved = 0;
    for (int i = 0; i < mesh.nodes(); ++i)
        moved += !std::equal(point(mesh.x, i, 3), point(mesh.x, i, 3) + 3, point(valid.x, i, 3));
    CHECK(moved > 0);
    CHECK(moved < mesh.nodes() / 2);
    folder.write("valid.msh", msh_of(valid));
    CHECK(improved(folder, "valid.msh", {"stop=valid"}).code == 0);
    CHECK(mesh_of(folder.path("results/final.msh")).x == valid.x);
}

TEST_CASE("what a user reads of a mesh that is made better has at most twelve lines, and says what keeps it from more") {
    const TemporaryFolder folder;
    folder.write("tangled.msh", msh_of(tangled(solid_mesh(4, "hhhh"), Tangle::random)));
    const Outcome outcome = improved(folder, "tangled.msh");
    CHECK(std::count(outcome.out.begin(), outcome.out.end(), '\n') <= 12);
    for (const char* what : {" invalid in the file, 0 left after ", " raised from ", " has it",
                             "sizes changed by up to ", " (free: no layers of flat cells)\n",
                             " s; results in "})
        CHECK(has(outcome.out, what));
    // A corner of the mesh whose nodes are all held.
    folder.write("fan.msh", msh_of(square_mesh(1)));
    CHECK(has(improved(folder, "fan.msh", {"boundary all=fixed"}).out, ", all of whose nodes are held"));
}

TEST_CASE("a boundary that is fixed keeps its bits") {
    const Mesh mesh = tangled(cube_mesh(3), Tangle::random);
    const TemporaryFolder folder;
    folder.write("tangled.msh", msh_of(mesh));
    for (const char* const fixed : {"boundary rest=fixed", "boundary all=fixed"}) {
        CHECK(improved(folder, "tangled.msh", {fixed}).code == 0);
        const Mesh after = mesh_of(folder.path("results/final.msh"));
        for (const int i : mesh.faces)
            for (int a = 0; a < 3; ++a) CHECK(point(after.x, i, 3)[a] == point(mesh.x, i, 3)[a]);
    }
}

TEST_CASE("where the minimum of an objective would lose what is guarded, what does not is taken, or the file's mesh") {
    const TemporaryFolder folder;
    const std::vector<std::string> rotor = {"improve", "inputs/meshes/rotor.msh", "output=" + folder.path("results"),
                                            "objective=squared"};
    const Outcome outcome = almesh_with(rotor);
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "note: some nodes stay, where an element would become worse than the worst before"));
    const Mesh before = mesh_of("inputs/meshes/rotor.msh"), after = mesh_of(folder.path("results/final.msh"));
    CHECK(after.x != before.x);
    CHECK(least_corner_jacobian(after, after.x) >= least_corner_jacobian(before, before.x));
    auto summary = summary_of(folder.path("results"));  // of what was done in vain, too
    const auto rows = csv_rows(text_of(folder.path("results/history.csv")));
    const auto is_step = [](const auto& row) { return row[0] == "newton"; };
    CHECK(*parse_int(summary["earlier_newton_iterations"]) >= std::count_if(rows.begin(), rows.end(), is_step));
    CHECK(std::any_of(rows.begin(), rows.end(), is_step));
    CHECK(*parse_double(summary["time_total"]) > 0);
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

TEST_CASE("what cannot be improved, and what does not go with it, is refused") {
    const TemporaryFolder folder;
    folder.write("ring.msh", msh_of(ring_mesh(12, 3, 6)));
    CHECK(has(almesh_with({"improve"}).error, "improve takes a mesh file"));
    for (const char* setting : {"frames=0, 1", "start=coarse", "split=auto", "local_repair=1"}) {
        const Outcome outcome = improved(folder, "ring.msh", {setting});
        CAPTURE(setting);
        CHECK(outcome.code == 1);
        CHECK(has(outcome.error, " does not go with "));
    }
    CHECK(has(improved(folder, "ring.msh", {"ideal=size \"x\""}).error, "it has to be a positive length everywhere"));
    CHECK(has(improved(folder, "ring.msh", {"ideal=size \"1 + t\""}).error, "the formula may name x, y, z, not the time"));
    CHECK(has(improved(folder, "ring.msh", {"ideal=regula"}).error, "did you mean `regular`"));
}
