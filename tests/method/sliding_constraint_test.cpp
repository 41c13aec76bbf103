// The method with a constraint that is not linear and has no fixed number of multipliers per node: the nodes of the
// inner boundary of a ring slide on a circle, those of the outer one stay. Nothing outside of a Constraint may know
// more of it than constraint.hpp says.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/index.hpp"
#include "check/certificate.hpp"
#include "linalg/vector_ops.hpp"
#include "method/local_functional.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Circle {
    std::array<double, 2> centre;
    double radius;
};

// One condition h(x) = 0 on the position x of a node: it is on a circle, or its component `axis` has a value.
struct Condition {
    int node;
    int axis;  // -1: on the circle
    double value;

    struct Derivatives {
        double h, h1[2], h2[2][2];
    };
    Derivatives at(const double* x, const Circle& circle) const {
        Derivatives d = {};
        if (axis >= 0) {
            d.h = x[axis] - value;
            d.h1[axis] = 1;
            return d;
        }
        const double e[2] = {x[0] - circle.centre[0], x[1] - circle.centre[1]}, r = std::hypot(e[0], e[1]);
        d.h = r - circle.radius;
        for (int a = 0; a < 2; ++a) {
            d.h1[a] = e[a] / r;
            for (int b = 0; b < 2; ++b) d.h2[a][b] = ((a == b) - e[a] * e[b] / (r * r)) / r;
        }
        return d;
    }
};

// -lambda h/|1| + mu/2 (h/|1|)^2 of one condition, with derivatives.
struct Term {
    double value = 0, g[2] = {}, H[2][2] = {};

    // projected: the second derivative of a distance is positive semidefinite, so its factor decides.
    Term(const Condition::Derivatives& d, double one, double lambda, double mu, bool projected = false) {
        const double c = d.h / one, slope = (mu * c - lambda) / one;
        value = -lambda * c + 0.5 * mu * c * c;
        for (int a = 0; a < 2; ++a) {
            g[a] = slope * d.h1[a];
            for (int b = 0; b < 2; ++b) {
                const double curvature = projected ? std::max(slope, 0.0) : slope;
                H[a][b] = mu / (one * one) * d.h1[a] * d.h1[b] + curvature * d.h2[a][b];
            }
        }
    }
};

// (u, v) = sum over the nodes of u . v, so that |1|^2 is their number. One multiplier for a node that slides, two for
// one that stays.
class Sliding : public Constraint {
public:
    Sliding(const Mesh& mesh, const std::vector<double>& ideal, const Circle& circle) : ideal_(ideal), circle_(circle) {
        std::vector<int> boundary(mesh.nodes(), -1);
        for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k)
            boundary[mesh.faces[k]] = mesh.face_boundary[k / mesh.face_nodes(0)];
        for (int i = 0; i < mesh.nodes(); ++i) {
            if (boundary[i] < 0) continue;
            nodes_.push_back(i);
            if (mesh.boundaries[boundary[i]] == "inner") conditions_.push_back({i, -1, 0});
            else
                for (int a = 0; a < 2; ++a) conditions_.push_back({i, a, point(ideal, i, 2)[a]});
        }
        one_ = std::sqrt(static_cast<double>(nodes_.size()));
    }

    int multipliers() const override { return static_cast<int>(conditions_.size()); }
    double norm_of_one() const override { return one_; }
    double norm(const std::vector<double>& x) override { return projected_norm(x); }
    double projected_norm(const std::vector<double>& x) override { return norm_2(values(x)); }
    double max_error(const std::vector<double>& x) override {
        double most = 0;
        for (double c : values(x)) most = std::max(most, std::abs(c) * one_);
        return most;
    }
    std::vector<double> relative_errors(const std::vector<double>& x) const override {
        std::vector<double> errors = values(x);
        for (double& c : errors) c = std::abs(c) * one_;  // in a cell of height 1
        return errors;
    }
    double value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) override {
        double E = 0;
        each(x, lambda, mu, false, [&](int, const Term& term) { E += term.value; });
        return E;
    }
    void add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                      std::vector<double>& g) override {
        each(x, lambda, mu, false, [&](int node, const Term& term) {
            for (int a = 0; a < 2; ++a) g[offset(node, 2, a)] += term.g[a];
        });
    }
    void add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
                     BlockCsr& H) override {
        each(x, lambda, mu, projected, [&](int node, const Term& term) {
            double* const block = H.block(H.find(node, node));
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) block[a * 2 + b] += term.H[a][b];
        });
    }
    void update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) override {
        const std::vector<double> c = values(x);
        for (std::size_t k = 0; k < c.size(); ++k) lambda[k] -= mu * c[k];
    }
    // The conditions of these nodes, numbered anew: as nonlinear as the whole.
    std::unique_ptr<Constraint> part(const Restriction& around, std::vector<double>& lambda) const override {
        auto part = std::make_unique<Sliding>(*this);
        part->conditions_.clear();
        std::vector<double> of_part;
        for (std::size_t k = 0; k < conditions_.size(); ++k) {
            const auto at = std::find(around.node.begin(), around.node.end(), conditions_[k].node);
            if (at == around.node.end()) continue;
            part->conditions_.push_back(conditions_[k]);
            part->conditions_.back().node = static_cast<int>(at - around.node.begin());
            of_part.push_back(lambda[k]);
        }
        lambda = of_part;
        ++parts;
        return part;
    }
    const std::vector<int>& nodes() const override { return nodes_; }
    std::vector<double> multiplier_field(const std::vector<double>& lambda) const override {
        std::vector<double> field(2 * nodes_.size(), 0.0);
        each_direction([&](std::size_t k, std::size_t i, double direction) { field[i] += lambda[k] * direction; });
        return field;
    }
    std::vector<double> multipliers_of_field(const std::vector<double>& field) const override {
        std::vector<double> lambda(conditions_.size(), 0.0);
        each_direction([&](std::size_t k, std::size_t i, double direction) { lambda[k] += field[i] * direction; });
        return lambda;
    }
    std::vector<double> constraint_field(const std::vector<double>& x) const override {
        return multiplier_field(values(x));
    }

    SurfaceDistance distance(int t, const Vec<3>& x) const override {  // r = sum of h grad h
        SurfaceDistance sum;
        for (const Condition& condition : conditions_) {
            if (condition.node != nodes_[t]) continue;
            const auto d = condition.at(x.data(), circle_);
            for (int a = 0; a < 2; ++a) {
                sum.r[a] += d.h * d.h1[a];
                for (int b = 0; b < 2; ++b) sum.slope[a][b] += d.h1[a] * d.h1[b] + d.h * d.h2[a][b];
            }
        }
        return sum;
    }

    mutable int parts = 0;  // made so far

