#include "method/derivative.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/error.hpp"
#include "linalg/vector_ops.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A mesh whose boundary `moved` has gone by (1 + a) times `way`, at its minimum.
struct Moved {
    Minimisation problem;
    std::vector<double> x;
    std::unique_ptr<Derivative> derivative;
    std::string why;

    Moved(const Mesh& mesh, const std::string& moved, const Vec<3>& way, double a, Objective objective,
          const PowerParams& power = {}, const LinearSolverParams& linear = {})
        : problem(mesh, {{moved, translation(mesh.dim, way, a)}}, objective) {
        REQUIRE(problem.solve({}, x).status == Status::converged);
        REQUIRE(snap_to_targets(problem.distortion, problem.constraint, x) == 0);
        if (power.p != 2) problem.distortion.set_power(power);
        why = why_not(problem, x, linear, &derivative);
    }

    static std::string why_not(const Minimisation& problem, std::vector<double>& x, const LinearSolverParams& linear,
                               std::unique_ptr<Derivative>* derivative = nullptr) {
        try {
            auto made = std::make_unique<Derivative>(problem.mesh, problem.distortion, problem.constraint, linear);
            made->polish(x);
            if (derivative) *derivative = std::move(made);
        } catch (const Error& error) {
            CHECK(error.exit_code == ExitCode::not_converged);
            return error.what();
        }
        return "";
    }

    static std::string translation(int dim, const Vec<3>& way, double a) {
        std::string text = "translate";
        for (int k = 0; k < dim; ++k) text += concat(" ", (1 + a) * way[k]);
        return text;
    }
};

BoundaryChange shift_of(const Mesh& mesh, const std::string& boundary, const Vec<3>& way) {
    BoundaryChange change{std::vector<double>(mesh.x.size(), 0.0), std::vector<double>(mesh.x.size(), 0.0)};
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (mesh.boundaries[mesh.face_boundary[f]] != boundary) return;
        for (int a = 0; a < mesh.dim; ++a) change.shift[offset(mesh.faces[k], mesh.dim, a)] = way[a];
    });
    return change;
}

std::vector<double> some_numbers(std::size_t count) {
    std::vector<double> numbers(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = std::sin(1.0 + 7.3 * static_cast<double>(i));
    return numbers;
}

// Of the tangent from differences of minimisations of the fourth order, relative to its largest entry.
double error_of_tangent(const Mesh& mesh, const std::string& moved, const Vec<3>& way, Objective objective,
                        const PowerParams& power = {}) {
    constexpr double h = 2e-3;
    Moved here(mesh, moved, way, 0, objective, power);
    REQUIRE(here.why == "");
    std::vector<double> error = here.derivative->tangent(shift_of(mesh, moved, way));
    const double size = norm_inf(error);
    REQUIRE(size >= std::abs(way[0]));
    for (const double k : {-2, -1, 1, 2}) {
        const Moved there(mesh, moved, way, k * h, objective, power);
        REQUIRE(there.why == "");
        axpy((k == -2 ? -1 : k == -1 ? 8 : k == 1 ? -8 : 1) / (12 * h), there.x, error);
    }
    return norm_inf(error) / size;
}

// The mesh and an element outside, on face 0, with a node of its own: fixed, and beside no element that is distorted.
Mesh with_ear(const Mesh& mesh) {
    const int dim = mesh.dim;
    std::vector<double> x = mesh.x, centre(3, 0.0);
    std::vector<int> elements = mesh.elements;
    for (int k = 0; k < dim; ++k) {
        elements.push_back(mesh.faces[k]);
        for (int a = 0; a < dim; ++a) centre[a] += mesh.x[offset(mesh.faces[k], dim, a)] / dim;
    }
    elements.push_back(mesh.nodes());
    for (int a = 0; a < dim; ++a) x.push_back(1.2 * centre[a]);
    return linear_mesh(dim, x, elements, [dim](const double* at) {
        return std::hypot(at[0], at[1], dim == 3 ? at[2] : 0) < 1.1 ? "inner" : "outer";
    });
}

}  // namespace

TEST_CASE("the tangent is the derivative of minimisations") {
    for (const Objective objective : {Objective::squared, Objective::deviation, Objective::size_shape})
        for (const int degree : {1, 2, 3, 4}) {
            CAPTURE(degree);
            const Mesh ring = raise_degree(ring_mesh(8, 2, 4), degree);
            CHECK(error_of_tangent(ring, "inner", {0.6, 0.2, 0}, objective) < 1e-9);
        }
}

