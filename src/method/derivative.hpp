// Derivatives of the moved mesh: how its nodes x depend on where the boundary is to go.
//
// With the boundary exactly on its target, the mesh is a stationary point of the Lagrangian, which, unlike the
// augmented one, contains neither mu nor a tolerance of Algorithm 1:
//
//     L(x, f) = E(x) + sum_i f_i . r_i(x_i),   grad L = 0,   r = 0,
//
// where r_i = x_i - g_i at a boundary node that has a target g_i (with a target beyond the trace space its projection,
// at which polish.hpp sets the nodes), and the sum of its distance vectors from its surfaces where it slides
// (sliding_boundary.hpp). With P, D, f and K as polish.hpp has them a change of the boundary moves the nodes by
//
//     dx = G + P y,   P (H + K) P y = -P (H G + q),   H = E''(x),
//
// D G = -dr and q = K G + d(D'f), d at fixed x and f. Where the target of a node, or its surface as it is, is shifted
// by dg_i, G = dg and q = 0. The derivative of a function J(x) is
//
//     dJ = (dJ/dx + H P p) . G + P p . q,   P (H + K) P p = -P dJ/dx,
//
// so one solve gives dJ/dg = dJ/dx + H P p at all boundary nodes (implicit function theorem; sensitivity of constrained
// minimisers: Nocedal & Wright, sec. 12.8; adjoints: Giles & Pierce, Flow Turbul. Combust. 65, 2000). E is the
// functional that the last minimisation had. With objective = minimax that is the one of its last power, and
// H = E'' - u v' (p_norm.hpp); in the adjoint its transpose.
#pragma once
#include <memory>
#include <vector>

#include "base/error.hpp"
#include "constraint/constraint.hpp"
#include "energy/distortion_energy.hpp"
#include "linalg/linear_solver.hpp"
#include "mesh/mesh.hpp"
#include "method/p_norm.hpp"
#include "method/polish.hpp"

namespace almesh {

// To first order, nodes x dim each, zero inside: G and q, or, of a function, its derivatives by them.
struct BoundaryChange {
    std::vector<double> shift, force;
};

class Derivative {
public:
    Derivative(const Mesh& mesh, DistortionEnergy& energy, Constraint& constraint, const LinearSolverParams& linear);

    // Takes x, the result of a run, to where it is stationary to rounding, with the boundary on its target.
    void polish(std::vector<double>& x);

    // There: dx; dJ/dG and dJ/dq. With the factor of P (H + K) P, by Cholesky unless `linear` says otherwise or it does
    // not fit the memory. As polish() they throw Error, which says why x has no derivative.
    std::vector<double> tangent(const BoundaryChange& change);
    BoundaryChange adjoint(std::vector<double> dJ_dx);

    // r and D'f of the boundary nodes at x under another constraint, with the same f; and the change of the boundary
    // with such a residual.
    BoundaryChange residual(const Constraint& other) const;
    BoundaryChange change(BoundaryChange of_residual) const;

private:
    const Mesh& mesh_;
    DistortionEnergy& energy_;
    OnTarget on_target_;
    const LinearSolverParams given_;
    LinearSolverParams linear_ = given_;
    std::vector<double> x_;
    BlockCsr H_, A_;          // H + u v'; A = P (H_ + K) P, and on the rest of each diagonal block a multiple of 1
    std::unique_ptr<LinearSolver> solver_;
    bool is_factored_ = false;  // A, at x
    KappaChange kappa_;         // at x

    std::vector<double> set_point(const std::vector<double>& x);  // returns -P grad E
    void assemble(HessianKind kind);
    Error not_stationary(double decrement);  // why the decrement is not small enough
    Error singular(int bad_node);            // why A is not positive definite
    // P (A - P u v' P)^-1 b, by the formula of Sherman and Morrison.
    std::vector<double> solve(const std::vector<double>& b, std::vector<double> u, const std::vector<double>& v);
    std::vector<double> solve_with_A(const std::vector<double>& b);  // P A^-1 b
};

}  // namespace almesh