private:
    const std::vector<double>& ideal_;
    std::vector<int> nodes_;
    Circle circle_;
    double one_;
    std::vector<Condition> conditions_;

    template <class Body>
    void each(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
              const Body& body) const {
        REQUIRE(lambda.size() == conditions_.size());
        for (std::size_t k = 0; k < conditions_.size(); ++k) {
            const int node = conditions_[k].node;
            body(node, Term(conditions_[k].at(point(x, node, 2), circle_), one_, lambda[k], mu, projected));
        }
    }
    std::vector<double> values(const std::vector<double>& x) const {
        std::vector<double> c;
        for (const Condition& condition : conditions_)
            c.push_back(condition.at(point(x, condition.node, 2), circle_).h / one_);
        return c;
    }
    // body(condition, place in the field, component of the direction that it acts in at the ideal mesh).
    template <class Body>
    void each_direction(const Body& body) const {
        std::size_t t = 0;
        for (std::size_t k = 0; k < conditions_.size(); ++k) {
            const Condition& condition = conditions_[k];
            while (nodes_[t] != condition.node) ++t;
            const auto d = condition.at(point(ideal_, condition.node, 2), circle_);
            for (int a = 0; a < 2; ++a) body(k, 2 * t + a, d.h1[a]);
        }
    }
};

std::unique_ptr<Level> sliding_level(const Mesh& mesh, const Circle& circle, Objective objective) {
    auto level = std::make_unique<Level>();
    level->mesh = mesh;
    level->ideal = straight_sided(mesh);
    level->energy = make_energy(level->mesh, level->ideal, {.objective = objective});
    level->constraint = std::make_unique<Sliding>(level->mesh, level->ideal, circle);
    return level;
}

AlResult solve(Level& level, std::vector<double>& x, const AlStart& start = {}, Algorithm algorithm = {}) {
    Newton newton(level.energy->hessian_pattern(), {});
    AugmentedLagrangianParams params;
    params.algorithm = algorithm;
    if (start.lambda.empty()) x = level.ideal;
    return minimise(*level.energy, *level.constraint, newton, params, x, {}, start);
}

const Circle there = {{1.5, 0.5}, 1.6};  // from the unit circle about the origin

}  // namespace

