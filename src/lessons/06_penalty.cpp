// Lesson 6: the constraint by a penalty alone,
//
//     minimise E(x) = |M phi|^2 + mu/2 |c|^2   over the positions x of all nodes,
//
// for one mu after the other, each from the ideal mesh: how well the boundary is on its target, how many Newton steps
// it takes, and how badly conditioned the Hessian is. The inner circle of the ring is moved by 8.
//
//   06_penalty [mu ...]     in units of |1|^2
//   06_penalty curved       a curved constraint instead: two unknowns on a circle
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "lessons/circle.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"
#include "method/newton.hpp"

using namespace almesh;
using namespace almesh::lessons;

namespace {

Vector start_vector(int size) {
    Vector v(size);
    for (int i = 0; i < size; ++i) v[i] = std::sin(1.0 + i);
    return v;
}

// The largest eigenvalue, by the power method: v <- A v / |A v|.
template <class Product>
double largest_eigenvalue(int size, int steps, const Product& product) {
    Vector v = start_vector(size), Av(size);
    double length = 0;
    for (int k = 0; k < steps; ++k) {
        scale(size, 1 / norm_2(v), v.data());
        product(v, Av);
        length = norm_2(Av);
        v = Av;
    }
    return length;
}

// |H| |H^{-1}|, H^{-1} v by Cholesky.
double condition(const BlockCsr& H) {
    LinearSolver cholesky(2, {.kind = SolverKind::cholesky});
    return largest_eigenvalue(H.size(), 100, [&](const Vector& v, Vector& Hv) { multiply(H, v.data(), Hv.data()); }) *
           largest_eigenvalue(H.size(), 15, [&](const Vector& v, Vector& y) { cholesky.solve(H, v, y); });
}

// Conjugate gradients without a preconditioner, to 1e-8: lesson 10 has them.
int plain_iterations(const BlockCsr& H) {
    const int n = H.size();
    Vector r = start_vector(n), p = r, Hp(n);
    double rr = dot(r, r);
    const double enough = 1e-16 * rr;
    int k = 0;
    for (; rr > enough && k < 10000; ++k) {
        multiply(H, p.data(), Hp.data());
        const double before = rr;
        axpy(-rr / dot(p, Hp), Hp, r);
        rr = dot(r, r);
        for (int i = 0; i < n; ++i) p[i] = r[i] + rr / before * p[i];
    }
    return k;
}

int preconditioned_iterations(const BlockCsr& H) {
    LinearSolver ilu0(2, {.kind = SolverKind::cg, .tolerance = 1e-8, .fallback = false});
    Vector x;
    return ilu0.solve(H, start_vector(H.size()), x).iterations;
}

struct Files {
    std::FILE *penalties, *boundary;
};

void minimise_with(const Mesh& mesh, double units, const Files& csv) {
    const auto energy = make_energy(mesh, mesh.x, {.objective = Objective::squared});
    Dirichlet constraint(mesh, mesh.x, inner_circle_by(mesh, "translate 8 0"), TargetKind::nodal);
    const double mu = units * std::pow(constraint.norm_of_one(), 2);
    const AugmentedFunctional E = {*energy, constraint, Vector(constraint.multipliers(), 0.0), mu};
    Newton newton(energy->hessian_pattern(), {});
    NewtonParams until;
    until.omega = 1e-6;
    Vector x = mesh.x;
    const NewtonResult solved = newton.minimise(E, until, x);
    BlockCsr H = energy->hessian_pattern();
    E.hessian(x, HessianKind::full, H);
    const double c = constraint.norm(x), kappa = condition(H);
    std::printf("%8.0e  %9.3e  %8.3f  %9.2e  %6d  %s\n", units, c, mu * c, kappa, solved.iterations,
                to_string(solved.status));
    std::fprintf(csv.penalties, "%g,%.6g,%.6g,%d,%d,%d\n", units, c, kappa, solved.iterations, plain_iterations(H),
                 preconditioned_iterations(H));
    for (const int i : constraint.nodes()) std::fprintf(csv.boundary, "%g,%g,%g\n", units, x[2 * i], x[2 * i + 1]);
}

// Minimises x + y + mu/2 c^2, c = x^2 + y^2 - 2, by Newton's method; the Hessian without its negative part. From the
// other side of the circle. Returns the number of steps.
int steps_on_a_circle(double mu) {
    double x = 1.4, y = 0.2;
    const auto c = [](double a, double b) { return a * a + b * b - 2; };
    const auto E = [&](double a, double b) { return a + b + mu / 2 * c(a, b) * c(a, b); };
    for (int k = 0;; ++k) {
        const double gx = 1 + 2 * mu * c(x, y) * x, gy = 1 + 2 * mu * c(x, y) * y;
        if (std::hypot(gx, gy) < 1e-6) return k;
        const double s = std::max(1.0, 2 * mu * c(x, y));  // mu c d2c, or 1 where that is less
        const double a = 4 * mu * x * x + s, b = 4 * mu * x * y, d = 4 * mu * y * y + s, det = a * d - b * b;
        const double px = (b * gy - d * gx) / det, py = (b * gx - a * gy) / det;
        double t = 1;
        while (E(x + t * px, y + t * py) > E(x, y) + 1e-4 * t * (gx * px + gy * py) && t > 1e-12) t /= 2;
        x += t * px, y += t * py;
    }
}

}  // namespace

int main(int count, char** argument) {
    if (count > 1 && std::string(argument[1]) == "curved") {
        std::printf("      mu  Newton\n");
        for (double mu = 1; mu < 2e4; mu *= 10) std::printf("%8.0e  %6d\n", mu, steps_on_a_circle(mu));
        return 0;
    }
    std::vector<double> penalties = {0.01, 0.1, 1, 10, 100, 1e3, 1e4, 1e6, 1e8};
    if (count > 1) penalties.clear();
    for (int i = 1; i < count; ++i) penalties.push_back(std::atof(argument[i]));
    const std::string folder = "outputs/lessons/06-penalty/", extra = count > 1 ? "-extra" : "";
    std::filesystem::create_directories(folder);
    const Files csv = {std::fopen((folder + "penalties" + extra + ".csv").c_str(), "w"),
                       std::fopen((folder + "boundary" + extra + ".csv").c_str(), "w")};
    std::fprintf(csv.penalties, "mu,c,condition,newton,plain,ilu0\n");
    std::fprintf(csv.boundary, "mu,x,y\n");
    std::printf("mu/|1|^2        |c|    mu |c|  condition  Newton\n");
    const Mesh mesh = ring();
    for (const double units : penalties) minimise_with(mesh, units, csv);
    std::fclose(csv.penalties);
    std::fclose(csv.boundary);
}