TEST_CASE("the tangent of a power is that of its functional, whose kappa depends on the boundary") {
    for (const int degree : {1, 2, 3})
        for (const int p : {3, 4, 8}) {
            if (degree > 1 && p > 4) continue;  // too far from where minimisations of the deviation end
            CAPTURE(degree);
            CAPTURE(p);
            const Mesh ring = raise_degree(ring_mesh(8, 2, 4), degree);
            const PowerParams power{p, 0.3, 0.1};
            CHECK(error_of_tangent(ring, "inner", {0.6, 0.2, 0}, Objective::deviation, power) < 1e-9);
        }
}

TEST_CASE("a fixed node among elements that are not distorted is no obstacle") {
    const Mesh ear = with_ear(ring_mesh(12, 3, 4));
    CHECK(error_of_tangent(ear, "inner", {0.3, 0.1, 0}, Objective::deviation) < 1e-9);
}

TEST_CASE("adjoint and tangent agree, whatever the solver") {
    for (const SolverKind kind : {SolverKind::automatic, SolverKind::cg}) {
        const Mesh ring = raise_degree(ring_mesh(12, 3, 4), 2);
        Moved here(ring, "inner", {0.6, 0.2, 0}, 0, Objective::squared, {}, {.kind = kind});
        REQUIRE(here.why == "");
        for (const std::string boundary : {"inner", "outer"}) {
            BoundaryChange change = shift_of(ring, boundary, {0.3, -1, 0});
            for (std::size_t i = 0; i < change.shift.size(); ++i) change.shift[i] *= std::cos(static_cast<double>(i));
            const std::vector<double> dJ_dx = some_numbers(ring.x.size());
            const double tangent = dot(dJ_dx, here.derivative->tangent(change));
            const double adjoint = dot(here.derivative->adjoint(dJ_dx).shift, change.shift);
            CHECK(std::abs(tangent - adjoint) < 1e-12 * norm_2(dJ_dx) * norm_2(change.shift));
            CHECK(std::abs(tangent) > 0.01);
        }
    }
}

TEST_CASE("a motion of all boundaries takes the nodes inside along") {
    const Mesh ring = ring_mesh(12, 3, 4);
    Moved here(ring, "inner", {0.6, 0.2, 0}, 0, Objective::squared);
    BoundaryChange all = shift_of(ring, "inner", {0.3, -1, 0});
    axpy(1, shift_of(ring, "outer", {0.3, -1, 0}).shift, all.shift);
    const std::vector<double> dx = here.derivative->tangent(all);
    for (int i = 0; i < ring.nodes(); ++i) {
        CHECK(dx[2 * i] == doctest::Approx(0.3).epsilon(1e-11));
        CHECK(dx[2 * i + 1] == doctest::Approx(-1).epsilon(1e-11));
    }
}

TEST_CASE("what has no derivative says why") {
    // At the identity (eta - 1)^2 is flat.
    for (const Objective objective : {Objective::deviation, Objective::size_shape}) {
        const std::string why = Moved(ring_mesh(12, 3, 4), "inner", {}, 0, objective).why;
        CHECK(why.starts_with("no derivative: eta - 1 is at most 1e-10 everywhere"));
        CHECK(why.find("with objective = squared the mesh has a derivative") != std::string::npos);
        CHECK(Moved(ring_mesh(12, 3, 4), "inner", {1e-6, 0, 0}, 0, objective).why.find("try objective = squared") !=
              std::string::npos);
    }
    CHECK(Moved(ring_mesh(12, 3, 4), "inner", {}, 0, Objective::squared).why == "");
    // Where nothing has been minimised yet that is made up for, but where the target inverts elements.
    for (const auto& [way, reason] : {std::pair(2.5, "of the boundary cannot be set to the target"),
                                      std::pair(0.55, "")}) {
        const Minimisation problem(ring_mesh(12, 3, 4), {{"inner", Moved::translation(2, {way, 0, 0}, 0)}},
                                   Objective::squared);
        std::vector<double> x = problem.ideal;
        const std::string why = Moved::why_not(problem, x, {});
        CAPTURE(why);
        CHECK(why.empty() == (way < 1));
        CHECK(why.find(reason) != std::string::npos);
    }
}
