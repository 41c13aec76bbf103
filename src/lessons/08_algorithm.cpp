// Lesson 8: Algorithm 1 of the paper, line by line, in the only consistent reading; and with each of its misprints put
// back, alone or together:
//
//   08_algorithm                      all of them: |c_D| after every iteration
//   08_algorithm printed [mu0]        one of them in full, from another first penalty mu0; `corrected` is none
//
// The inner circle of the ring is moved by 8; the numbers on the right are those of the paper's lines.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "energy/distortion_energy.hpp"
#include "lessons/circle.hpp"
#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"
#include "method/newton.hpp"

using namespace almesh;
using namespace almesh::lessons;

namespace {

struct Variant {
    const char* name;
    double mu0;
    bool weight = false;  // Eq. 6: the penalty's weight is mu^2, and line 10 takes mu
    bool either = false;  // line 7: ends where one of the two tests holds
    bool looser = false;  // lines 19 and 20: the tolerances grow with m
    bool by_mu = false;   // line 14: omega is divided by mu, not by m
};

// In every variant the first subproblem has the same penalty of weight 24 |1|^2 = 960.
const Variant variants[] = {
    {.name = "corrected", .mu0 = 960},
    {.name = "weight", .mu0 = 31, .weight = true},
    {.name = "either", .mu0 = 960, .either = true},
    {.name = "looser", .mu0 = 960, .looser = true},
    {.name = "by-mu", .mu0 = 960, .by_mu = true},
    {.name = "printed", .mu0 = 31, .weight = true, .either = true, .looser = true, .by_mu = true},
};

constexpr double m0 = 10, omega0 = 0.1, epsilon0 = 1e-4, omega_star = 1e-6, epsilon_star = 1e-14;
constexpr int most_iterations = 6;

double norm_of_gradient(const AugmentedFunctional& E, const Vector& x) {
    Vector g(x.size());
    E.gradient(x, g);
    return norm_2(g);
}

using Report =
    std::function<void(int k, double c, bool stationary, double mu, double omega, double epsilon, int steps)>;

// Calls `report` after every subproblem, `say` with what was done then. Returns how it ended.
const char* algorithm_1(const Variant& as, const Report& report, const std::function<void(const char*)>& say) {
    const Mesh mesh = ring();
    const auto energy = make_energy(mesh, mesh.x, {.objective = Objective::squared});
    Dirichlet constraint(mesh, mesh.x, inner_circle_by(mesh, "translate 8 0"), TargetKind::nodal);
    Newton newton(energy->hessian_pattern(), {});
    NewtonParams until;

    Vector x = mesh.x;                                                                          //  2
    AugmentedFunctional E = {*energy, constraint, Vector(constraint.multipliers(), 0.0)};       //  3
    double m = m0, mu = as.mu0, omega = omega0, epsilon = epsilon0;                             //  4-6
    for (int k = 1; k <= most_iterations; ++k) {
        E.penalty = as.weight ? mu * mu : mu;                                                   // Eq. 6
        until.omega = std::max(omega, omega_star);
        const int steps = newton.minimise(E, until, x).iterations;                              //  8
        const double c_squared = std::pow(constraint.norm(x), 2), g = norm_of_gradient(E, x);
        const bool constrained = c_squared <= epsilon_star, stationary = g <= omega_star;
        report(k, std::sqrt(c_squared), stationary, mu, omega, epsilon, steps);
        if (as.either ? constrained || stationary : constrained && stationary)                  //  7
            return constrained && stationary ? "both tests hold" : "one test holds";
        if (c_squared <= epsilon) {                                                             //  9
            axpy(-mu, constraint.constraint_field(x), E.lambda);                                // 10
            epsilon /= std::pow(m, 0.9);                                                        // 13
            omega /= as.by_mu ? mu : m;                                                         // 14
            say("lambda");
        } else {                                                                                // 15
            m *= 100;                                                                           // 17
            mu = as.mu0 * (m / m0);                                                             // 18
            epsilon = epsilon0 * std::pow(as.looser ? m / m0 : m0 / m, 0.1);                    // 19
            omega = omega0 * (as.looser ? m / m0 : m0 / m);                                     // 20
            say("mu");
        }
    }
    return "no end";
}

void print_in_full(const Variant& variant) {
    std::printf(" k      |c_D|  grad E        mu     omega   epsilon  Newton  update\n");
    const char* const end = algorithm_1(
        variant,
        [](int k, double c, bool stationary, double mu, double omega, double epsilon, int steps) {
            std::printf("%2d  %9.3e  %6s  %8.2g  %8.2g  %8.2g  %6d  ", k, c, stationary ? "small" : "large", mu, omega,
                        epsilon, steps);
        },
        [](const char* update) { std::printf("%s\n", update); });
    std::printf("%s\n", end);
}

void print_row(const Variant& variant, std::FILE* csv) {
    std::printf("%-10s", variant.name);
    const char* const end = algorithm_1(
        variant,
        [&](int k, double c, bool, double mu, double, double, int steps) {
            std::printf(" %9.3e", c);
            std::fprintf(csv, "%s,%d,%.6g,%.6g,%d\n", variant.name, k, c, mu, steps);
        },
        [](const char*) {});
    std::printf("  %s\n", end);
}

}  // namespace

int main(int count, char** argument) {
    if (count > 1) {
        for (Variant variant : variants) {
            if (std::string(argument[1]) != variant.name) continue;
            if (count > 2) variant.mu0 = std::atof(argument[2]);
            print_in_full(variant);
        }
        return 0;
    }
    std::filesystem::create_directories("outputs/lessons/08-algorithm");
    std::FILE* const csv = std::fopen("outputs/lessons/08-algorithm/variants.csv", "w");
    std::fprintf(csv, "variant,k,c,mu,newton\n");
    for (const Variant& variant : variants) print_row(variant, csv);
    std::fclose(csv);
}
