// Lesson 4: Newton's method with a line search on a square whose boundary is fixed and whose inside has been swirled.
//
//     minimise  E(x) = integral of eta^2 (deviation: of (eta - 1)^2)  over the positions x of the interior nodes
//
//   04_newton decrease
//   04_newton [pure | search | projected | switching] [angle of the swirl in degrees] [deviation] [bent]
//
// pure: the full Hessian, full steps. search: with Armijo's condition. projected: the positive semidefinite part of the
// Hessian, triangle by triangle. switching: full after a full step where it is positive definite, else projected. None
// of them: all four, compared. decrease: x^2 in one variable, by any decrease and by Armijo's condition.
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "io/vtk.hpp"
#include "lessons/dense.hpp"
#include "lessons/plain_energy.hpp"
#include "lessons/square.hpp"
#include "linalg/dense_solve.hpp"

using namespace almesh;
using namespace almesh::lessons;

namespace {

const Mesh mesh = unit_square(1);
std::vector<int> interior;  // the unknowns: entries of x that may change
double angle = 120;
bool bent = false;

Vector gradient(PlainEnergy& E, const Vector& x) {
    Vector g(x.size(), 0.0), of_interior;
    E.add_gradient(x, g);
    for (const int i : interior) of_interior.push_back(g[i]);
    return of_interior;
}

Vector hessian(PlainEnergy& E, const Vector& x, HessianKind kind) {
    BlockCsr K = E.hessian_pattern();
    E.add_hessian(x, kind, K);
    return dense_part(K, interior);
}

Vector moved(Vector x, double t, const Vector& d) {
    for (std::size_t i = 0; i < interior.size(); ++i) x[interior[i]] += t * d[i];
    return x;
}

struct Step {
    double energy, size, slope, t;  // E, |g|, g.d, the length
    int negative;                   // eigenvalues of the full Hessian
    bool full;                      // the one that made d
};

struct Run {
    std::vector<Step> steps;
    const char* end;
};

Run newton(PlainEnergy& E, const std::string& method) {
    std::vector<Step> steps;
    Vector x = swirled(mesh, angle, bent), d;
    double t = 0;
    while (steps.size() < 100) {
        const double energy = E.energy(x);
        if (!std::isfinite(energy)) return {steps, steps.empty() ? "starts inverted" : "inverted"};
        const Vector g = gradient(E, x), H = hessian(E, x, HessianKind::full);
        const int negative = negative_eigenvalues(static_cast<int>(g.size()), H);
        const bool full = method == "pure" || method == "search" || (method == "switching" && t == 1 && negative == 0);
        steps.push_back({energy, norm_2(g), 0, 0, negative, full});
        if (norm_2(g) < 1e-6) return {steps, "converged"};

        if (!solve_dense(full ? H : hessian(E, x, HessianKind::projected), g, d)) return {steps, "singular"};
        for (double& entry : d) entry = -entry;
        const double slope = steps.back().slope = dot(g, d);
        if (slope >= 0 && method != "pure") return {steps, "no descent"};

        t = 1;
        while (method != "pure" && !(E.energy(moved(x, t, d)) <= energy + 1e-4 * t * slope)) t /= 2;
        steps.back().t = t;
        x = moved(x, t, d);
    }
    return {steps, "100 steps"};
}

void print(const Run& run) {
    std::printf("step         E         |g|    ratio  ratio/|g|  negative         g.d   length  Hessian\n");
    double before = INFINITY;
    for (int k = 0; const Step& s : run.steps) {
        std::printf("%4d %9.6f %11.3e %8.4f %10.4g", k++, s.energy, s.size, s.size / before, s.size / before / before);
        if (s.slope != 0) std::printf(" %9d %11.2e %8.4g  %s", s.negative, s.slope, s.t, s.full ? "full" : "projected");
        std::printf("\n");
        before = s.size;
    }
    std::printf("%s\n", run.end);
}

void summarise(const char* method, const Run& run) {
    int taken = 0, cut = 0, indefinite = 0;
    for (const Step& s : run.steps) {
        taken += s.t > 0;
        cut += s.t > 0 && s.t < 1;
        indefinite += s.negative > 0;
    }
    std::printf("%-10s %16s %6d %5d %11d\n", method, run.end, taken, cut, indefinite);
}

void write(const Run& run, const std::string& path) {
    std::FILE* const csv = std::fopen(path.c_str(), "w");
    std::fprintf(csv, "step,gradient\n");
    for (int k = 0; const Step& s : run.steps) std::fprintf(csv, "%d,%.6g\n", k++, s.size);
    std::fclose(csv);
}

// Minimises x^2 from 1 with directions that go nearly twice as far as they should, d = -(2 - 2^{-k-1}) x: |x| after 5,
// 10, ... steps, where a step is taken if it lowers x^2 by c1 t |slope| or more.
void compare_decrease() {
    std::printf("steps   any decrease       c1 = 1e-4\n");
    double x[2] = {1, 1};
    for (int k = 1; k <= 20; ++k) {
        for (const int method : {0, 1}) {
            double& now = x[method];
            const double c1 = method == 0 ? 0 : 1e-4, d = -(2 - std::exp2(-k - 1)) * now, slope = 2 * now * d;
            double t = 1;
            while (!((now + t * d) * (now + t * d) <= now * now + c1 * t * slope)) t /= 2;
            now += t * d;
        }
        if (k % 5 == 0) std::printf("%5d %14.6f %15.3e\n", k, std::abs(x[0]), std::abs(x[1]));
    }
}

}  // namespace

int main(int count, char** argument) {
    DistortionParams params = {.objective = Objective::squared};
    std::string method, problem;
    for (int i = 1; i < count; ++i) {
        const std::string word = argument[i];
        if (word == "deviation") params.objective = Objective::deviation;
        else if (word == "bent") bent = true;
        else if (std::isdigit(static_cast<unsigned char>(word[0]))) angle = std::stod(word);
        else method = word;
        if (word != method) problem += "-" + word;
    }
    if (method == "decrease") return compare_decrease(), 0;
    if (!std::set<std::string>{"", "pure", "search", "projected", "switching"}.contains(method))
        return std::fprintf(stderr,
                            "no method '%s': decrease, pure, search, projected or switching\n", method.c_str()), 2;
    const std::set<int> fixed(mesh.faces.begin(), mesh.faces.end());
    for (int i = 0; i < 2 * mesh.nodes(); ++i)
        if (!fixed.contains(i / 2)) interior.push_back(i);
    PlainEnergy E(mesh, mesh.x, params);
    const std::string folder = "outputs/lessons/04-newton/";
    std::filesystem::create_directories(folder);
    write_vtk(folder + "start" + problem + ".vtk",
              {"square", 2, 1, swirled(mesh, angle, bent), mesh.elements, 2, {}, {}, {}});
    if (method.empty()) std::printf("method                  end  steps   cut  indefinite\n");
    for (const char* const each : {"pure", "search", "projected", "switching"}) {
        if (!method.empty() && method != each) continue;
        const Run run = newton(E, each);
        method.empty() ? summarise(each, run) : print(run);
        write(run, folder + each + problem + ".csv");
    }
}
