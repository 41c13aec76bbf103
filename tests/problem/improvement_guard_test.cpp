// What a mesh that is made better may not lose.
#include "problem/improvement_guard.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "check/certificate.hpp"
#include "check/scaled_jacobian.hpp"
#include "deck/deck.hpp"
#include "mesh/split.hpp"
#include "problem/base_mesh.hpp"
#include "problem/corner_smoothing.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Unit square or cube with layers at the last coordinate 0: thickness 0.001, growing by 1.6.
Mesh layered(Mesh mesh) {
    const int n = mesh.dim - 1;
    for (int i = 0; i < mesh.nodes(); ++i) {
        double& y = point(mesh.x, i, mesh.dim)[n];
        y = (std::pow(1.6, 10 * y) - 1) / (std::pow(1.6, 10) - 1) * 0.2;
    }
    return mesh;
}

Mesh shaken(Mesh mesh) {
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, mesh.dim);
        double wave = 0.05 * std::sin(40.0 * i);
        for (int a = 0; a < mesh.dim; ++a) wave *= x[a] > 1e-12 && x[a] < 1 - 1e-12 && std::abs(x[a] - 0.2) > 1e-9;
        x[0] += wave;
    }
    return mesh;
}

// Largest change of the height of the cells at faces with the last coordinate 0, and of any element's size.
std::pair<double, double> changes(const Mesh& before, const Mesh& after) {
    const std::vector<double> a = element_sizes(before, before.x), b = element_sizes(after, after.x);
    std::pair<double, double> largest{0, 0};
    for (int e = 0; e < before.element_count(); ++e) largest.second = std::max(largest.second, std::abs(std::log(b[e] / a[e])));
    for (int f = 0; f < before.face_count(); ++f) {
        bool is_wall = true;
        for (const int i : before.face_vertices(f)) is_wall = is_wall && point(before.x, i, before.dim)[before.dim - 1] == 0;
        const int e = before.face_element[f];
        if (is_wall) largest.first = std::max(largest.first, std::abs(std::log(volume(after, after.x, e) / volume(before, before.x, e))));
    }
    return largest;
}

}  // namespace

TEST_CASE("layers at a wall keep their spacing and all elements their sizes, of all cells, unless a key frees them") {
    for (const Mesh& regular : {square_mesh(10), quad_mesh(10), cube_mesh(5), solid_mesh(5, "hhhhh"), solid_mesh(5, "ppppp")}) {
        CAPTURE(regular.elements_text());
        Mesh mesh = shaken(layered(regular));
        if (mesh.dim == 2) {  // a boundary of which the layers are but a part
            mesh.boundaries = {"all around"};
            mesh.face_boundary.assign(mesh.face_count(), 0);
        }
        REQUIRE(certify(mesh, mesh.x).valid);
        const TemporaryFolder folder;
        const std::string file = folder.write("layers.msh", msh_of(mesh)), results = folder.path("results");
        const auto improved = [&](std::vector<std::string> settings) {
            settings.insert(settings.begin(), {"improve", file, "output=" + results, "threads=1"});
            const Outcome outcome = almesh_with(settings);
            CHECK(outcome.code == 0);
            CHECK(has(outcome.out, " (kept within ") != (settings.back() == "size_change=0"));
            const Mesh after = mesh_of(results + "/final.msh");
            CHECK(least_corner_jacobian(after, after.x) >= least_corner_jacobian(mesh, mesh.x));
            return changes(mesh, after);
        };
        const auto [wall, size] = improved({});
        CHECK(wall <= std::log(1.2) * (1 + 1e-6));
        CHECK(size <= std::log(1.2) * (1 + 1e-6));
        CHECK(improved({"size_change=0.02"}).second <= std::log(1.02) * (1 + 1e-6));
        CHECK(improved({"size_change=0"}).second > size);
    }
}

TEST_CASE("nodes of elements that lose what is guarded go back, and all others are taken") {
    const Mesh mesh = square_mesh(6);
    const TemporaryFolder folder;
    const std::string file = folder.write("mesh.msh", msh_of(mesh));
    const ProblemSetup setup = parse_deck("ideal = regular\nboundary all = fixed\nmesh = " + file, "test", {});
    for (const Guard which : {Guard::automatic, Guard::certified_bound}) {
        Problem problem = make_problem(setup, {mesh, true});
        ProblemOptions options = setup;
        options.guard = which;
        const std::vector<double>& x = problem.mesh().x;
        const ImprovementGuard guard(options, problem, x);
        std::vector<double> inside;
        for (int i = 0; i < mesh.nodes(); ++i)
            if (point(mesh.x, i, 2)[0] > 0.3 && point(mesh.x, i, 2)[0] < 0.7 && point(mesh.x, i, 2)[1] > 0.3 &&
                point(mesh.x, i, 2)[1] < 0.7) inside.push_back(i);
        std::vector<double> to = x;
        const int bad = static_cast<int>(inside.front()), good = static_cast<int>(inside.back());
        const double edge = std::abs(x[2] - x[0]);
        to[2 * bad] += 3 * edge;  // inverts elements
        to[2 * good] += 1e-3 * edge;
        to[2 * good + 1] -= 1e-3 * edge;
        std::vector<double> taken = to;
        const bool is_any = guard.take(x, taken, nullptr);
        CHECK(taken[2 * bad] == x[2 * bad]);
        CHECK(is_any == (taken != x));
        if (which == Guard::certified_bound) CHECK(taken[2 * good] == to[2 * good]);  // of triangles always 1
        std::vector<double> none = x;
        CHECK(!guard.take(x, none, nullptr));
    }
}
