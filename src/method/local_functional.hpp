// A functional (functional.hpp) as a function of the positions of some nodes, all others fixed where they are: what
// remains of it are the elements around these nodes, so that energy, derivatives and linear systems cost as much as on
// a mesh of that size. Vectors and matrices here have the nodes that move, and no others, in an order of their own.
#pragma once
#include <memory>
#include <vector>

#include "linalg/block_csr.hpp"
#include "method/functional.hpp"

namespace almesh {

// The elements with a node that moves.
struct ElementsAround {
    std::vector<int> node_;  // of them, those that move first: here -> mesh
    std::unique_ptr<DistortionEnergy> elements_;

    ElementsAround(const DistortionEnergy& mesh, const std::vector<double>& x, const std::vector<char>& moves)
        : elements_(mesh.part(x, moves, node_)) {}
};

class LocalFunctional : private ElementsAround, public Functional {
public:
    // x: node_count x dim, a valid mesh. moves: per node, not all zero.
    LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x, const std::vector<char>& moves);

    int nodes() const { return moving_; }
    // Positions of the nodes that move, from and to those of the functional that this is a part of.
    std::vector<double> read(const std::vector<double>& x) const;
    void write(const std::vector<double>& y, std::vector<double>& x) const;

    double energy(const std::vector<double>& y) const override;  // E up to a constant
    double distortion_energy(const std::vector<double>& y, double energy) const override;
    double valid_fraction(const std::vector<double>& y, const std::vector<double>& to) const override;
    void gradient(const std::vector<double>& y, std::vector<double>& g) const override;
    BlockCsr hessian_pattern() const;
    void hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H,
                 const Projection& projection = {}) const override;
    std::unique_ptr<LocalFunctional> part(const std::vector<double>& y, std::vector<char> moves) const override;

private:
    const AugmentedFunctional& E_;
    std::vector<double> x_;   // of the mesh at the start
    int dim_, moving_;        // moving_: nodes, the first of node_
    std::vector<int> place_;  // of those: here -> in the functional that this is a part of
    std::unique_ptr<ConstraintPart> constraint_;
    mutable std::vector<double> at_, to_, g_;  // of all of node_
    mutable BlockCsr H_;

    const std::vector<double>& with_fixed(const std::vector<double>& y, std::vector<double>& all) const;
};

}  // namespace almesh
