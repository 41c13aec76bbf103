#include "constraint/target.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "base/error.hpp"
#include "mesh/lagrange.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::string error_of(const Mesh& mesh, const std::map<std::string, std::string>& motions) {
    try {
        target_of(mesh, motions);
    } catch (const Error& error) {
        return (error.exit_code == ExitCode::input ? "input: " : "usage: ") + std::string(error.what());
    }
    return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// body(position in the mesh file, target) for every node and every quadrature point of the boundary's faces.
template <class Body>
void for_points(const Mesh& mesh, const BoundaryTarget& target, const std::string& boundary, const Body& body) {
    const int dim = mesh.dim, m = mesh.face_nodes(0), points = target.rules[0].quadrature.count;
    const LagrangeBasis basis(dim - 1, mesh.degree);
    std::vector<double> N(m);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (mesh.boundaries[mesh.face_boundary[f]] != boundary) continue;
        for (int i = 0; i < m; ++i) body(&mesh.x[mesh.face(f)[i] * dim], &target.node[(f * m + i) * dim]);
        for (int q = 0; q < points; ++q) {
            basis.values(&target.rules[0].quadrature.xi[q * (dim - 1)], N.data());
            double x[3] = {};
            for (int i = 0; i < m; ++i)
                for (int a = 0; a < dim; ++a) x[a] += N[i] * mesh.x[mesh.face(f)[i] * dim + a];
            body(x, &target.sample[(f * points + q) * dim]);
        }
    }
}

// A ring of degree 2 as a curved file has it: every node at its polar position.
Mesh curved_ring() {
    Mesh mesh = raise_degree(ring_mesh(8, 2, 3), 2);
    for (int f = 0; f < mesh.face_count(); ++f) {
        double* middle = &mesh.x[mesh.face(f)[2] * 2];
        const double* end = &mesh.x[mesh.face(f)[0] * 2];
        const double stretch = std::hypot(end[0], end[1]) / std::hypot(middle[0], middle[1]);
        middle[0] *= stretch;
        middle[1] *= stretch;
    }
    return mesh;
}

}  // namespace

TEST_CASE("each boundary goes where its own motion takes it, at nodes and quadrature points") {
    for (int degree : {1, 3}) {
        const Mesh mesh = raise_degree(ring_mesh(7, 2, 4), degree);
        const BoundaryTarget target = target_of(mesh, {{"inner", "translate 8 -1"}, {"outer", "circle 0 0 6"}});
        REQUIRE(target.node.size() == mesh.faces.size() * 2);
        REQUIRE(target.sample.size() ==
                static_cast<std::size_t>(mesh.face_count()) * target.rules[0].quadrature.count * 2);
        for_points(mesh, target, "inner", [](const double* x, const double* g) {
            CHECK(std::hypot(g[0] - x[0] - 8, g[1] - x[1] + 1) < 1e-14);
        });
        for_points(mesh, target, "outer", [](const double* x, const double* g) {
            CHECK(std::hypot(g[0], g[1]) == doctest::Approx(6).epsilon(1e-14));
            CHECK(std::abs(x[0] * g[1] - x[1] * g[0]) < 1e-13);  // on the same ray
            CHECK(x[0] * g[0] + x[1] * g[1] > 0);
        });
    }
    const Mesh cube = raise_degree(cube_mesh(2), 2);
    const std::string turn = "rotate 90 axis 0 0 1; translate 0 0 1";
    const BoundaryTarget target = target_of(cube, {{"top", turn}, {"bottom", turn}, {"sides", turn}});
    for_points(cube, target, "sides", [](const double* x, const double* g) {
        CHECK(std::hypot(g[0] + x[1], g[1] - x[0], g[2] - x[2] - 1) < 1e-14);
    });
}

TEST_CASE("fixed keeps the curved boundary of the file, which the ideal mesh has lost") {
    const Mesh mesh = curved_ring();
    const BoundaryTarget target = target_of(mesh, {});
    const std::vector<double> ideal = straight_sided(mesh);
    double bulge = 0;
    for (std::size_t k = 0; k < mesh.faces.size(); ++k)
        for (int a = 0; a < 2; ++a) {
            CHECK(target.node[2 * k + a] == mesh.x[2 * mesh.faces[k] + a]);
            bulge = std::max(bulge, std::abs(target.node[2 * k + a] - ideal[2 * mesh.faces[k] + a]));
        }
    CHECK(bulge > 0.1);
    for (const char* boundary : {"inner", "outer"})
        for_points(mesh, target, boundary,
                   [](const double* x, const double* g) { CHECK(std::hypot(x[0] - g[0], x[1] - g[1]) < 1e-15); });
}

TEST_CASE("motions act on the boundary as the file has it") {
    const Mesh mesh = curved_ring();
    for_points(mesh, target_of(mesh, {{"inner", "scale 2"}}), "inner",
               [](const double* x, const double* g) { CHECK(std::hypot(g[0] - 2 * x[0], g[1] - 2 * x[1]) < 1e-15); });
}