TEST_CASE("the constraint of this test: gradient and Hessian have slope 2, and fields lead back to multipliers") {
    const auto level = sliding_level(ring_mesh(8, 2, 4), there, Objective::squared);
    Constraint& constraint = *level->constraint;
    CHECK(constraint.multipliers() == 8 + 16);
    const std::vector<double> x = wavy(level->ideal, 2, 0.1);
    std::vector<double> lambda(constraint.multipliers()), d(x.size());
    for (std::size_t k = 0; k < lambda.size(); ++k) lambda[k] = std::sin(1.0 + static_cast<double>(k));
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::cos(static_cast<double>(i));
    const auto moved = [&](double t) {
        std::vector<double> y = x;
        for (std::size_t i = 0; i < y.size(); ++i) y[i] += t * d[i];
        return y;
    };
    const auto gradient = [&](double t) {
        std::vector<double> g(x.size(), 0.0);
        constraint.add_gradient(moved(t), lambda, 7, g);
        return g;
    };
    BlockCsr H = level->energy->hessian_pattern();
    constraint.add_hessian(x, lambda, 7, false, H);
    std::vector<double> Hd(x.size());
    multiply(H, d.data(), Hd.data());
    double first[2], second[2];
    for (int k = 0; k < 2; ++k) {
        const double t = 1e-2 / (1 + k);
        const double slope = (constraint.value(moved(t), lambda, 7) - constraint.value(moved(-t), lambda, 7)) / (2 * t);
        first[k] = std::abs(slope - dot(gradient(0), d));
        std::vector<double> difference = gradient(t);
        for (std::size_t i = 0; i < difference.size(); ++i)
            difference[i] = (difference[i] - gradient(-t)[i]) / (2 * t) - Hd[i];
        second[k] = norm_2(difference);
    }
    CHECK(std::log2(first[0] / first[1]) == doctest::Approx(2).epsilon(0.1));
    CHECK(std::log2(second[0] / second[1]) == doctest::Approx(2).epsilon(0.1));
    const std::vector<double> back = constraint.multipliers_of_field(constraint.multiplier_field(lambda));
    for (std::size_t k = 0; k < lambda.size(); ++k) CHECK(back[k] == doctest::Approx(lambda[k]).epsilon(1e-13));
}

TEST_CASE("nodes slide on a circle: the method converges to where the distortion has no force along it") {
    for (Algorithm algorithm : {Algorithm::adaptive, Algorithm::paper})
        for (const Objective objective : {Objective::squared, Objective::deviation, Objective::size_shape}) {
            const auto level = sliding_level(ring_mesh(16, 5, 8), there, objective);
            std::vector<double> x;
            const AlResult result = solve(*level, x, {}, algorithm);
            CAPTURE(static_cast<int>(algorithm));
            CAPTURE(static_cast<int>(objective));
            CHECK(std::string(to_string(result.status)) == "converged");
            CHECK(result.lambda.size() == 16 + 2 * 16);
            CHECK(level->constraint->max_error(x) < 1e-6);
            CHECK(certify(level->mesh, x).valid);

            // The multipliers balance the distortion, which pulls the inner nodes along their radii only.
            std::vector<double> g(x.size(), 0.0), forces(x.size(), 0.0);
            level->energy->add_gradient(x, forces);
            g = forces;
            level->constraint->add_gradient(x, result.lambda, 0, g);
            CHECK(norm_2(g) < 1e-7);
            double radial = 0;
            for (int i = 0; i < 16; ++i) {  // ring_mesh numbers the inner circle first
                const double e[2] = {x[2 * i] - there.centre[0], x[2 * i + 1] - there.centre[1]};
                CHECK(std::hypot(e[0], e[1]) == doctest::Approx(there.radius).epsilon(1e-6));
                CHECK(std::abs(e[0] * forces[2 * i + 1] - e[1] * forces[2 * i]) < 1e-6);
                radial = std::max(radial, std::abs(e[0] * forces[2 * i] + e[1] * forces[2 * i + 1]));
            }
            CHECK(radial > 1e-3);
        }
}

TEST_CASE("sliding distorts the mesh less than positions prescribed on the same circle") {
    const Mesh mesh = ring_mesh(16, 5, 8);
    const Minimisation prescribed(mesh, {{"inner", "scale 1.6; translate 1.5 0.5"}}, Objective::deviation,
                                  TargetKind::nodal);
    const auto sliding = sliding_level(mesh, there, Objective::deviation);
    std::vector<double> x, y;
    REQUIRE(prescribed.solve({}, x).status == Status::converged);
    REQUIRE(solve(*sliding, y).status == Status::converged);
    CHECK(sliding->constraint->max_error(x) < 1e-6);
    CHECK(sliding->energy->energy(y) < 0.99 * sliding->energy->energy(x));
}

