#include "method/newton.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "check/certificate.hpp"
#include "linalg/vector_ops.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Run {
    NewtonResult result;
    std::vector<NewtonStep> steps;
    std::vector<double> x;
};

Run run(const Minimisation& problem, const AugmentedFunctional& E, const NewtonParams& params,
        const LinearSolverParams& linear = {}) {
    Run run;
    run.x = problem.ideal;
    Newton newton(problem.distortion.hessian_pattern(), linear);
    run.result = newton.minimise(E, params, run.x, [&](const NewtonStep& step) { run.steps.push_back(step); });
    return run;
}

HessianKind first_of(Objective objective) {
    return objective == Objective::deviation ? HessianKind::damping : HessianKind::projected;
}

Minimisation moved_ring(Objective objective, int degree = 1) {
    return {raise_degree(ring_mesh(16, 5, 8), degree), {{"inner", "rotate 20; translate 3 1"}}, objective};
}

double norm_of_gradient(const AugmentedFunctional& E, const std::vector<double>& x) {
    std::vector<double> g(x.size());
    E.gradient(x, g);
    return norm_2(g);
}

// The constraint and a valley with a kink: |x_0 - place| for the first coordinate of a node. And an energy beside
// which what a short step gains is lost in rounding.
class Kinked : public Dirichlet {
public:
    Kinked(const Minimisation& problem, int node, double by)
        : Dirichlet(problem.mesh, problem.ideal, target_of(problem.mesh, {}), TargetKind::least_squares),
          at_(2 * node),
          place_(problem.ideal[at_] + by) {}

    double value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) override {
        return Dirichlet::value(x, lambda, mu) + 1e-3 * std::abs(x[at_] - place_) + 100;
    }
    void add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                      std::vector<double>& g) override {
        Dirichlet::add_gradient(x, lambda, mu, g);
        g[at_] += x[at_] < place_ ? -1e-3 : 1e-3;
    }

private:
    std::size_t at_;
    double place_;
};

}  // namespace

TEST_CASE("Newton converges to a stationary point, and reports what it did") {
    for (Objective objective : objectives)
        for (int degree : {1, 3}) {
            const Minimisation problem = moved_ring(objective, degree);
            const AugmentedFunctional E = problem.functional(300);
            const Run r = run(problem, E, {.omega = 1e-8, .first = first_of(objective)});
            CHECK(r.result.status == Status::converged);
            CHECK(r.result.gradient_norm <= 1e-8);
            CHECK(r.result.gradient_norm == norm_of_gradient(E, r.x));
            CHECK(r.result.energy == E.energy(r.x));
            REQUIRE(r.steps.size() == static_cast<std::size_t>(r.result.iterations));
            CHECK(r.steps.front().hessian == first_of(objective));
            CHECK(r.steps.back().gradient_norm == r.result.gradient_norm);
            CHECK(r.steps.back().energy == r.result.energy);
            for (std::size_t k = 0; k < r.steps.size(); ++k) {
                CHECK(r.steps[k].iteration == static_cast<int>(k) + 1);
                CHECK((r.steps[k].step_length >= 1) == (r.steps[k].cuts_inverted + r.steps[k].cuts_decrease == 0));
            }
        }
}

TEST_CASE("the end game is quadratic") {
    for (Objective objective : objectives)
        for (int degree : {1, 3}) {
            const Minimisation problem = moved_ring(objective, degree);
            const Run r =
                run(problem, problem.functional(300), {.omega = 1e-9, .first = first_of(objective)});
            // Order of convergence from three gradient norms in a row, full steps all, above rounding.
            double order = 0;
            for (std::size_t k = 2; k < r.steps.size(); ++k) {
                const double a = r.steps[k - 2].gradient_norm, b = r.steps[k - 1].gradient_norm,
                             c = r.steps[k].gradient_norm;
                if (c > 1e-12 && b < 0.1 && r.steps[k].hessian == HessianKind::full)
                    order = std::log(c / b) / std::log(b / a);
            }
            CAPTURE(degree);
            CHECK(order > 1.7);
        }
}

TEST_CASE("energies never increase, and every accepted iterate is a valid mesh") {
    for (Objective objective : objectives) {
        const Minimisation problem{ring_mesh(12, 4, 6), {{"inner", "rotate 40; translate 3.5 0"}}, objective};
        const AugmentedFunctional E = problem.functional(1e4);
        const Run whole = run(problem, E, {.omega = 1e-8, .first = first_of(objective)});
        REQUIRE(whole.result.status == Status::converged);
        double before = E.energy(problem.ideal);
        int inverted = 0;
        for (const NewtonStep& step : whole.steps) {
            CHECK(std::isfinite(step.energy));
            CHECK(step.energy <= before * (1 + 1e-14));
            before = step.energy;
            inverted += step.cuts_inverted;
            const Run part = run(problem, E, {.omega = 1e-8, .max_iterations = step.iteration,
                                              .first = first_of(objective)});
            CHECK(part.result.energy == step.energy);
            CHECK(certify(problem.mesh, part.x).valid);
        }
        CHECK(inverted > 0);  // the line search has met what it is there for
    }
}

