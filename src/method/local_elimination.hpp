// Local nonlinear elimination: between two steps of Newton's method, a minimisation over the few nodes that hold it up.
//
// Where small elements weigh little (the integral of eta^2, alpha = 1) they fold and buckle in a few places, and most
// of what a Newton step promises is at a hundredth of the nodes: their elements limit the length of every step, make
// the full Hessian indefinite, and converge hundreds of steps after the rest. Minimising over these nodes first, all
// others held, leaves to a Newton step what is smooth (Lanzkron, Rose, Wilkes, SIAM J. Sci. Comput. 17, 1996; Cai &
// Li, SIAM J. Sci. Comput. 33, 2011). A local step costs its share of the mesh: with their neighbours a hundredth of
// the nodes can be a third of it.
//
// Which nodes: those with the largest decrease that they could reach alone by a quadratic model with the diagonal of
// the Hessian, |g_i|^2 / (2 h_i), h_i = trace of H_ii / dim, until they make up nine tenths of the sum over all nodes
// or a hundredth of the nodes; with two layers of neighbours, so that they have room to move.
//
// When: after the eleventh step of a subproblem and all steps from there on, in later subproblems too. A minimisation
// that starts from the solution of a coarser mesh or of a lower degree has little but such places left to solve: there
// also after every earlier step that gained less than ten times what all nodes could reach alone.
//
// How: Newton's method with a Hessian that keeps as much of its negative eigenvalues as it bears (negative_part.hpp).
// What holds up the mesh is in turn held up by few of its nodes: where a local step gained less than ten times what its
// nodes could reach alone, the next one follows a minimisation over at most a tenth of them, chosen in the same way.
// That is a sixth of the local steps' time, and halves their number. Not where the nodes are few from the beginning.
#pragma once
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

struct AugmentedFunctional;

class LocalElimination {
public:
    struct Result {
        int nodes = 0;  // that were free to move
        int steps = 0;  // of the local minimisation, not of those inside it
    };

    void reset() { active_ = false; }  // before a problem that knows nothing of earlier ones

    bool is_active() const { return active_; }
    void set_active(bool active) { active_ = active; }

    // Whether x was interpolated from the solution of a coarser mesh or of a lower degree.
    void set_from_coarser(bool from_coarser) { from_coarser_ = from_coarser; }

    // Whether step `iteration` (1, 2, ...) of a subproblem is followed by one; H, g, gained: as for eliminate().
    bool is_due(int iteration, const BlockCsr& H, const std::vector<double>& g, double gained) {
        active_ = active_ || iteration > steps_without;
        return active_ || (from_coarser_ && holds_up(H, g, gained));
    }
    // Whether nodes could alone reach more than a tenth of what the step gained.
    static bool holds_up(const BlockCsr& H, const std::vector<double>& g, double gained);

    // x, energy: a valid mesh and E(x), on return not greater. g: grad E(x). H: a Hessian of E near x; only its
    // diagonal and its pattern count. gained: decrease of E by the Newton step before.
    Result eliminate(const AugmentedFunctional& E, const BlockCsr& H, const std::vector<double>& g, double gained,
                     std::vector<double>& x, double& energy) const;

private:
    static constexpr int steps_without = 10;
    bool active_ = false, from_coarser_ = false;
};

}  // namespace almesh
