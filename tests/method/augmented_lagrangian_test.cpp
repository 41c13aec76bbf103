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

Minimisation moved_ring(Objective objective, TargetKind kind = TargetKind::least_squares, int degree = 1) {
    return {raise_degree(ring_mesh(16, 5, 8), degree), {{"inner", "rotate 20; translate 3 1"}}, objective, kind};
}

AugmentedLagrangianParams with(Algorithm algorithm) {
    AugmentedLagrangianParams params;
    params.algorithm = algorithm;
    return params;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

double norm(const std::vector<double>& v) {
    double squared = 0;
    for (double each : v) squared += each * each;
    return std::sqrt(squared);
}

}  // namespace

TEST_CASE("both schedules reach the same constrained minimum: constraint, stationarity, multipliers") {
    for (Objective objective : objectives) {
        const Minimisation problem = moved_ring(objective);
        std::vector<double> x, y;
        const AlResult adaptive = problem.solve(with(Algorithm::adaptive), x);
        const AlResult paper = problem.solve(with(Algorithm::paper), y);
        for (const auto& [result, at] : {std::pair(&adaptive, &x), std::pair(&paper, &y)}) {
            CHECK(result->status == Status::converged);
            CHECK(problem.constraint.projected_norm(*at) <= 1e-8);
            CHECK(problem.constraint.max_error(*at) <= 1e-6);
            CHECK(result->iterations.back().gradient_norm <= 1e-8);
            CHECK(certify(problem.mesh, *at).valid);
            CHECK(problem.constraint.projected_norm(*at) == result->iterations.back().projected_constraint_norm);
        }
        CHECK(largest_difference(x, y) < 1e-6);
        CHECK(largest_difference(adaptive.lambda, paper.lambda) < 1e-4 * norm(paper.lambda));
        CHECK(norm(adaptive.lambda) > 0);
    }
}

TEST_CASE("at the end the multipliers alone balance the distortion") {
    const Minimisation problem = moved_ring(Objective::squared);
    std::vector<double> x;
    const AlResult result = problem.solve(with(Algorithm::adaptive), x);
    AugmentedFunctional E = problem.functional(0);
    E.lambda = result.lambda;
    std::vector<double> g(x.size()), forces(x.size(), 0.0);
    E.gradient(x, g);
    problem.distortion.add_gradient(x, forces);
    CHECK(norm(g) < 1e-4 * norm(forces));
}

TEST_CASE("lambda is returned after its update, which balances the distortion better than the one before") {
    const Minimisation problem = moved_ring(Objective::squared);
    for (Algorithm algorithm : {Algorithm::adaptive, Algorithm::paper}) {
        AugmentedLagrangianParams params = with(algorithm);
        params.epsilon_star = 1e-4;  // so that the last update is a large one
        params.mu0 = 10;
        std::vector<double> x;
        const AlResult result = problem.solve(params, x);
        REQUIRE(result.status == Status::converged);
        const AlIteration& last = result.iterations.back();
        REQUIRE(last.update == AlUpdate::multipliers);
        AugmentedFunctional E = problem.functional(0);
        std::vector<double> g(x.size());
        E.lambda = result.lambda;
        E.gradient(x, g);
        const double after = norm(g);
        const std::vector<double> c = problem.constraint.constraint_field(x);
        for (std::size_t k = 0; k < c.size(); ++k) E.lambda[k] += last.mu * c[k];
        E.gradient(x, g);
        const double before = norm(g);
        // Without its penalty term E with lambda - mu c has the gradient that Newton's method made small.
        CHECK(after <= 2 * params.omega_star);
        CHECK(after == doctest::Approx(last.gradient_norm).scale(params.omega_star).epsilon(0.1));
        CHECK(after < 1e-3 * before);
    }
}

