// What lesson 12 minimises, and how: the circle of section 4.1 with its boundary moved by 8 at once, the mesh between
// it blended, which is valid; and Newton's method over the inner nodes for the integral of any density f(eta), as
// lessons 3 and 4 made it. A density is a struct as energy/densities.hpp describes it; double is the only T that it
// needs here.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "energy/densities.hpp"
#include "io/mesh_format.hpp"
#include "linalg/linear_solver.hpp"
#include "mesh/build.hpp"

namespace almesh::lessons {

struct MovedCircle {
    Mesh mesh;
    std::vector<double> start;
    std::vector<char> fixed;  // nodes
    std::vector<Mat<2>> ideal_inverse;
    std::vector<double> area;

    MovedCircle() {
        std::vector<std::string> notes;
        mesh = build_mesh(read_mesh("inputs/meshes/circle.msh"), notes);
        start = mesh.x;
        fixed.resize(mesh.nodes());
        for (const int node : mesh.faces) fixed[node] = 1;
        for (int i = 0; i < mesh.nodes(); ++i)  // 8 at r = 1, 0 at r = 21
            start[2 * i] += 8 * (21 - std::hypot(mesh.x[2 * i], mesh.x[2 * i + 1])) / 20;
        for (int e = 0; e < mesh.element_count(); ++e) {
            const Mat<2> A = straight_jacobian<2>(mesh.element(e), mesh.x);
            ideal_inverse.push_back(inverse<2>(A));
            area.push_back(0.5 * determinant(A));
        }
    }
    Mat<2> F(int e, const std::vector<double>& x) const {
        return multiply<2>(straight_jacobian<2>(mesh.element(e), x), ideal_inverse[e]);
    }
    double eta(int e, const std::vector<double>& x) const { return distortion<2>(F(e, x), 0.0); }
    Vec<2> shape_gradient(int e, int v) const {  // of N_v on the ideal element: -(rows 1 + 2), row 1, row 2 of A^{-1}
        const Mat<2>& B = ideal_inverse[e];
        return v ? Vec<2>{B[v - 1][0], B[v - 1][1]} : Vec<2>{-B[0][0] - B[1][0], -B[0][1] - B[1][1]};
    }
};

template <class Density>
double energy(const MovedCircle& problem, const std::vector<double>& x, Density density) {
    double sum = 0;
    for (int e = 0; e < problem.mesh.element_count() && std::isfinite(sum); ++e)
        if (const double eta = problem.eta(e, x); std::isfinite(eta)) sum += problem.area[e] * density.f(eta);
        else sum = INFINITY;
    return sum;
}

// d2f/dF_ij dF_kl: entry (2 i + j, 2 k + l). See plain_energy.hpp.
template <class Density>
std::array<double, 16> second_derivative(const Mat<2>& F, Density density) {
    const Mat<2> C = cofactor(F);
    const double S = frobenius_squared<2>(F);
    const auto [r, r1, r2] = Shape().derivatives<2>(determinant(F), 0);
    std::array<double, 16> H;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            const int i = a / 2, j = a % 2, k = b / 2, l = b % 2;
            const double eta_a = 2 * r * F[i][j] + S * r1 * C[i][j], eta_b = 2 * r * F[k][l] + S * r1 * C[k][l];
            const double eta_ab = (a == b ? 2 * r : 0) + 2 * r1 * (F[i][j] * C[k][l] + C[i][j] * F[k][l]) +
                                  S * (r2 * C[i][j] * C[k][l] + r1 * (k - i) * (l - j));
            H[4 * a + b] = density.f2(S * r) * eta_a * eta_b + density.f1(S * r) * eta_ab;
        }
    return H;
}

template <class Density>
void assemble(const MovedCircle& problem, const std::vector<double>& x, Density density, std::vector<double>& g,
              BlockCsr& H) {
    std::fill(g.begin(), g.end(), 0.0);
    std::fill(H.value.begin(), H.value.end(), 0.0);
    for (int e = 0; e < problem.mesh.element_count(); ++e) {
        const Mat<2> F = problem.F(e, x), P = density_gradient<2>(F, 0.0, density);
        const std::array<double, 16> A = second_derivative(F, density);
        for (int v = 0; v < 3; ++v) {
            const int i = problem.mesh.element(e)[v];
            const Vec<2> a = problem.shape_gradient(e, v);
            if (problem.fixed[i]) continue;
            for (int c = 0; c < 2; ++c) g[2 * i + c] += problem.area[e] * (P[c][0] * a[0] + P[c][1] * a[1]);
            for (int w = 0; w < 3; ++w) {
                const int j = problem.mesh.element(e)[w];
                const Vec<2> b = problem.shape_gradient(e, w);
                if (problem.fixed[j]) continue;
                double* const block = H.block(H.find(i, j));
                for (int t = 0; t < 16; ++t)  // component c of node i, d of node j, derivatives k and l
                    block[t / 8 * 2 + t / 2 % 2] += problem.area[e] * A[t] * a[t / 4 % 2] * b[t % 2];
            }
        }
    }
    for (int i = 0; i < H.n; ++i)
        if (problem.fixed[i]) H.block(H.find(i, i))[0] = H.block(H.find(i, i))[3] = 1;
}

struct Minimum {
    std::vector<double> x;
    int steps = 0;
    bool converged = false;
};

// Newton's method with a backtracking line search. An infinite energy at the start, as of a barrier that the mesh has
// crossed already, ends it before the first step.
template <class Density>
Minimum minimise(const MovedCircle& problem, Density density, int most_steps = 200) {
    Minimum result{problem.start};
    std::vector<double>& x = result.x;
    std::vector<double> g(x.size()), d;
    BlockCsr H = matrix_of_cells(problem.mesh.nodes(), 2, problem.mesh.elements, 3);
    LinearSolver solver(2, {});
    double E = energy(problem, x, density);
    for (; std::isfinite(E) && result.steps < most_steps; ++result.steps) {
        assemble(problem, x, density, g, H);
        // Where H is not positive definite, a heavier diagonal (Nocedal & Wright, algorithm 3.3).
        bool solved = false;
        for (double heavier = 0.01; heavier < 1e6 && !solved; heavier *= 2) {
            solved = solver.solve(H, g, d).status == SolveStatus::success;
            for (int i = 0; i < H.n && !solved; ++i)
                for (const int c : {0, 3}) H.block(H.find(i, i))[c] *= 1 + heavier;
        }
        if (!solved) return result;
        double slope = 0, t = 1, E_next = 0;
        for (std::size_t i = 0; i < x.size(); ++i) slope -= g[i] * d[i];
        if (-slope < 1e-12 * E) return result.converged = true, result;  // twice what is left to gain, nearly
        const std::vector<double> from = x;
        for (;; t /= 2) {
            for (std::size_t i = 0; i < x.size(); ++i) x[i] = from[i] - t * d[i];
            E_next = energy(problem, x, density);
            if (E_next <= E + 1e-4 * t * slope) break;
            if (t < 1e-10) return result.x = from, result;
        }
        E = E_next;
    }
    return result;
}

}  // namespace almesh::lessons
