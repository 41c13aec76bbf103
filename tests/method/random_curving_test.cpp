// Random curving problems: whatever the degree, the objective and the weights, no iterate that is accepted has a folded
// element, and so what converges is certified. The displacement of the boundary is a random field u: where |grad u| is
// well below one, y + u folds nothing and there is a solution; above one the boundary may be folded itself.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "check/certificate.hpp"
#include "constraint/dirichlet.hpp"
#include "method/continuation.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// u_a(y) = sum of `waves` sines of random direction, phase and wave length, scaled so that |grad u| <= steepness.
class RandomField {
public:
    RandomField(int dim, double shortest, double steepness, std::mt19937& random) : dim_(dim) {
        std::uniform_real_distribution<double> unit(-1, 1);
        constexpr int waves = 3;
        for (int w = 0; w < waves; ++w) {
            Wave wave{};
            double norm = 0, size = 0;
            for (int a = 0; a < dim; ++a) {
                wave.k[a] = unit(random);
                wave.amplitude[a] = unit(random);
                norm += wave.k[a] * wave.k[a];
                size += wave.amplitude[a] * wave.amplitude[a];
            }
            const double wave_number = 2 * std::numbers::pi / (shortest * (1.5 + 0.5 * unit(random)));
            for (int a = 0; a < dim; ++a) {
                wave.k[a] *= wave_number / std::sqrt(norm);
                wave.amplitude[a] *= steepness / (waves * wave_number * std::sqrt(size));
            }
            wave.phase = std::numbers::pi * unit(random);
            waves_.push_back(wave);
        }
    }

    void add_to(std::vector<double>& positions) const {
        for (std::size_t i = 0; i < positions.size(); i += dim_) {
            Vec<3> u{};
            for (const Wave& wave : waves_) {
                double angle = wave.phase;
                for (int a = 0; a < dim_; ++a) angle += wave.k[a] * positions[i + a];
                for (int a = 0; a < dim_; ++a) u[a] += wave.amplitude[a] * std::sin(angle);
            }
            for (int a = 0; a < dim_; ++a) positions[i + a] += u[a];
        }
    }

private:
    struct Wave {
        Vec<3> k, amplitude;
        double phase;
    };
    int dim_;
    std::vector<Wave> waves_;
};

struct Counts {
    int problems = 0, converged = 0, refined = 0;
};

void solve(int number, Counts& tame, Counts& wild) {
    std::mt19937 random(1000 + number);
    const auto pick = [&random](auto... of) {
        const double values[] = {static_cast<double>(of)...};
        return values[std::uniform_int_distribution<int>(0, sizeof...(of) - 1)(random)];
    };
    const bool in_space = number % 4 == 3;
    const int degree = static_cast<int>(in_space ? pick(2, 2, 3) : pick(2, 3, 4, 5));
    const double cells = pick(2, 3);
    const bool ring = !in_space && pick(0, 1) == 1;
    const Mesh linear = in_space ? cube_mesh(2)
                        : ring   ? ring_mesh(8 + static_cast<int>(cells), 3, 3)
                                 : square_mesh(static_cast<int>(cells));
    Level level{raise_degree(linear, degree), {}, nullptr, nullptr};
    level.ideal = straight_sided(level.mesh);
    BoundaryTarget target = target_of(level.mesh, {});
    const double steepness = in_space ? pick(0.5, 0.8, 1.1) : pick(0.6, 0.9, 1.3, 1.6);
    const RandomField field(level.mesh.dim, ring ? 0.8 : 0.4, steepness, random);
    field.add_to(target.node);
    field.add_to(target.sample);
    const Objective objective = pick(0, 1) == 0 ? Objective::squared : Objective::deviation;
    const double alpha = pick(0, 0.5, 1);
    level.energy = make_energy(level.mesh, level.ideal, {.objective = objective, .weight_exponent = alpha});
    level.constraint = std::make_unique<Dirichlet>(level.mesh, level.ideal, target, TargetKind::nodal);

    std::vector<double> x = level.ideal;
    Newton newton(level.energy->hessian_pattern(), {});
    int uncertified = 0;
    AlObserver observer;
    observer.newton_step = [&](int, const NewtonStep&) { uncertified += !certify(level.mesh, x).valid; };
    const AlResult result =
        minimise(*level.energy, *level.constraint, newton, {.max_newton_iterations = 60}, x, observer);
    CAPTURE(number);
    CAPTURE(degree);
    CAPTURE(alpha);
    CAPTURE(std::string(to_string(result.status)));
    CHECK(uncertified == 0);
    CHECK(certify(level.mesh, x).valid);
    Counts& counts = steepness < 0.9 ? tame : wild;
    ++counts.problems;
    counts.converged += result.status == Status::converged;
    counts.refined += level.energy->refined_elements() > 0;
}

}  // namespace

TEST_CASE("240 random curving problems: every iterate is certified, and all that must converge do") {
    Counts tame, wild;
    for (int number = 0; number < 240; ++number) solve(number, tame, wild);
    CHECK(tame.problems > 80);
    CHECK(tame.converged == tame.problems);
    CHECK(wild.converged > 0.8 * wild.problems);
    CHECK(wild.refined > 0.15 * wild.problems);  // hard enough to need a finer quadrature
}