TEST_CASE("a local functional takes the part of the constraint that its nodes see") {
    const auto level = sliding_level(ring_mesh(8, 2, 4), there, Objective::squared);
    const AugmentedFunctional E{*level->energy, *level->constraint,
                                std::vector<double>(level->constraint->multipliers(), 0.3), 500};
    const std::vector<double> x = wavy(level->ideal, 2, 0.05);
    std::vector<char> moves(level->mesh.nodes(), 0);
    moves[1] = moves[2] = moves[10] = moves[17] = 1;  // two inner nodes, one inside, one outer
    const std::unique_ptr<LocalFunctional> local_part = E.part(x, moves);
    LocalFunctional& local = *local_part;
    REQUIRE(local.read(x).size() < x.size());
    std::vector<double> y = local.read(x);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += 0.05 * std::sin(1.0 + static_cast<double>(i));
    std::vector<double> moved = x, back = local.read(x);
    local.write(y, moved);
    // Nodes that are fixed stay: y as the mesh has it.
    std::vector<double> number(x.size(), -1.0), index(y.size());
    for (std::size_t i = 0; i < index.size(); ++i) index[i] = static_cast<double>(i);
    local.write(index, number);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (number[i] >= 0) back[static_cast<std::size_t>(number[i])] = moved[i];
    CHECK(local.energy(back) - local.energy(local.read(x)) ==
          doctest::Approx(E.energy(moved) - E.energy(x)).epsilon(1e-10));
    std::vector<double> g(y.size()), whole(x.size()), v(y.size(), 0.0), Hv(y.size()), w(x.size(), 0.0), Hw(x.size());
    local.gradient(back, g);
    E.gradient(moved, whole);
    BlockCsr H = local.hessian_pattern(), full = level->energy->hessian_pattern();
    local.hessian(back, HessianKind::full, H);
    E.hessian(moved, HessianKind::full, full);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (number[i] >= 0) v[static_cast<std::size_t>(number[i])] = w[i] = std::cos(static_cast<double>(i));
    multiply(H, v.data(), Hv.data());
    multiply(full, w.data(), Hw.data());
    int coordinates = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (number[i] < 0) continue;
        const auto k = static_cast<std::size_t>(number[i]);
        CHECK(g[k] == doctest::Approx(whole[i]).epsilon(1e-10).scale(1));
        CHECK(Hv[k] == doctest::Approx(Hw[i]).epsilon(1e-10).scale(1));
        ++coordinates;
    }
    CHECK(coordinates == 8);
}

TEST_CASE("local elimination works with it: a large motion takes local steps and converges") {
    const auto level = sliding_level(ring_mesh(24, 8, 8), {{5.2, 0}, 1}, Objective::squared);
    std::vector<double> x;
    const AlResult result = solve(*level, x);
    CHECK(std::string(to_string(result.status)) == "converged");
    CHECK(result.local_steps > 0);
    CHECK(static_cast<Sliding&>(*level->constraint).parts > 0);
    CHECK(level->constraint->max_error(x) < 1e-6);
    CHECK(certify(level->mesh, x).valid);
}

TEST_CASE("continuation carries its multipliers from mesh to mesh") {
    const Mesh base = ring_mesh(12, 4, 6);
    const Circle near = {{0.5, 0.2}, 1.2};  // further away there are several minima
    const auto make_level = [&](int k) { return sliding_level(refine(base, k), near, Objective::deviation); };
    Timings time;
    int stages = 0;
    const CoarseSolution coarse = solve_coarser(2, make_level, {}, time, [&](const Stage& stage) {
        CHECK(std::string(to_string(stage.status)) == "converged");
        ++stages;
    });
    CHECK(stages == 2);
    const auto fine = make_level(2);
    std::vector<double> x, y;
    const AlStart start = start_from(coarse, *fine, x);
    REQUIRE(start.lambda.size() == static_cast<std::size_t>(fine->constraint->multipliers()));
    CHECK(norm_2(start.lambda) > 0);
    const AlResult continued = solve(*fine, x, start), cold = solve(*fine, y);
    CHECK(std::string(to_string(continued.status)) == "converged");
    CHECK(cold.status == Status::converged);
    CHECK(continued.newton_iterations <= cold.newton_iterations - 3);
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) largest = std::max(largest, std::abs(x[i] - y[i]));
    CHECK(largest < 1e-5);
}