TEST_CASE("the target is in the trace space, and takes few quadrature points, unless a boundary is projected") {
    const Mesh mesh = curved_ring();
    const BoundaryTarget affine = target_of(mesh, {{"inner", "rotate 30; translate 8 0"}});
    const BoundaryTarget projected = target_of(mesh, {{"outer", "circle 0 0 6"}});
    CHECK(affine.in_trace_space);
    CHECK(!projected.in_trace_space);
    CHECK(affine.rules[0].quadrature.count == mesh.degree + 1);
    CHECK(projected.rules[0].quadrature.count == mesh.degree + 6);
}

TEST_CASE("a node of boundaries that disagree goes with the first of them, or to their mean, and the faces go along") {
    for (const int degree : {1, 2, 3}) {
        const Mesh mesh = raise_degree(square_mesh(2), degree);
        std::vector<Motion> motion;
        SharedNodes shared;
        for (const std::string& name : mesh.boundaries) {  // left and bottom have the origin
            motion.push_back(parse_motion(name == "left" ? "translate -0.25 0" : "fixed"));
            shared.rank.push_back(name == "left" ? 0 : name == "top" ? 2 : 1);
        }
        for (const auto& [rule, shift] : {std::pair(SharedNodes::first, -0.25), std::pair(SharedNodes::mean, -0.125)}) {
            shared.rule = rule;
            const BoundaryTarget target = make_target(mesh, mesh.x, motion, {}, shared);
            for_points(mesh, target, "left", [&, by = shift](const double* x, const double* g) {
                const bool at_corner_face = std::min(x[1], 1 - x[1]) < 0.5;
                const double share = at_corner_face ? 1 - std::min(x[1], 1 - x[1]) / 0.5 : 0;
                CHECK(std::hypot(g[0] + 0.25 - share * (0.25 + by), g[1] - x[1]) < 1e-14);
            });
            for_points(mesh, target, "bottom", [&, by = shift](const double* x, const double* g) {
                CHECK(std::hypot(g[0] - x[0] - std::max(0.0, 1 - x[0] / 0.5) * by, g[1]) < 1e-14);
            });
        }
    }
}

TEST_CASE("two boundaries that send a shared node to different places are refused by id and name") {
    const Mesh mesh = square_mesh(2);
    const std::string message = error_of(mesh, {{"left", "translate 0 0.5"}});
    CHECK(has(message, "input: "));
    CHECK(has(message, "node 1 lies on two boundaries whose motions disagree: "));
    CHECK(has(message, "bottom takes it to (0, 0)"));
    CHECK(has(message, "left to (0, 0.5)"));
    const std::string all = "translate 3 0.5";
    CHECK(error_of(mesh, {{"left", all}, {"right", all}, {"bottom", all}, {"top", all}}) == "");
    // A wall and its symmetry planes: the corner nodes stay where both motions leave them.
    CHECK(error_of(mesh, {{"left", "scale 1 2"}, {"top", "translate 0 1"}, {"right", "scale 1 2"}}) == "");
}

TEST_CASE("motions that disagree are refused wherever the mesh lies and however small its elements are") {
    Mesh far = square_mesh(4);
    for (double& v : far.x) v += 1e6;
    CHECK(has(error_of(far, {{"left", "translate 0.5 0.5"}}), "motions disagree"));  // by two elements
    CHECK(error_of(far, {{"left", "scale 1"}}) == "");
    Mesh thin = square_mesh(4);
    for (int i = 0; i < thin.nodes(); ++i) thin.x[2 * i + 1] *= 1e-6;
    CHECK(has(error_of(thin, {{"left", "translate 0 5e-7"}}), "motions disagree"));  // by two elements
}

TEST_CASE("a projection that is undefined at a node names boundary and point") {
    CHECK(has(error_of(ring_mesh(8, 2, 3), {{"inner", "circle 1 0 1"}}),
              "input: boundary inner: the closest point to (1, 0)"));
    CHECK(has(error_of(cube_mesh(1), {{"top", "sphere 1 1 1 2"}}), "input: boundary top"));
}

TEST_CASE("a target that is not finite is refused") {
    const std::string message = error_of(ring_mesh(8, 2, 3), {{"outer", "translate 1e308 0; translate 1e308 0"}});
    CHECK(has(message, "input: boundary outer"));
    CHECK(has(message, "not finite"));
}

TEST_CASE("motions of the wrong dimension are refused") {
    CHECK(has(error_of(ring_mesh(8, 2, 3), {{"inner", "translate 8 0 0"}}), "usage: "));
    CHECK(has(error_of(cube_mesh(1), {{"top", "circle 0 0 1"}}), "usage: "));
}
