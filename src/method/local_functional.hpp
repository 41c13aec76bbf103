// The augmented Lagrangian functional (functional.hpp) as a function of the positions of some nodes, all others fixed
// where they are: what remains of it are the elements around these nodes, so that energy, derivatives and linear
// systems cost as much as on a mesh of that size. Vectors and matrices here have the nodes that move, and no others, in
// an order of their own.
#pragma once
#include <memory>
#include <vector>

#include "energy/options.hpp"
#include "linalg/block_csr.hpp"

namespace almesh {

struct AugmentedFunctional;
class ConstraintPart;
class DistortionEnergy;

class LocalFunctional {
public:
    // x: node_count x dim, a valid mesh. moves: per node, not all zero.
    LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x, const std::vector<char>& moves);
    ~LocalFunctional();

    // Positions of the nodes that move, moving nodes x dim, from and to those of the mesh.
    std::vector<double> read(const std::vector<double>& x) const;
    void write(const std::vector<double>& y, std::vector<double>& x) const;
    int node(int i) const { return node_[i]; }  // in the mesh

    double energy(const std::vector<double>& y);  // E up to a constant; infinite for inverted elements
    double valid_fraction(const std::vector<double>& y, const std::vector<double>& to);
    bool refine_quadrature() const;
    const DistortionEnergy& distortion() const { return *distortion_; }
    void gradient(const std::vector<double>& y, std::vector<double>& g);
    BlockCsr hessian_pattern() const;
    void hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H, const Projection& projection = {});

private:
    int dim_, moving_ = 0;   // moving_: nodes, the first of node_
    std::vector<int> node_;  // of all elements around them: here -> mesh
    std::unique_ptr<DistortionEnergy> distortion_;
    std::unique_ptr<ConstraintPart> constraint_;
    std::vector<double> at_, to_, g_;  // of all of node_
    BlockCsr H_;

    const std::vector<double>& with_fixed(const std::vector<double>& y, std::vector<double>& all) const;
};

}  // namespace almesh