TEST_CASE("plain and SIMD assembly take the same iterations to the same mesh") {
    const std::map<std::string, std::string> ring = {{"inner", "rotate 20; translate 2 0.5"}},
                                             cube = {{"top", "scale 1 1 1.3"}, {"sides", "scale 1 1 1.3"}};
    for (const Mesh& mesh : {ring_mesh(10, 3, 6), raise_degree(ring_mesh(8, 2, 6), 2), cube_mesh(2)})
        for (const Objective objective : {Objective::squared, Objective::deviation, Objective::size_shape})
            for (const Algorithm algorithm : {Algorithm::adaptive, Algorithm::paper}) {
                AlResult result[2];
                std::vector<double> x[2];
                for (const Assembly assembly : assemblies) {
                    const Minimisation problem(mesh, mesh.dim == 2 ? ring : cube, objective, TargetKind::least_squares,
                                               assembly);
                    const int k = assembly == Assembly::plain;
                    result[k] = problem.solve(with(algorithm), x[k]);
                }
                CAPTURE(mesh.degree);
                CAPTURE(mesh.dim);
                CAPTURE(static_cast<int>(objective));
                CHECK(std::string(to_string(result[0].status)) == "converged");
                CHECK(result[1].status == result[0].status);
                CHECK(result[1].iterations.size() == result[0].iterations.size());
                CHECK(result[1].newton_iterations == result[0].newton_iterations);
                CHECK(result[1].local_steps == result[0].local_steps);
                CHECK(largest_difference(x[0], x[1]) < 1e-9);
                CHECK(result[1].distortion.relative_quality ==
                      doctest::Approx(result[0].distortion.relative_quality).epsilon(1e-9));
            }
}

TEST_CASE("the history tells the run: row 0 the initial mesh, then one row per subproblem") {
    const Minimisation problem = moved_ring(Objective::squared);
    std::vector<double> x;
    std::vector<AlIteration> seen;
    std::vector<int> steps(100, 0);
    AlObserver observer;
    observer.iteration = [&](const AlIteration& row) { seen.push_back(row); };
    observer.newton_step = [&](int k, const NewtonStep&) { ++steps[k]; };
    const AlResult result = problem.solve(with(Algorithm::adaptive), x, observer);
    REQUIRE(seen.size() == result.iterations.size());
    CHECK(seen[0].constraint_norm == problem.constraint.norm(problem.ideal));
    CHECK(seen[0].newton_iterations == 0);
    CHECK(seen[0].relative_quality == doctest::Approx(1).epsilon(1e-12));
    int newton = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
        CHECK(seen[k].iteration == static_cast<int>(k));
        CHECK(seen[k].newton_iterations == steps[k]);
        CHECK(seen[k].update == result.iterations[k].update);
        newton += steps[k];
        if (k > 0) CHECK(seen[k].seconds >= seen[k - 1].seconds);
        if (k > 1 && seen[k - 1].update == AlUpdate::multipliers) CHECK(seen[k].mu == seen[k - 1].mu);
        if (k > 1 && seen[k - 1].update == AlUpdate::both) CHECK(seen[k].mu == doctest::Approx(10 * seen[k - 1].mu));
    }
    CHECK(newton == result.newton_iterations);
    CHECK(seen.back().update == AlUpdate::multipliers);
    CHECK(problem.constraint.norm(x) == seen.back().constraint_norm);
}

TEST_CASE("Algorithm 1 tightens its tolerances and never below the final one") {
    const Minimisation problem = moved_ring(Objective::squared);
    AugmentedLagrangianParams params = with(Algorithm::paper);
    params.mu0 = 3;  // weak, so that both kinds of update occur
    std::vector<double> x;
    const AlResult result = problem.solve(params, x);
    CHECK(result.status == Status::converged);
    int multipliers = 0, penalty = 0;
    for (std::size_t k = 1; k < result.iterations.size(); ++k) {
        const AlIteration& row = result.iterations[k];
        CHECK(row.omega >= params.omega_star);
        CHECK(row.omega <= params.omega0);
        const double c = row.projected_constraint_norm;
        if (row.update == AlUpdate::multipliers) CHECK(c * c <= row.epsilon);
        if (row.update == AlUpdate::penalty) CHECK(c * c > row.epsilon);
        multipliers += row.update == AlUpdate::multipliers;
        penalty += row.update == AlUpdate::penalty;
        if (k + 1 == result.iterations.size()) continue;
        const double growth = result.iterations[k + 1].mu / row.mu;
        CHECK(growth == doctest::Approx(row.update == AlUpdate::penalty ? 100 : 1));
    }
    CHECK(multipliers > 0);
    CHECK(penalty > 0);
}

