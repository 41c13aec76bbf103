// The augmented Lagrangian functional (paper, Eq. 6),
//
//     E(x) = |M phi - 1|^2 - (lambda, c_D) + penalty/2 |c_D|^2,   phi = sum x_i N_i,
//
// as a function of the node positions x, for given multipliers and penalty weight. The distortion term is the objective
// that the DistortionEnergy was built with, the rest the constraint's.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.hpp"
#include "constraint/constraint.hpp"
#include "energy/distortion_energy.hpp"
#include "method/fixed_nodes.hpp"

namespace almesh {

struct AugmentedFunctional {
    DistortionEnergy& distortion;
    Constraint& constraint;
    std::vector<double> lambda;
    double penalty = 0;
    std::vector<char> fixed = {};  // per node: whether it stays where it is; empty: none does

    // Infinite where an element is inverted at a quadrature point (unless the distortion is regularised).
    double energy(const std::vector<double>& x) const {
        const double value = distortion.energy(x);
        return std::isfinite(value) ? value + constraint.value(x, lambda, penalty) : value;
    }

    double valid_fraction(const std::vector<double>& x, const std::vector<double>& to) const {
        return distortion.valid_fraction(x, to);
    }

    void gradient(const std::vector<double>& x, std::vector<double>& g) const {
        std::fill(g.begin(), g.end(), 0.0);
        distortion.add_gradient(x, g);
        constraint.add_gradient(x, lambda, penalty, g);
        fix_nodes(fixed, distortion.dim(), g);
    }

    std::vector<double> gradient(const std::vector<double>& x) const {
        std::vector<double> g(x.size());
        gradient(x, g);
        return g;
    }

    void hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                 const Projection& projection = {}) const {
        parallel_for(H.n, [&H](int i) { std::fill(H.block(H.row[i]), H.block(H.row[i + 1]), 0.0); });
        distortion.add_hessian(x, kind, H, projection);
        constraint.add_hessian(x, lambda, penalty, kind != HessianKind::full, H);
        fix_nodes(fixed, H);
    }

    // By how much rounding the positions at which the constraint is evaluated changes E: small c with large multipliers
    // and penalties are differences of positions times large forces. force: work space, the size of x.
    double rounding_error(const std::vector<double>& x, std::vector<double>& force) const {
        std::fill(force.begin(), force.end(), 0.0);
        constraint.add_gradient(x, lambda, penalty, force);
        double sum = 0;
        for (std::size_t i = 0; i < x.size(); ++i) sum += std::abs(force[i] * x[i]);
        return std::numeric_limits<double>::epsilon() * sum;
    }

    // DistortionEnergy::mean_slope() at x. energy: E(x), so that no element need be looked at again.
    double mean_slope(const std::vector<double>& x, double energy) const {
        return distortion.mean_slope(energy - constraint.value(x, lambda, penalty));
    }
};

}  // namespace almesh
