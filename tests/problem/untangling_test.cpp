// Untangling alone: few nodes move, and layers keep their thickness.
#include "problem/untangling.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.hpp"
#include "check/certificate.hpp"
#include "deck/make_problem.hpp"
#include "problem/base_mesh.hpp"
#include "problem/improve.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr int k = 6;  // cells in each direction
using Place = std::array<double, 3>;  // in cells: the last coordinate of the space is across the layer

// The layers of a boundary layer from a mesh of the unit square or cube: flat, or around a cylinder.
struct LayerMesh {
    Mesh mesh;
    bool is_bent;

    LayerMesh(const Mesh& of, bool bent) : mesh(of), is_bent(bent) {
        for (int i = 0; i < mesh.nodes(); ++i) {
            Place at{};
            for (int a = 0; a < mesh.dim; ++a) at[a] = k * point(of.x, i, mesh.dim)[a];
            move(i, at);
        }
    }
    void move(int i, const Place& to) {
        const double height = 1e-4 * (std::pow(2, to[mesh.dim - 1]) - 1), along = to[0] / k;
        double* const x = point(mesh.x, i, mesh.dim);
        if (mesh.dim == 3) x[1] = to[1] / k;
        x[0] = is_bent ? (1 + height) * std::sin(along) : along;
        x[mesh.dim - 1] = is_bent ? (1 + height) * std::cos(along) : height;
    }
};

int node_at(const Mesh& unit, const Place& at) {
    for (int i = 0; i < unit.nodes(); ++i) {
        double distance = 0;
        for (int a = 0; a < unit.dim; ++a) distance += std::abs(k * point(unit.x, i, unit.dim)[a] - at[a]);
        if (distance < 1e-9) return i;
    }
    FAIL("no such node");
    return 0;
}

struct Push {
    double along, up, by_along, by_up;  // in cells: from where, and how far
};

struct Result {
    int moved = 0;
    double thickness = 1;  // the largest change of an edge across the layer, as a factor
};

Result untangled(const Mesh& unit, bool is_bent, const std::vector<Push>& pushes, const std::string& boundary) {
    LayerMesh layer(unit, is_bent);
    const std::vector<double> before = layer.mesh.x;
    for (const Push& push : pushes) {
        Place at{push.along, 3, 3};
        at[unit.dim - 1] = push.up;
        const int i = node_at(unit, at);
        at[0] += push.by_along;
        at[unit.dim - 1] += push.by_up;
        layer.move(i, at);
    }
    set_threads(1);
    const Deck deck = parse_deck("mesh = none.msh\nideal = regular\nboundary all = " + boundary + "\n", "a.deck");
    Problem problem = make_problem(deck, {layer.mesh, true});
    set_regular_elements(problem);
    set_functional(deck, problem);
    const std::vector<int> invalid = certify(problem.mesh(), problem.mesh().x).uncertified;
    CHECK(!invalid.empty());
    std::vector<double> x = problem.mesh().x;
    CHECK(untangle(deck, problem, invalid, x).left.empty());
    CHECK(certify(problem.mesh(), x).valid);
    Result result;
    for (int i = 0; i < unit.nodes(); ++i)
        result.moved += !std::equal(point(x, i, unit.dim), point(x, i, unit.dim) + unit.dim,
                                    point(problem.mesh().x, i, unit.dim));
    x = problem.frame.to_file(x, unit.dim);
    const auto length = [&](const std::vector<double>& of, int i, int j) {
        double sum = 0;
        for (int a = 0; a < unit.dim; ++a)
            sum += std::pow(point(of, i, unit.dim)[a] - point(of, j, unit.dim)[a], 2);
        return std::sqrt(sum);
    };
    for (int e = 0; e < unit.element_count(); ++e)
        for (const auto [v, w] : unit.cell(e).edges) {
            const int i = unit.element(e)[v], j = unit.element(e)[w];
            if (length(before, i, j) > 0.4 / k) continue;
            const double factor = length(x, i, j) / length(before, i, j);
            result.thickness = std::max({result.thickness, factor, 1 / factor});
        }
    return result;
}

std::vector<Mesh> meshes() {
    return {square_mesh(k), quad_mesh(k), mixed_mesh(k), cube_mesh(k), solid_mesh(k, "hhhhhh"),
            solid_mesh(k, "pppppp")};
}

}  // namespace

TEST_CASE("a node that has been pushed through its neighbours goes back alone, and layers keep their thickness") {
    for (const Mesh& mesh : meshes())
        for (const bool is_bent : {false, true})
            for (const Push push : {Push{3, 1, 0, 1.3}, Push{3, 2, 0, 1.3}, Push{3, 1, 0, 3.3}}) {
                if (mesh.dim == 3 && is_bent != (push.by_up > 2)) continue;
                CAPTURE(mesh.elements_text());
                CAPTURE(is_bent);
                CAPTURE(push.up);
                CAPTURE(push.by_up);
                const Result result = untangled(mesh, is_bent, {push}, "fixed");
                CHECK(result.moved == 1);
                CHECK(result.thickness < 1.2);
            }
}

TEST_CASE("so do two nodes, and one of the wall that has been pushed along it") {
    for (const Mesh& mesh : meshes()) {
        CAPTURE(mesh.elements_text());
        const Result two = untangled(mesh, false, {{2, 2, 0, 1.3}, {3, 3, 0, 1.3}}, "fixed");
        CHECK(two.moved == 2);
        CHECK(two.thickness < 1.2);
        if (mesh.groups.size() > 1) continue;
        const Result wall = untangled(mesh, false, {{3, 0, 1.2, 0}}, "slide");
        CHECK(wall.moved == 1);
        CHECK(wall.thickness < 1.2);
    }
}
