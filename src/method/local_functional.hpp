// The augmented Lagrangian functional (functional.hpp) as a function of the positions of some nodes, all others held
// where they are: what remains of it are the elements around these nodes, so that energy, derivatives and linear systems
// cost as much as on a mesh of that size.
//
// Nodes are numbered anew: those of all elements that have a moving node. Positions of held ones among them take part
// in the vectors here, with a zero in the gradient and a unit block in the Hessian.
#pragma once
#include <memory>
#include <vector>

#include "method/functional.hpp"

namespace almesh {

class LocalFunctional {
public:
    // x: node_count x dim, a valid mesh. moves: per node, not all zero.
    LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x, const std::vector<char>& moves);

    const std::vector<double>& start() const { return start_; }  // positions in x: nodes here x dim
    void write(const std::vector<double>& y, std::vector<double>& x) const;  // moved positions into those of the mesh

    double energy(const std::vector<double>& y) const;  // E up to a constant; infinite for inverted elements
    void gradient(const std::vector<double>& y, std::vector<double>& g) const;
    BlockCsr hessian_pattern() const { return distortion_->hessian_pattern(); }
    void hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H) const;

private:
    int dim_;
    std::vector<int> node_;  // here -> mesh
    std::unique_ptr<DistortionEnergy> distortion_;
    std::unique_ptr<ConstraintPart> constraint_;
    std::vector<char> moves_;
    std::vector<double> start_;
};

}  // namespace almesh
