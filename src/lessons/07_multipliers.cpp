// Lesson 7: the augmented Lagrangian method in its simplest form: one penalty mu, and after every subproblem
//
//     minimise |M phi|^2 - (lambda, c) + mu/2 |c|^2   over the positions x of all nodes,
//
// an update lambda <- lambda - mu c. The inner circle of the ring is moved by 8. Then what the multipliers are: the
// forces with which the walls hold the nodes of the boundary, their balance, and the derivative of the energy with
// respect to the position of the wall.
//
//   07_multipliers [mu, in units of |1|^2] [F: lambda <- lambda - F mu c instead] [updates]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "energy/distortion_energy.hpp"
#include "lessons/circle.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"
#include "method/newton.hpp"

using namespace almesh;
using namespace almesh::lessons;

namespace {

const Mesh mesh = ring();

// The ring whose inner circle is to move by a distance to the right.
struct Problem {
    std::unique_ptr<DistortionEnergy> energy = make_energy(mesh, mesh.x, {.objective = Objective::squared});
    Dirichlet constraint;
    Vector x = mesh.x, lambda;  // lambda: two numbers for each node of the boundary

    explicit Problem(double distance)
        : constraint(mesh, mesh.x, inner_circle_by(mesh, "translate " + std::to_string(distance) + " 0"),
                     TargetKind::nodal),
          lambda(constraint.multipliers(), 0.0) {}

    // f = M lambda / |1|: minus the gradient of -(lambda, c) with respect to the nodes; zero inside.
    Vector forces() {
        Vector g(x.size(), 0.0), f(x.size(), 0.0);
        constraint.add_gradient(x, lambda, 0, g);
        axpy(-1, g, f);
        return f;
    }
};

// Minimises for a fixed lambda: lesson 4, done by the program's Newton method.
void solve_subproblem(Problem& p, Newton& newton, double mu) {
    const AugmentedFunctional E = {*p.energy, p.constraint, p.lambda, mu};
    NewtonParams until;
    until.omega = 1e-7;
    newton.minimise(E, until, p.x);
}

// The augmented Lagrangian method: `times` subproblems with one penalty.
void minimise(Problem& p, double mu, double factor, int times, bool print) {
    Newton newton(p.energy->hessian_pattern(), {});
    double before = 0;
    if (print) std::printf(" k        |c|   ratio        |M phi|^2   |lambda|\n");
    for (int k = 1; k <= times; ++k) {
        solve_subproblem(p, newton, mu);
        const Vector c = p.constraint.constraint_field(p.x);  // at the nodes of the boundary
        axpy(-factor * mu, c, p.lambda);
        const double now = p.constraint.norm(p.x);
        if (print)
            std::printf("%2d  %9.3e  %6.3f  %15.4f  %9.3f\n", k, now, k > 1 ? now / before : 1, p.energy->energy(p.x),
                        norm_2(p.lambda));
        before = now;
    }
}

struct Sums {
    double force_x = 0, force_y = 0, moment = 0, virial = 0;  // of f, x cross f, x . f
};

Sums sums(const Problem& p, const Vector& f, const char* boundary) {
    std::vector<char> on(mesh.nodes(), 0);
    for (std::size_t k = 0; k < mesh.faces.size(); ++k)
        if (mesh.boundaries[mesh.face_boundary[k / 2]] == boundary) on[mesh.faces[k]] = 1;
    Sums s;
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (!on[i]) continue;
        const double x = p.x[2 * i], y = p.x[2 * i + 1], fx = f[2 * i], fy = f[2 * i + 1];
        s.force_x += fx, s.force_y += fy, s.moment += x * fy - y * fx, s.virial += x * fx + y * fy;
    }
    return s;
}

void print_balance(const Problem& p, const Vector& f) {
    std::printf("\n             force in x  force in y      moment         x.f\n");
    for (const char* const boundary : {"inner", "outer"}) {
        const Sums s = sums(p, f, boundary);
        std::printf("%s circle %10.4f %11.4f %11.4f %11.4f\n", boundary, s.force_x, s.force_y, s.moment, s.virial);
    }
}

double smallest_energy(double distance) {
    Problem p(distance);
    minimise(p, 1000 * 40, 1, 5, false);
    return p.energy->energy(p.x);
}

// The smallest mu for which the Hessian of E is positive definite at p.x: bisection, with Cholesky as the judge.
double smallest_penalty(Problem& p) {
    LinearSolver cholesky(2, {.kind = SolverKind::cholesky});
    BlockCsr H = p.energy->hessian_pattern();
    const Vector b(p.x.size(), 1.0);
    Vector d;
    double low = 1e-3, high = 1e6;
    while (high > 1.001 * low) {
        const double mu = std::sqrt(low * high);
        AugmentedFunctional{*p.energy, p.constraint, p.lambda, mu}.hessian(p.x, HessianKind::full, H);
        (cholesky.solve(H, b, d).status == SolveStatus::not_positive_definite ? low : high) = mu;
    }
    return high;
}

// Nodes of the boundary: positions, forces of the walls, constraint.
void write_boundary(const std::string& path, Problem& p) {
    std::FILE* const file = std::fopen(path.c_str(), "w");
    const Vector f = p.forces(), c = p.constraint.constraint_field(p.x);
    std::fprintf(file, "x,y,fx,fy,cx,cy\n");
    for (std::size_t t = 0; t < p.constraint.nodes().size(); ++t) {
        const int i = p.constraint.nodes()[t];
        std::fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", p.x[2 * i], p.x[2 * i + 1], f[2 * i], f[2 * i + 1],
                     c[2 * t], c[2 * t + 1]);
    }
    std::fclose(file);
}

}  // namespace

int main(int count, char** argument) {
    Problem p(8);
    const double one_squared = std::pow(p.constraint.norm_of_one(), 2);
    const std::string in_ones = count > 1 ? argument[1] : "24";
    const double mu = std::stod(in_ones) * one_squared;
    const double factor = count > 2 ? std::atof(argument[2]) : 1;
    std::printf("|1|^2 = %g, mu = %g\n", one_squared, mu);
    minimise(p, mu, factor, count > 3 ? std::atoi(argument[3]) : 8, true);
    std::filesystem::create_directories("outputs/lessons/07-multipliers");
    if (factor == 1) write_boundary("outputs/lessons/07-multipliers/boundary-" + in_ones + ".csv", p);
    if (count > 1) return 0;
    print_balance(p, p.forces());
    const double h = 0.1, slope = (smallest_energy(8 + h) - smallest_energy(8 - h)) / (2 * h);
    std::printf("\nd |M phi|^2 / d distance, from runs with 8 + %g and 8 - %g: %.3f\n", h, h, slope);
    std::printf("E has a minimum here from mu = %.3g |1|^2 on\n", smallest_penalty(p) / one_squared);
}
