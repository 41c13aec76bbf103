// The distortion part of the functional (paper, Eqs. 5 and 6): the integral over the ideal mesh
//
//     sum over elements e of  w_e * integral over e of f(eta(D phi(y))) dy,   f = eta^2 or (eta - 1)^2,
//
// with gradient and Hessian with respect to the node positions x of phi = sum x_i N_i. The ideal elements are
// straight-sided, so D phi = J A^{-1} with the constant Jacobian A of the ideal element and J = sum x_i (grad N_i)^T.
// Weights w_e = |e|^(alpha-1), scaled so that sum w_e |e| = |Omega|: alpha = 1 is the paper, smaller alpha protects
// small elements.
//
// Cost per quadrature point and element with m nodes: O(m n^2) for the energy, O(m^2 n^4) for the Hessian.
// Elements that share a node have different colours; a colour is assembled in parallel, the colours in order: every
// entry is summed in the same order whatever the number of threads.
#pragma once
#include <vector>

#include "functional/distortion.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

struct DistortionParams {
    Objective objective = Objective::deviation;
    double delta = 0;            // Eq. 3
    double weight_exponent = 1;  // alpha
    int exactness = 0;           // of the quadrature; 0: default_exactness(degree)
};

// One point for constant F (p = 1). For p > 1 more than |F|^2 (degree 2 p - 2) needs: with 2 p + 2 the relative quality
// has six digits of what more points give, and below it the worst elements suffer. For p > 1 a thousandth of the weight
// goes to the element's nodes: see add_node_points().
int default_exactness(int degree);

enum class HessianKind {
    full,              // second derivative of the objective
    projected,         // its positive semidefinite part, point by point
    squared_projected  // positive semidefinite part for f = eta^2: the Hessian of Eq. 5 vanishes at the identity
};

// Of eta itself, without regularisation: infinite for inverted elements.
struct DistortionStatistics {
    double relative_quality = 0;      // q = |1| / |M phi|, norms over the ideal mesh
    double max_distortion = 0;        // over quadrature points and element nodes
    std::vector<double> element_max;  // per element
};

class DistortionEnergy {
   public:
    // ideal: node_count x dim positions of the ideal mesh, whose elements must have positive volume.
    DistortionEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params);

    // Infinite as soon as one quadrature point has infinite distortion.
    double energy(const std::vector<double>& x) const;
    // Adds to g (node_count x dim); x must have finite energy.
    void add_gradient(const std::vector<double>& x, std::vector<double>& g) const;
    BlockCsr hessian_pattern() const;  // all values zero
    // Adds to H, which has the pattern above.
    void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H) const;

    DistortionStatistics statistics(const std::vector<double>& x) const;
    double domain_volume() const { return volume_; }

   private:
    template <int n>
    struct Kernel;

    int dim_, element_nodes_, element_count_;
    DistortionParams params_;
    Quadrature quadrature_;
    std::vector<int> elements_;
    std::vector<double> gradients_;       // quadrature points x element nodes x dim, reference derivatives of N
    std::vector<double> node_gradients_;  // the same at the element's nodes, for the statistics
    std::vector<double> ideal_inverse_;   // element x dim x dim, A^{-1}
    std::vector<double> ideal_jacobian_;  // element, det A
    std::vector<double> weight_;          // element, w_e det A
    std::vector<int> colour_start_, coloured_;  // elements by colour
    double volume_ = 0;
    bool is_large_;  // worth more than one thread
    mutable std::vector<double> element_value_;  // element, energies before they are summed
    BlockCsr pattern_;        // without values
    std::vector<int> place_;  // element x node x node: block of the pattern
};

}  // namespace almesh
