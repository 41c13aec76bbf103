// Local nonlinear elimination: between two Newton steps, a minimisation over the few nodes that limit the steps.
//
// Small elements of little weight (the integral of eta^2, alpha = 1) fold and buckle in a few regions, and most of the
// decrease that a Newton step predicts is at a hundredth of the nodes: the elements there limit every step length, make
// the full Hessian indefinite, and converge hundreds of steps after the rest. Minimising over these nodes first, with
// all others fixed, leaves the smooth part to the Newton step (Lanzkron, Rose, Wilkes, SIAM J. Sci. Comput. 17, 1996;
// Cai & Li, SIAM J. Sci. Comput. 33, 2011). A local step costs the share of the mesh that it covers: a hundredth of the
// nodes with their neighbours can be a third of the mesh.
//
// Which nodes: those with the largest decrease that they could reach alone by a quadratic model with the diagonal of
// the Hessian, |g_i|^2 / (2 h_i), h_i = trace of H_ii / dim, until they make up nine tenths of the sum over all nodes
// or a hundredth of the nodes; with two layers of neighbours, so that they have room to move.
//
// When: after each step of a subproblem from the thirteenth on, and after each step of later subproblems once one took
// more than ten. A start from a coarser mesh or a lower degree leaves little but such regions to solve: then also after
// each step that gained less than ten times the decrease that all nodes could reach alone. No local minimisation starts
// while their work exceeds a sixth of that of the steps over the whole mesh; if each step is expensive (curved
// elements, or from a coarser mesh in 3D), the one that reaches a quarter ends there. So they take less than a fifth of
// the time; more of them would save steps, but little time.
//
// How: Newton's method (newton.hpp) for the local functional, without damping, with as many of the Hessian's negative
// eigenvalues as the assembled matrix allows (step_control.hpp). The steps of a local minimisation are in turn
// limited by few of its nodes: if a local step gained less than ten times what its nodes could reach alone, a
// minimisation over at most a tenth of them follows, chosen in the same way. That takes a sixth of the time of the
// local steps, and halves their number. It is left out if the nodes are few from the beginning.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

struct Functional;

struct LocalElimination {
    enum class Of { mesh, few_nodes, nothing };  // few_nodes: in a local minimisation; nothing: there is none
    Of of = Of::mesh;
    bool from_coarser = false;  // whether x was interpolated from the solution of a coarser mesh or of a lower degree
    bool was_hard = false, is_hard = false;  // an earlier subproblem, and any so far: took more than ten steps
    // Of assembly and linear solves, in passes of an iterative solver over an entry of a matrix: over the whole mesh,
    // and of all local minimisations.
    double work_of_newton = 0, work = 0;

    struct Result {
        int nodes = 0;  // that were free to move
        int steps = 0;  // of the local minimisation, not of those inside it
        double work = 0;
    };

    // Whether step `iteration` (1, 2, ...) of a subproblem is followed by one; H, g, gained: as for eliminate().
    bool is_due(int iteration, const BlockCsr& H, const std::vector<double>& g, double gained);
    // Whether nodes could alone reach more than a tenth of what the step gained.
    static bool holds_up(const BlockCsr& H, const std::vector<double>& g, double gained);

    // x, energy: a valid mesh and E(x), on return not greater. g: grad E(x). H: a Hessian of E near x; only its
    // diagonal and its pattern count. gained: decrease of E by the Newton step before.
    Result eliminate(const Functional& E, const BlockCsr& H, const std::vector<double>& g, double gained,
                     std::vector<double>& x, double& energy);
};

}  // namespace almesh
