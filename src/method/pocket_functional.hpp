// The augmented Lagrangian functional (augmented_functional.hpp) as a function of the positions of some nodes, all
// others held where they are: what remains of it are the elements around these nodes, so that energy, derivatives and
// linear systems cost as much as on a mesh of that size.
//
// Nodes are numbered anew: those of all elements that have a moving node. Positions of held ones among them take part
// in the vectors here, with a zero in the gradient and a unit block in the Hessian. With u = y - x, x where the pocket
// was made, the boundary's part of E is exactly g.u + u'Cu/2, g its gradient at x and C its Hessian.
#pragma once
#include <vector>

#include "method/augmented_functional.hpp"

namespace almesh {

class PocketFunctional {
public:
    // x: node_count x dim, a valid mesh. moves: per node, not all zero.
    PocketFunctional(const AugmentedFunctional& E, const std::vector<double>& x, const std::vector<char>& moves);

    int size() const { return static_cast<int>(start_.size()); }  // of the vectors below: nodes here x dim
    const std::vector<double>& start() const { return start_; }   // positions in x
    void write(const std::vector<double>& y, std::vector<double>& x) const;  // moved positions into those of the mesh

    double energy(const std::vector<double>& y) const;  // E up to a constant; infinite for inverted elements
    void gradient(const std::vector<double>& y, std::vector<double>& g) const;
    BlockCsr hessian_pattern() const { return distortion_.hessian_pattern(); }
    void hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H) const;

private:
    int dim_;
    std::vector<int> node_;  // here -> mesh
    DistortionEnergy distortion_;
    std::vector<char> moves_;
    std::vector<double> start_, g_;  // nodes here x dim
    BlockCsr C_;
    mutable std::vector<double> u_, Cu_;

    void multiply_displacement(const std::vector<double>& y) const;
};

}  // namespace almesh