// Penalty weight mu^2 and update lambda - mu c do not match: the update is 1/mu of what it should be.
TEST_CASE("as printed, the multipliers have next to no effect; read consistently, they have") {
    for (Objective objective : objectives) {
        const Minimisation problem = moved_ring(objective);
        const double one_squared = std::pow(problem.constraint.norm_of_one(), 2);
        AugmentedLagrangianParams printed = with(Algorithm::literal), read = with(Algorithm::paper);
        printed.mu0 = 100 / one_squared;  // weight mu^2 = 1e4
        read.mu0 = 1e4 / one_squared;
        for (AugmentedLagrangianParams* params : {&printed, &read}) {
            params->omega0 = 1e-7;
            params->epsilon0 = 1e6;  // multiplier updates only
            params->omega_star = params->epsilon_star = 1e-30;
            params->max_iterations = 4;
        }
        std::vector<double> x;
        const AlResult literal = problem.solve(printed, x), consistent = problem.solve(read, x);
        REQUIRE(literal.iterations.size() == 5);
        REQUIRE(consistent.iterations.size() >= 4);
        CHECK(literal.iterations[1].constraint_norm ==
              doctest::Approx(consistent.iterations[1].constraint_norm).epsilon(1e-6));
        for (int k = 2; k <= 3; ++k) {
            CHECK(literal.iterations[k - 1].update == AlUpdate::multipliers);
            CHECK(consistent.iterations[k - 1].update == AlUpdate::multipliers);
            CHECK(literal.iterations[k].constraint_norm > 0.95 * literal.iterations[k - 1].constraint_norm);
            CHECK(consistent.iterations[k].constraint_norm < 0.3 * consistent.iterations[k - 1].constraint_norm);
        }
    }
}

TEST_CASE("as printed, omega and epsilon grow with the penalty") {
    const Minimisation problem = moved_ring(Objective::squared);
    AugmentedLagrangianParams params = with(Algorithm::literal);
    params.mu0 = 1e-3;
    params.epsilon0 = 1e-12;  // penalty updates only
    params.max_iterations = 3;
    params.omega_star = 1e-30;
    std::vector<double> x;
    const AlResult result = problem.solve(params, x);
    REQUIRE(result.iterations.size() == 4);
    for (int k : {2, 3}) {
        CHECK(result.iterations[k].mu == doctest::Approx(100 * result.iterations[k - 1].mu));
        CHECK(result.iterations[k].omega == doctest::Approx(100 * result.iterations[k - 1].omega));
        CHECK(result.iterations[k].epsilon > result.iterations[k - 1].epsilon);
    }
}

TEST_CASE("a curved target: P c_D vanishes and c_D ends at the best approximation error; a nodal one vanishes") {
    const std::map<std::string, std::string> onto_circles = {{"inner", "circle 0 0 1"}, {"outer", "circle 0 0 3"}};
    const Mesh mesh = raise_degree(ring_mesh(10, 3, 3), 3);
    for (Objective objective : objectives) {
        const Minimisation exact(mesh, onto_circles, objective),
            nodal(mesh, onto_circles, objective, TargetKind::nodal);
        std::vector<double> x;
        CHECK(exact.solve(with(Algorithm::adaptive), x).status == Status::converged);
        CHECK(exact.constraint.projected_norm(x) <= 1e-8);
        CHECK(exact.constraint.best_approximation_error() > 1e-5);
        CHECK(exact.constraint.norm(x) == doctest::Approx(exact.constraint.best_approximation_error()).epsilon(1e-9));
        CHECK(nodal.solve(with(Algorithm::adaptive), x).status == Status::converged);
        CHECK(nodal.constraint.norm(x) <= 1e-8);
    }
}

