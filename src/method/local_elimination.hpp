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
// When: from the eleventh step of a subproblem on, and in all subproblems after it.
#pragma once
#include <memory>
#include <vector>

#include "energy/options.hpp"

namespace almesh {

struct AugmentedFunctional;
struct BlockCsr;
class ConstraintPart;
class DistortionEnergy;

// The augmented Lagrangian functional (functional.hpp) as a function of the positions of some nodes, all others held
// where they are: what remains of it are the elements around these nodes, so that energy, derivatives and linear
// systems cost as much as on a mesh of that size.
//
// Nodes are numbered anew: those of all elements that have a moving node. Positions of held ones among them take part
// in the vectors here, with a zero in the gradient and a unit block in the Hessian.
class LocalFunctional {
public:
    // x: node_count x dim, a valid mesh. moves: per node, not all zero.
    LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x, const std::vector<char>& moves);
    ~LocalFunctional();

    const std::vector<double>& start() const { return start_; }  // positions in x: nodes here x dim
    void write(const std::vector<double>& y, std::vector<double>& x) const;  // moved positions into those of the mesh

    double energy(const std::vector<double>& y) const;  // E up to a constant; infinite for inverted elements
    double valid_fraction(const std::vector<double>& y, const std::vector<double>& to) const;
    bool refine_quadrature() const;
    const DistortionEnergy& distortion() const { return *distortion_; }
    void gradient(const std::vector<double>& y, std::vector<double>& g) const;
    BlockCsr hessian_pattern() const;
    void hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H) const;

private:
    int dim_;
    std::vector<int> node_;  // here -> mesh
    std::unique_ptr<DistortionEnergy> distortion_;
    std::unique_ptr<ConstraintPart> constraint_;
    std::vector<char> held_;
    std::vector<double> start_;
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

    // Whether step `iteration` (1, 2, ...) of a subproblem is followed by one.
    bool after_step(int iteration) {
        active_ = active_ || iteration > steps_without;
        return active_;
    }

    // x, energy: a valid mesh and E(x), on return not greater. g: grad E(x). H: a Hessian of E near x; only its
    // diagonal and its pattern count. gained: decrease of E by the Newton step before.
    Result eliminate(const AugmentedFunctional& E, const BlockCsr& H, const std::vector<double>& g, double gained,
                     std::vector<double>& x, double& energy) const;

private:
    static constexpr int steps_without = 10;
    bool active_ = false;
};

}  // namespace almesh
