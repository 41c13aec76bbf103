// The displacement of a boundary, extended into the mesh by one linear system: as a harmonic function, or as that of an
// elastic solid. With g_i = grad N_i on the mesh as it is, and the displacement of the boundary nodes given,
//
//     sum_j K_ij u_j = 0 for all nodes i inside,
//     K_ij = integral of  a (g_i . g_j) I + b g_j g_i^T + c g_i g_j^T
//
// with the numbers a, b, c of a Stiffness. Nothing here keeps an element from being inverted. Cost: one assembly and
// one linear solve:   K u = 0 inside, u = u_D at the fixed nodes;   K u_I = -K u_D with rows and columns of fixed nodes
// those of the unit matrix.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/small_matrix.hpp"
#include "linalg/linear_solver.hpp"
#include "mesh/part.hpp"
#include "mesh/quadrature.hpp"
#include "method/fixed_nodes.hpp"

namespace almesh {

struct Stiffness {
    double a = 0, b = 0, c = 0;
};

// At a point of an element whose map has the determinant `jacobian` > 0 there: n! times the volume of a straight one.
using StiffnessAt = Stiffness (*)(double jacobian);

// Of the Laplace equation for each coordinate of the displacement. The maximum principle keeps the displacement within
// that of the boundary, not the mesh valid.
inline Stiffness harmonic_stiffness(double) { return {.a = 1}; }

// Of a linear elastic solid,
//
//     integral of  2 m e(u) : e(v) + l div u div v = 0,   e(u) the symmetric gradient,
//     l = E v / ((1 + v) (1 - 2 v)),   m = E / (2 (1 + v)),   v = 0.3,
//
// whose modulus E is the reciprocal of the element's volume (of the Jacobian's determinant at a point of a curved one):
// the Jacobian-based stiffening with the exponent 1 of Stein, Tezduyar, Benney (J. Appl. Mech. 70, 2003), which leaves
// the determinant out of the integral over an element. Small elements then move almost as rigid bodies, and large ones
// take the deformation.
inline Stiffness elastic_stiffness(double jacobian) {
    constexpr double ratio = 0.3;  // v
    const double E = 1 / jacobian, l = E * ratio / ((1 + ratio) * (1 - 2 * ratio)), m = E / (2 * (1 + ratio));
    return {.a = m, .b = m, .c = l};
}

// K times a linear function, on curved elements too: an integral of cofactors of J, of degree n (p - 1); in each
// coordinate of a quadrilateral that is 2 p - 1.
inline int exactness_of(const CellType& cell, int degree) {
    return cell.is_simplex() && degree == 1 ? 0 : std::max(2 * degree, cell.dim * (degree - 1));
}

// Adds what an element has of K, on the mesh with the nodes at x.
template <int n>
void add_element(const ReferenceElement& reference, const int* node, StiffnessAt stiffness,
                 const std::vector<double>& x, BlockCsr& K) {
    const int m = reference.nodes;
    std::vector<Vec<n>> g(m);
    for (int q = 0; q < reference.points; ++q) {
        const double* const dN = &reference.gradients[offset(q, m * n)];
        Mat<n> J{};  // dx/dxi
        for (int i = 0; i < m; ++i)
            for (int r = 0; r < n; ++r)
                for (int k = 0; k < n; ++k)
                    J[r][k] += (point(x, node[i], n)[r] - point(x, node[0], n)[r]) * dN[i * n + k];
        const double jacobian = std::abs(determinant(J)), weight = reference.weight[q] * jacobian;
        const Mat<n> inverse_of_J = inverse<n>(J);
        for (int i = 0; i < m; ++i)
            for (int r = 0; r < n; ++r) {
                g[i][r] = 0;
                for (int k = 0; k < n; ++k) g[i][r] += dN[i * n + k] * inverse_of_J[k][r];
            }
        const Stiffness at = stiffness(jacobian);
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j) {
                double* const B = K.block(K.find(K.row_of(node[i]), K.row_of(node[j])));
                for (int r = 0; r < n; ++r) {
                    for (int s = 0; s < n; ++s) B[r * n + r] += weight * at.a * g[i][s] * g[j][s];
                    for (int s = 0; s < n; ++s)
                        B[r * n + s] += weight * (at.b * g[j][r] * g[i][s] + at.c * g[i][r] * g[j][s]);
                }
            }
    }
}

// u: node_count x dim, on entry the displacement of the fixed nodes, zero at all others, on return of all nodes.
// x: node_count x dim, the mesh on which K is; K: the pattern of the Hessian of the mesh's energy.
inline SolveResult extend_displacement(const Mesh& mesh, BlockCsr K, StiffnessAt stiffness,
                                       const LinearSolverParams& linear, const std::vector<double>& x,
                                       const std::vector<char>& fixed, std::vector<double>& u) {
    std::fill(K.value.begin(), K.value.end(), 0.0);
    for (const ElementGroup& group : mesh.element_groups()) {
        const Quadrature quadrature = cell_quadrature(*group.cell, exactness_of(*group.cell, mesh.degree));
        const ReferenceElement reference = reference_element(*group.cell, mesh.degree, quadrature);
        with_dimension(mesh.dim, [&](auto n) {
            for (const int e : elements_of(group)) add_element<n()>(reference, mesh.element(e), stiffness, x, K);
        });
    }
    std::vector<double> b = times_at_nodes(K, u), inside;
    for (double& value : b) value = -value;
    fix_nodes(fixed, mesh.dim, b);
    fix_nodes(fixed, K);
    const SolveResult result = LinearSolver(mesh.dim, linear).solve(K, b, inside);
    fix_nodes(fixed, mesh.dim, inside);  // to the last bit, whatever the solver
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += inside[i];
    return result;
}

}  // namespace almesh