TEST_CASE("a cube stretched to twice its height") {
    const std::string stretch = "scale 1 1 2";
    for (Objective objective : objectives) {
        const Minimisation problem(cube_mesh(3), {{"top", stretch}, {"sides", stretch}, {"bottom", stretch}},
                                   objective);
        std::vector<double> x;
        CHECK(problem.solve(with(Algorithm::adaptive), x).status == Status::converged);
        CHECK(problem.constraint.max_error(x) < 1e-6);
        // The affine map is not the minimiser but its distortion bounds the quality from below.
        const double eta = 6 / (3 * std::cbrt(4.0));
        CHECK(problem.distortion.statistics(x).relative_quality >= 0.999 / eta);
        CHECK(certify(problem.mesh, x).valid);
    }
}

TEST_CASE("the adaptive schedule takes no numbers from Algorithm 1") {
    const Minimisation problem = moved_ring(Objective::squared);
    std::vector<double> x, y;
    AugmentedLagrangianParams params = with(Algorithm::adaptive);
    const AlResult result = problem.solve(params, x);
    params.mu0 = 1e-3;
    params.omega0 = 1;
    params.epsilon0 = 1;
    CHECK(problem.solve(params, y).newton_iterations == result.newton_iterations);
    CHECK(x == y);
}

TEST_CASE("nothing moves: one subproblem that takes no step") {
    for (Algorithm algorithm : {Algorithm::adaptive, Algorithm::paper, Algorithm::literal}) {
        const Minimisation problem(ring_mesh(8, 2, 3), {}, Objective::squared);
        std::vector<double> x;
        const AlResult result = problem.solve(with(algorithm), x);
        CHECK(result.status == Status::converged);
        CHECK(result.iterations.size() == 2);
        CHECK(result.newton_iterations == 0);
        CHECK(x == problem.ideal);
    }
}

TEST_CASE("the same bits for any number of threads") {
    const Minimisation problem = moved_ring(Objective::deviation, TargetKind::least_squares, 2);
    const auto results = for_threads([&] {
        std::vector<double> x;
        AugmentedLagrangianParams params;
        params.max_iterations = 2;
        const AlResult result = problem.solve(params, x);
        x.insert(x.end(), result.lambda.begin(), result.lambda.end());
        return x;
    });
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}

TEST_CASE("every update has a name of its own") {
    CHECK(std::string(to_string(AlUpdate::none)) == "-");
    CHECK(std::string(to_string(AlUpdate::multipliers)) == "lambda");
    CHECK(std::string(to_string(AlUpdate::penalty)) == "mu");
    CHECK(std::string(to_string(AlUpdate::both)) == "lambda+mu");
}

// mu0 is in units of |1|^2 = the sum of |f|/h: twice the faces, twice the penalty, the same balance with the
// distortion.
TEST_CASE("the number of boundary faces does not change what a motion costs") {
    for (const Objective objective : objectives) {
        std::vector<int> al, newton;
        for (int around : {24, 48, 96}) {
            const Minimisation problem(ring_mesh(around, around / 4, 8), {{"inner", "translate 3 0"}}, objective);
            std::vector<double> x;
            const AlResult result = problem.solve({}, x);
            CHECK(result.status == Status::converged);
            al.push_back(static_cast<int>(result.iterations.size()) - 1);
            newton.push_back(result.newton_iterations);
        }
        CHECK(*std::max_element(al.begin(), al.end()) - *std::min_element(al.begin(), al.end()) <= 1);
        CHECK(*std::max_element(newton.begin(), newton.end()) - *std::min_element(newton.begin(), newton.end()) <= 1);
    }
}
