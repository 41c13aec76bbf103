// How Algorithm 1 ends: where the constraint stands still, where a target is out of reach, where a limit is met.
#include "method/augmented_lagrangian.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "check/certificate.hpp"
#include "linalg/vector_ops.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Minimisation moved_ring() {
    return {ring_mesh(16, 5, 8), {{"inner", "rotate 20; translate 3 1"}}, Objective::squared};
}

AugmentedLagrangianParams with(Algorithm algorithm) {
    AugmentedLagrangianParams params;
    params.algorithm = algorithm;
    return params;
}

// mu grows tenfold from mu0 on, without multipliers.
AugmentedLagrangianParams penalty_from(double mu0) {
    AugmentedLagrangianParams params;
    params.moving = MovingMethod::penalty;
    params.mu0 = mu0;
    return params;
}

// What each subproblem leaves of the constraint's norm before it.
std::vector<double> parts_left(const std::vector<AlIteration>& rows) {
    std::vector<double> parts;
    for (std::size_t k = 1; k < rows.size(); ++k)
        parts.push_back(rows[k].projected_constraint_norm / rows[k - 1].projected_constraint_norm);
    return parts;
}

}  // namespace

TEST_CASE("a target that no valid mesh reaches: the run stalls, and the mesh stays valid") {
    for (Algorithm algorithm : {Algorithm::adaptive, Algorithm::paper})
        for (Objective objective : objectives) {
            const Minimisation problem(ring_mesh(12, 3, 5), {{"inner", "translate 40 0"}}, objective);
            std::vector<double> x;
            const AlResult result = problem.solve(with(algorithm), x);
            CAPTURE(static_cast<int>(algorithm));
            CAPTURE(static_cast<int>(objective));
            CAPTURE(result.newton_iterations);
            CHECK(result.status == Status::stalled);
            CHECK(certify(problem.mesh, x).valid);
            CHECK(problem.constraint.projected_norm(x) > 1);
            if (algorithm == Algorithm::adaptive) CHECK(result.newton_iterations < 50);
        }
}

TEST_CASE("a first penalty that is far too weak is no sign that a target is out of reach") {
    for (Objective objective : objectives)
        for (double mu0 : {1e-2, 1e-4, 1e-6}) {
            const Minimisation problem(ring_mesh(12, 3, 6), {{"inner", "translate 2 0"}}, objective);
            AugmentedLagrangianParams params = with(Algorithm::paper);
            params.mu0 = mu0;
            std::vector<double> x;
            const AlResult result = problem.solve(params, x);
            CAPTURE(static_cast<int>(objective));
            CAPTURE(mu0);
            CHECK(std::string(to_string(result.status)) == "converged");
        }
}

TEST_CASE("what straight faces can never lose to a wavy target is no sign that it is out of reach") {
    const std::string wave = "(1 + 0.2*cos(12*atan2(y, x)))\"";
    const Minimisation problem(ring_mesh(12, 3, 6), {{"outer", "expression \"x*" + wave + " \"y*" + wave}},
                               Objective::deviation);
    const double lost = problem.constraint.best_approximation_error() * problem.constraint.norm_of_one();
    CHECK(0.5 * 1e5 * lost * lost > 10 * problem.distortion.uniform(20));  // of the first penalty
    std::vector<double> x;
    const AlResult result = problem.solve({}, x);
    CHECK(result.status == Status::converged);
    CHECK(certify(problem.mesh, x).valid);
}

TEST_CASE("limits of iterations end the run with their status") {
    const Minimisation problem = moved_ring();
    std::vector<double> x;
    AugmentedLagrangianParams params;
    params.max_iterations = 2;
    const AlResult outer = problem.solve(params, x);
    CHECK(outer.status == Status::max_al_iterations);
    CHECK(outer.iterations.size() == 3);
    CHECK(norm_2(outer.gradient) == doctest::Approx(outer.iterations.back().gradient_norm).epsilon(1e-6));
    CHECK(certify(problem.mesh, x).valid);
    params = {};
    params.max_newton_iterations = 1;
    const AlResult inner = problem.solve(params, x);
    CHECK(inner.status == Status::max_newton_iterations);
    CHECK(inner.iterations.back().newton_status == Status::max_newton_iterations);
    CHECK(inner.newton_iterations == 1);
    CHECK(norm_2(inner.gradient) == doctest::Approx(inner.iterations.back().gradient_norm).epsilon(1e-6));
    CHECK(certify(problem.mesh, x).valid);
}

TEST_CASE("a linear solver that cannot solve ends the run with its status") {
    const Minimisation problem = moved_ring();
    LinearSolverParams linear;
    linear.kind = SolverKind::cholesky;
    linear.memory_limit = 1;
    std::vector<double> x;
    const AlResult result = problem.solve({}, x, {}, linear);
    CHECK(result.status == Status::linear_solver_failed);
    CHECK(result.iterations.back().newton_status == Status::linear_solver_failed);
    CHECK(x == problem.ideal);
}

TEST_CASE("a gradient tolerance below rounding is said to be so, and the run converges") {
    const Minimisation problem = moved_ring();
    AugmentedLagrangianParams params;
    params.omega_star = 1e-30;
    std::vector<double> x;
    const AlResult result = problem.solve(params, x);
    CHECK(result.status == Status::converged);
    CHECK(result.iterations.back().newton_status == Status::attainable_accuracy);
    CHECK(problem.constraint.projected_norm(x) <= 1e-8);
    CHECK(result.gradient.empty());
}

