// Local nonlinear elimination: between two steps of Newton's method, a minimisation over the few nodes that hold it up.
//
// Where small elements weigh little (the integral of eta^2, alpha = 1) they fold and buckle in a few places, and most
// of what a Newton step promises is at a hundredth of the nodes: their elements limit the length of every step, make
// the full Hessian indefinite, and converge hundreds of steps after the rest. Minimising over these nodes first, all
// others fixed, leaves to a Newton step what is smooth (Lanzkron, Rose, Wilkes, SIAM J. Sci. Comput. 17, 1996; Cai &
// Li, SIAM J. Sci. Comput. 33, 2011). A local step costs its share of the mesh: with their neighbours a hundredth of
// the nodes can be a third of it.
//
// Which nodes: those with the largest decrease that they could reach alone by a quadratic model with the diagonal of
// the Hessian, |g_i|^2 / (2 h_i), h_i = trace of H_ii / dim, until they make up nine tenths of the sum over all nodes
// or a hundredth of the nodes; with two layers of neighbours, so that they have room to move.
//
// When: after every step of a subproblem from the thirteenth on, and of those that come after one of more than ten
// steps. A minimisation that starts from the solution of a coarser mesh or of a lower degree has little but such places
// left to solve: there also after every step that gained less than ten times what all nodes could reach alone. But not
// while local minimisations have done more than a sixth of the work of the steps over the whole mesh, and where each
// step is dear (curved elements, or from a coarser mesh in 3D) the one that takes them to a quarter ends there: less
// than a fifth of the time; more of them save steps, and little time.
//
// How: Newton's method (newton.hpp) for the local functional, without damping, and with a Hessian that keeps as much of
// its negative eigenvalues as it bears (eigenvalue_filtering.hpp). What holds up the mesh is in turn held up by few of
// its nodes: where a local step gained less than ten times what its nodes could reach alone, a minimisation over at
// most a tenth of them follows, chosen in the same way. That is a sixth of the local steps' time, and halves their
// number. Not where the nodes are few from the beginning.
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
