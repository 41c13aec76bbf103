// Lesson 12: densities of your own, without a change in the library. The circle of section 4.1 is moved by 8, and
// Newton's method (moved_circle.hpp) minimises over the inner nodes the integral of f(eta) for several f: structs as
// energy/densities.hpp describes them.
//
// Argument: M of the barrier.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "lessons/moved_circle.hpp"

using namespace almesh;
using namespace almesh::lessons;

namespace {

struct Squared {
    using Measure = Shape;
    double f(double eta) const { return eta * eta; }
    double f1(double eta) const { return 2 * eta; }
    double f2(double) const { return 2; }
};

struct Deviation {  // Eq. 5
    using Measure = Shape;
    double f(double eta) const { return (eta - 1) * (eta - 1); }
    double f1(double eta) const { return 2 * (eta - 1); }
    double f2(double) const { return 2; }
};

struct Cubic {  // + 0.01 (eta - 1): f' > 0 at eta = 1 keeps the Hessian from vanishing there
    using Measure = Shape;
    double f(double eta) const { return std::pow(eta - 1, 3) + 0.01 * (eta - 1); }
    double f1(double eta) const { return 3 * (eta - 1) * (eta - 1) + 0.01; }
    double f2(double eta) const { return 6 * (eta - 1); }
};

struct Barrier {  // no element may have eta >= M
    using Measure = Shape;
    double M;
    double f(double eta) const { return eta < M ? -std::log((M - eta) / (M - 1)) : INFINITY; }
    double f1(double eta) const { return 1 / (M - eta); }
    double f2(double eta) const { return 1 / ((M - eta) * (M - eta)); }
};

template <class Density>
void minimise_and_print(const MovedCircle& problem, const char* name, Density density, std::FILE* csv) {
    const Minimum minimum = minimise(problem, density);
    if (!std::isfinite(energy(problem, problem.start, density)))
        return (void)std::printf("%-26s the energy is infinite at the start: no line search can begin\n", name);
    std::vector<double> eta;
    double area = 0, eta_squared = 0;
    for (int e = 0; e < problem.mesh.element_count(); ++e) {
        eta.push_back(problem.eta(e, minimum.x));
        area += problem.area[e];
        eta_squared += problem.area[e] * eta[e] * eta[e];
    }
    std::sort(eta.begin(), eta.end(), std::greater<>());
    std::printf("%-26s %3d %9.4f %11.4f %8.4f%s\n", name, minimum.steps, std::sqrt(area / eta_squared),
                eta[eta.size() / 2], eta[0], minimum.converged ? "" : "  not converged");
    for (std::size_t rank = 0; rank < eta.size(); ++rank) std::fprintf(csv, "%s,%zu,%.6g\n", name, rank + 1, eta[rank]);
}

}  // namespace

int main(int count, char** argument) {
    const MovedCircle problem;
    double largest = 0;
    for (int e = 0; e < problem.mesh.element_count(); ++e) largest = std::max(largest, problem.eta(e, problem.start));
    std::printf("max eta of the blended mesh at the start: %.4f\n", largest);
    std::filesystem::create_directories("outputs/lessons/12-project");
    std::FILE* const csv = std::fopen(count > 1 ? "/dev/null" : "outputs/lessons/12-project/eta.csv", "w");
    std::fprintf(csv, "density,rank,eta\n");
    std::printf("density                  steps         q  median eta  max eta\n");
    if (count == 1) {
        minimise_and_print(problem, "eta^2", Squared(), csv);
        minimise_and_print(problem, "(eta - 1)^2", Deviation(), csv);
        minimise_and_print(problem, "(eta - 1)^3", Cubic(), csv);
    }
    const double M = count > 1 ? std::atof(argument[1]) : 2;
    char name[40];
    std::snprintf(name, sizeof name, "barrier at %g", M);
    minimise_and_print(problem, name, Barrier{M}, csv);
    std::fclose(csv);
}