TEST_CASE("as printed, no target counts as out of reach in the first subproblem") {
    const Minimisation problem(ring_mesh(12, 3, 5), {{"inner", "translate 40 0"}}, Objective::squared);
    AugmentedLagrangianParams params = with(Algorithm::paper);
    params.max_iterations = 1;
    params.mu0 = 1e5;
    std::vector<double> x;
    CHECK(problem.solve(params, x).iterations.back().newton_status == Status::stalled);
    params.algorithm = Algorithm::literal;
    params.mu0 = std::sqrt(1e5) / problem.constraint.norm_of_one();  // the same weight, mu^2
    CHECK(problem.solve(params, x).iterations.back().newton_status != Status::stalled);
}

TEST_CASE("as printed, the loop ends as soon as one test holds") {
    const Minimisation problem = moved_ring();
    AugmentedLagrangianParams params = with(Algorithm::literal);
    params.mu0 = 1;
    params.omega0 = params.omega_star;
    std::vector<double> x;
    const AlResult result = problem.solve(params, x);
    CHECK(norm_2(result.gradient) == doctest::Approx(result.iterations.back().gradient_norm).epsilon(1e-6));
    CHECK(result.status == Status::ended_as_printed);
    CHECK(result.iterations.size() == 2);
    CHECK(problem.constraint.projected_norm(x) > 1e3 * std::sqrt(params.epsilon_star));
    std::vector<double> y;
    params.algorithm = Algorithm::paper;
    CHECK(problem.solve(params, y).status == Status::converged);
    CHECK(problem.constraint.projected_norm(y) <= std::sqrt(params.epsilon_star));
}

// A square squeezed to nothing has the energy 1 / 4 s^2 at the height s, and mu s^2 / 2 keeps it open: s ~ mu^(-1/4).
TEST_CASE("a constraint that goes on falling, if slowly, does not stall") {
    const std::string flat = "scale 1 1e-9";
    const Minimisation problem(square_mesh(2), {{"top", flat}, {"bottom", flat}, {"left", flat}, {"right", flat}},
                               Objective::squared);
    AugmentedLagrangianParams params = penalty_from(1000);
    params.max_iterations = 6;
    std::vector<double> x;
    const AlResult result = problem.solve(params, x);
    CHECK(result.status == Status::max_al_iterations);
    const std::vector<double> left = parts_left(result.iterations);
    REQUIRE(left.size() == 6);
    for (std::size_t k = 2; k < left.size(); ++k) CHECK(left[k] == doctest::Approx(std::pow(10, -0.25)).epsilon(0.01));
}

TEST_CASE("the constraint stalls where three penalties in a row leave nine tenths of it") {
    const Minimisation problem(ring_mesh(12, 3, 5), {{"inner", "translate 40 0"}}, Objective::squared);
    std::vector<double> x;
    const AlResult result = problem.solve(penalty_from(1), x);
    CHECK(result.status == Status::stalled);
    const std::vector<double> left = parts_left(result.iterations);
    REQUIRE(left.size() >= 5);
    CHECK(std::all_of(left.end() - 3, left.end(), [](double part) { return part > 0.9; }));
    CHECK(std::all_of(left.begin(), left.end() - 3, [](double part) { return part < 0.9; }));
}

TEST_CASE("a constraint that stands still under weak penalties does not stall") {
    const Minimisation problem(ring_mesh(12, 3, 6), {{"inner", "translate 2 0"}}, Objective::squared);
    std::vector<double> x;
    const AlResult result = problem.solve(penalty_from(1e-6), x);
    CHECK(result.status == Status::converged);
    const std::vector<double> left = parts_left(result.iterations);
    CHECK(std::count_if(left.begin(), left.end(), [](double part) { return part > 0.9; }) >= 4);
}

// What the penalty alone costs tells nothing where it is weak, and everything where it is strong.
TEST_CASE("a target counts as out of reach where the penalty costs more than a distortion of 20 everywhere") {
    const Minimisation problem(ring_mesh(12, 3, 5), {{"inner", "translate 400 0"}}, Objective::deviation);
    const auto first_subproblem = [&problem](double mu0, std::vector<double>& x) {
        AugmentedLagrangianParams params = with(Algorithm::paper);
        params.mu0 = mu0;
        params.max_iterations = 1;
        return problem.solve(params, x);
    };
    std::vector<double> x;
    const AlResult weak = first_subproblem(2e-4, x);
    CHECK(problem.distortion.energy(x) < 0.1 * weak.iterations.back().energy);
    CHECK(weak.iterations.back().energy > problem.distortion.uniform(2));
    CHECK(weak.status == Status::max_al_iterations);
    const AlResult strong = first_subproblem(10, x);
    CHECK(problem.distortion.energy(x) < 0.1 * strong.iterations.back().energy);
    CHECK(strong.iterations.back().energy < problem.distortion.uniform(100));
    CHECK(strong.status == Status::stalled);
}

TEST_CASE("no node is farther from its place than wall_tolerance, whatever the norm of the constraint may be") {
    const Minimisation problem = moved_ring();
    AugmentedLagrangianParams params;
    params.epsilon_star = 1;
    params.wall_tolerance = 1e-6;
    std::vector<double> x;
    const AlResult result = problem.solve(params, x);
    CHECK(result.status == Status::converged);
    CHECK(problem.constraint.relative_error(x) <= 1e-6);
    CHECK(result.iterations[1].projected_constraint_norm < 1);
    CHECK(result.iterations[1].relative_boundary_error > 1e-6);
}

TEST_CASE("a rounding floor above omega0 is told as such") {
    const Minimisation problem = moved_ring();
    AugmentedLagrangianParams params;
    params.omega_star = params.omega0 = 1e-30;
    std::vector<double> x;
    CHECK(problem.solve(params, x).status == Status::attainable_accuracy);
}
