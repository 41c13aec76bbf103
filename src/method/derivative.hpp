// Derivatives of the moved mesh: how its nodes x depend on where the boundary is to go.
//
// The mesh is a stationary point of the Lagrangian with the boundary on its target, not of the penalty's functional: no
// mu, and no tolerance of Algorithm 1, is in
//
//     L(x, f) = E(x) + sum_i f_i . r_i(x_i),   grad L = 0,   r = 0,
//
// where r_i = x_i - g_i at a boundary node that has a target g_i (with a target beyond the trace space its projection,
// at which snap.hpp sets the nodes), and the sum of its distance vectors from its surfaces where it slides
// (sliding_boundary.hpp). With D_i = dr_i/dx_i let P_i project onto the directions in which node i is free, D P = 0:
// none where it has a target, the tangents of its surface where it slides, all inside. Then P grad E = 0, D f = -grad
// E, and a change of the boundary moves the nodes by
//
//     dx = G + P y,   P (H + K) P y = -P (H G + q),   H = E''(x),   K_i = f_i . r_i''(x_i),
//
// D G = -dr and q = K G + d(D'f), d at fixed x and f. K is what the curvature of the surfaces adds. Where the target of
// a node, or its surface as it is, is shifted by dg_i, G = dg and q = 0. The derivative of a function J(x) is
//
//     dJ = (dJ/dx + H P p) . G + P p . q,   P (H + K) P p = -P dJ/dx,
//
// so one solve gives dJ/dg = dJ/dx + H P p at all boundary nodes (implicit function theorem; sensitivity of constrained
// minimisers: Nocedal & Wright, sec. 12.8; adjoints: Giles & Pierce, Flow Turbul. Combust. 65, 2000). E is the
// functional that the last minimisation had: with objective = minimax of its last power, the scale of eta held.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "constraint/constraint.hpp"
#include "energy/distortion_energy.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/linear_solver.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// To first order, nodes x dim each, zero inside: G and q, or, of a function, its derivatives by them.
struct BoundaryChange {
    std::vector<double> shift, force;
};

class Derivative {
public:
    Derivative(const Mesh& mesh, DistortionEnergy& energy, const Constraint& constraint,
               const LinearSolverParams& linear);

    // Sets the boundary of x, the result of a run, to its target, makes x stationary to rounding by Newton's method,
    // and factors P (H + K) P there: by Cholesky, unless the parameters say otherwise or it does not fit the memory.
    // Returns why x has no derivative, as a sentence; "" where it has.
    std::string settle(std::vector<double>& x);

    std::vector<double> tangent(const BoundaryChange& change);          // dx
    BoundaryChange adjoint(const std::vector<double>& dJ_dx);  // dJ/dG, dJ/dq
    std::string failure() const { return failure_; }  // of the solves since settle(); "" where there was none

    // r and D'f of the boundary's nodes at x, with f as it is, for another constraint on them; and the change of the
    // boundary that has these derivatives.
    BoundaryChange residual(const Constraint& other) const;
    BoundaryChange change(const BoundaryChange& of_residual) const;

private:
    // Of one of the constraint's nodes.
    struct Node {
        Mat<3> P, D_inverse, K;  // D_inverse: of D where it is not zero
        Vec<3> f;
    };

    const Mesh& mesh_;
    DistortionEnergy& energy_;
    const Constraint& constraint_;
    LinearSolverParams linear_;
    std::vector<int> trace_;   // per node: its number among the constraint's, or -1
    std::vector<Node> nodes_;  // of the constraint
    std::vector<double> x_;
    BlockCsr H_, A_;           // A = P (H + K) P, and on the rest of each diagonal block a multiple of 1
    std::unique_ptr<Cholesky> cholesky_;
    std::unique_ptr<LinearSolver> iterative_;
    std::string failure_;

    std::vector<double> set_point(const std::vector<double>& x);  // returns P grad E
    void assemble();
    std::string factor();
    std::vector<double> solve(const std::vector<double>& b);
    void project(std::vector<double>& v) const;  // P v
    std::vector<double> times_hessian(const std::vector<double>& v) const;
    double largest_strain(const std::vector<double>& d) const;
};

}  // namespace almesh