TEST_CASE("at a minimum nothing is done") {
    const Minimisation still{ring_mesh(8, 2, 3), {}, Objective::squared};
    const Run r = run(still, still.functional(300), {});
    CHECK(r.result.status == Status::converged);
    CHECK(r.result.iterations == 0);
    CHECK(r.x == still.ideal);
}

TEST_CASE("a rigid motion of the whole boundary is found to rounding, in 2D and 3D") {
    const std::string turn = "rotate 30; translate 5 -2", spin = "rotate 30 axis 1 2 3; translate 1 0 2";
    for (Objective objective : objectives) {
        const Minimisation ring{ring_mesh(12, 3, 4), {{"inner", turn}, {"outer", turn}}, objective};
        const Minimisation cube{cube_mesh(2), {{"top", spin}, {"bottom", spin}, {"sides", spin}}, objective};
        for (const Minimisation* problem : {&ring, &cube}) {
            const Run r =
                run(*problem, problem->functional(300), {.omega = 1e-9, .first = first_of(objective)});
            CHECK(r.result.status == Status::converged);
            CHECK(problem->constraint.max_error(r.x) < 1e-8);
            CHECK(problem->distortion.statistics(r.x).max_distortion < 1 + 1e-8);
        }
    }
}

// At the identity the Hessian of (eta - 1)^2 vanishes: with the penalty alone the matrix is singular inside.
TEST_CASE("the Hessian of eta^2 is what the first step for (eta - 1)^2 takes, or falls back to") {
    const Minimisation problem = moved_ring(Objective::deviation);
    const AugmentedFunctional E = problem.functional(300);
    const Run with = run(problem, E, {.first = HessianKind::damping});
    const Run without = run(problem, E, {.first = HessianKind::projected});
    CHECK(with.result.status == Status::converged);
    CHECK(without.result.status == Status::converged);
    CHECK(without.steps[0].hessian == HessianKind::damping);
    CHECK(with.result.energy == doctest::Approx(without.result.energy).epsilon(1e-9));
}

TEST_CASE("max_iterations ends the iteration, with the last accepted iterate") {
    const Minimisation problem = moved_ring(Objective::squared);
    const AugmentedFunctional E = problem.functional(300);
    const Run r = run(problem, E, {.max_iterations = 2});
    CHECK(r.result.status == Status::max_newton_iterations);
    CHECK(r.result.iterations == 2);
    CHECK(r.steps.size() == 2);
    CHECK(E.energy(r.x) == r.result.energy);
}

TEST_CASE("a tolerance below rounding ends at the rounding floor, for any penalty") {
    for (Objective objective : objectives)
        for (double mu : {1.0, 300.0, 1e6, 1e10, 1e14}) {
            const Minimisation problem = moved_ring(objective);
            const Run r =
                run(problem, problem.functional(mu), {.omega = 1e-30, .first = first_of(objective)});
            CAPTURE(mu);
            CAPTURE(r.result.gradient_norm);
            CAPTURE(std::string(to_string(r.result.status)));
            const bool ended =
                r.result.status == Status::attainable_accuracy || r.result.status == Status::converged;
            CHECK(ended);
            CHECK(r.result.iterations < 60);
            CHECK(r.result.gradient_norm < 1e-10 * std::max(1.0, mu));
        }
}

TEST_CASE("a target out of reach is told from the first minimum, and only there") {
    for (Objective objective : objectives) {
        const Minimisation far{ring_mesh(12, 3, 5), {{"inner", "translate 40 0"}}, objective};
        const AugmentedFunctional E = far.functional(1e5);
        NewtonParams params{.omega = 1e-8, .max_iterations = 50, .first = first_of(objective)};
        CHECK(run(far, E, params).result.status != Status::stalled);  // nobody asked
        params.largest_energy = 400 * far.distortion.domain_volume();
        const Run r = run(far, E, params);
        CHECK(r.result.status == Status::stalled);
        CHECK(r.result.energy > params.largest_energy);
        CHECK(far.distortion.energy(r.x) < 0.1 * r.result.energy);
        CHECK(certify(far.mesh, r.x).valid);
        params.largest_energy = 2 * r.result.energy;
        CHECK(run(far, E, params).result.status != Status::stalled);
    }
    // A weak penalty is most of the energy too, but of an energy that tells nothing.
    const Minimisation near = moved_ring(Objective::squared);
    const Run r =
        run(near, near.functional(1), {.omega = 1e-8, .largest_energy = 400 * near.distortion.domain_volume()});
    CHECK(r.result.status == Status::converged);
}

