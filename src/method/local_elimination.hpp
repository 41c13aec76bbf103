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
#pragma once
#include <memory>
#include <vector>

#include "energy/options.hpp"
#include "linalg/block_csr.hpp"

namespace almesh {

struct AugmentedFunctional;
class ConstraintPart;
class DistortionEnergy;

// The augmented Lagrangian functional (functional.hpp) as a function of the positions of some nodes, all others held
// where they are: what remains of it are the elements around these nodes, so that energy, derivatives and linear
// systems cost as much as on a mesh of that size. Vectors and matrices here have the nodes that move, and no others, in
// an order of their own.
class LocalFunctional {
public:
    // x: node_count x dim, a valid mesh. moves: per node, not all zero.
    LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x, const std::vector<char>& moves);
    ~LocalFunctional();

    std::vector<double> start() const;  // positions in x: moving nodes x dim
    void write(const std::vector<double>& y, std::vector<double>& x) const;  // into the positions of the mesh

    double energy(const std::vector<double>& y);  // E up to a constant; infinite for inverted elements
    double valid_fraction(const std::vector<double>& y, const std::vector<double>& to);
    bool refine_quadrature() const;
    const DistortionEnergy& distortion() const { return *distortion_; }
    void gradient(const std::vector<double>& y, std::vector<double>& g);
    BlockCsr hessian_pattern() const;
    void hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H);

private:
    int dim_, moving_ = 0;   // moving_: nodes, the first of node_
    std::vector<int> node_;  // of all elements around them: here -> mesh
    std::unique_ptr<DistortionEnergy> distortion_;
    std::unique_ptr<ConstraintPart> constraint_;
    std::vector<double> start_, at_, to_, g_;  // of all of node_
    BlockCsr H_;

    const std::vector<double>& with_held(const std::vector<double>& y, std::vector<double>& all) const;
};

class LocalElimination {
public:
    struct Result {
        int nodes = 0;  // that were free to move
        int steps = 0;  // of the local minimisation
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
