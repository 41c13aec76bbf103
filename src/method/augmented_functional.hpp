// The augmented Lagrangian functional (paper, Eq. 6),
//
//     E(x) = |M phi - 1|^2 - (lambda, c_D) + penalty/2 |c_D|^2,   phi = sum x_i N_i,
//
// as a function of the node positions x, for given multipliers and penalty weight. The distortion term is whichever
// objective the DistortionEnergy was built with.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.hpp"
#include "constraint/dirichlet.hpp"
#include "energy/distortion_energy.hpp"

namespace almesh {

struct AugmentedFunctional {
    const DistortionEnergy& distortion;
    const BoundaryConstraint& constraint;
    std::vector<double> lambda;  // trace nodes x dim
    double penalty = 0;

    // Infinite where an element is inverted at a quadrature point (unless the distortion is regularised).
    double energy(const std::vector<double>& x) const {
        const double value = distortion.energy(x);
        return std::isfinite(value) ? value + constraint.value(x, lambda, penalty) : value;
    }

    // Root mean square of the distortion, or of what the objective measures in its place. energy: E(x), so that no
    // element need be looked at again.
    double mean_distortion(const std::vector<double>& x, double energy) const {
        const double of_distortion = std::max(0.0, energy - constraint.value(x, lambda, penalty));
        return std::sqrt(of_distortion / distortion.domain_volume());
    }

    void gradient(const std::vector<double>& x, std::vector<double>& g) const {
        std::fill(g.begin(), g.end(), 0.0);
        distortion.add_gradient(x, g);
        constraint.add_gradient(x, lambda, penalty, g);
    }

    // damping: of the projected Hessian, see distortion_energy.hpp.
    void hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H, double damping = 0) const {
        parallel_for(H.n, [&H](int i) { std::fill(H.block(H.row[i]), H.block(H.row[i + 1]), 0.0); });
        distortion.add_hessian(x, kind, H, damping);
        constraint.add_hessian(penalty, H);
    }
};

}  // namespace almesh