TEST_CASE("a linear solver that cannot solve ends the iteration") {
    const Minimisation problem = moved_ring(Objective::squared);
    LinearSolverParams no_memory;
    no_memory.kind = SolverKind::cholesky;
    no_memory.memory_limit = 1;
    const Run r = run(problem, problem.functional(300), {}, no_memory);
    CHECK(r.result.status == Status::linear_solver_failed);
    CHECK(r.steps.empty());
    CHECK(r.x == problem.ideal);
}

TEST_CASE("a functional without a minimum ends with a status, on a valid mesh") {
    // Multipliers that push everything to one side, and no penalty that holds it.
    const Minimisation problem = moved_ring(Objective::squared);
    AugmentedFunctional E = problem.functional(0);
    std::fill(E.lambda.begin(), E.lambda.end(), 1.0);
    const Run r = run(problem, E, {});
    CHECK(r.result.status != Status::converged);
    CHECK(std::isfinite(E.energy(r.x)));
}

TEST_CASE("iterative solvers and Cholesky lead to the same minimum") {
    const Minimisation problem{
        cube_mesh(3), {{"top", "scale 1 1 1.2"}, {"sides", "scale 1 1 1.2"}}, Objective::squared};
    const AugmentedFunctional E = problem.functional(300);
    LinearSolverParams cholesky;
    cholesky.kind = SolverKind::cholesky;
    const Run direct = run(problem, E, {}, cholesky);
    CHECK(direct.result.status == Status::converged);
    CHECK(direct.result.linear_iterations == 0);
    CHECK(direct.steps[0].solver == SolverKind::cholesky);
    for (SolverKind kind : {SolverKind::cg, SolverKind::gmres}) {
        LinearSolverParams linear;
        linear.kind = kind;
        const Run iterative = run(problem, E, {}, linear);
        CHECK(iterative.result.status == Status::converged);
        CHECK(iterative.result.linear_iterations > 0);
        CHECK(iterative.steps[0].solver == kind);
        CHECK(norm_2(iterative.x) == doctest::Approx(norm_2(direct.x)).epsilon(1e-9));
        CHECK(iterative.result.energy == doctest::Approx(direct.result.energy).epsilon(1e-12));
    }
}

TEST_CASE("the same bits for any number of threads") {
    const Minimisation problem = moved_ring(Objective::deviation, 2);
    const auto results = for_threads([&] {
        return run(problem, problem.functional(300), {.max_iterations = 8, .first = HessianKind::damping})
            .x;
    });
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}

TEST_CASE("every Hessian has a name of its own") {
    CHECK(std::string(to_string(HessianKind::full)) == "full");
    CHECK(std::string(to_string(HessianKind::projected)) == "projected");
    CHECK(std::string(to_string(HessianKind::damping)) == "damping");
}

TEST_CASE("damping spares Newton's method steps from the identity map") {
    for (const double mu : {300.0, 1e5}) {
        const Minimisation problem{raise_degree(ring_mesh(16, 5, 8), 2), {{"inner", "rotate 60; translate 3 1"}},
                                   Objective::deviation};
        const Run r = run(problem, problem.functional(mu), {.omega = 1e-8, .cold_start = true});
        CHECK(r.result.status == Status::converged);
        CHECK(r.result.iterations <= 8);
    }
}

TEST_CASE("the tolerance: omega, or a part of the first gradient, but not less than the final one") {
    const Minimisation problem = moved_ring(Objective::squared);
    const AugmentedFunctional E = problem.functional(300);
    const double first = norm_of_gradient(E, problem.ideal);
    const auto tolerance = [&](double omega, double reduction, double omega_star) {
        return run(problem, E, {.omega = omega, .reduction = reduction, .omega_star = omega_star, .max_iterations = 0})
            .result.omega;
    };
    CHECK(tolerance(1e-3, 1, 1e-8) == 1e-3);
    CHECK(tolerance(1e9, 0.1, 1e-8) == 0.1 * first);
    CHECK(tolerance(1e-3, 0.1, 1e-8) == 1e-3);
    CHECK(tolerance(1e-3, 1e-9, 1e-4) == 1e-4);
}

TEST_CASE("where nodes hang at a kink the iteration ends, instead of taking steps that lead nowhere") {
    const Minimisation problem(square_mesh(4), {}, Objective::squared);
    Kinked constraint(problem, 12, 1e-4);  // the node in the middle
    const std::vector<double> lambda(constraint.multipliers(), 0.0);
    const AugmentedFunctional E{problem.distortion, constraint, lambda, 1e4};
    const Run r = run(problem, E, {.omega = 1e-8, .max_iterations = 400});
    CHECK(r.result.status == Status::line_search_failed);
    CHECK(r.result.iterations < 100);
    CHECK(std::abs(r.x[24] - problem.ideal[24] - 1e-4) < 1e-5);
}
