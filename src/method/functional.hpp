// What Newton's method minimises: Functional, and the augmented Lagrangian functional (paper, Eq. 6),
//
//     E(x) = |M phi - 1|^2 - (lambda, c_D) + penalty/2 |c_D|^2,   phi = sum x_i N_i,
//
// as a function of the node positions x, for given multipliers and penalty weight. The first term stands for the
// objective of the DistortionEnergy, the rest is the constraint's. Restriction to some nodes: local_functional.hpp.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "constraint/constraint.hpp"
#include "energy/distortion_energy.hpp"
#include "method/fixed_nodes.hpp"
#include "method/line_search.hpp"

namespace almesh {

class LocalFunctional;

// x: positions of the nodes on which the functional depends, nodes x dim. Evaluations use work space of the object.
struct Functional {
    DistortionEnergy& distortion;  // the sum over the elements

    explicit Functional(DistortionEnergy& of_elements) : distortion(of_elements) {}
    virtual ~Functional() = default;

    // Infinite where an element is inverted at a quadrature point (unless the distortion is regularised).
    virtual double energy(const std::vector<double>& x) const = 0;
    // The distortion term of E(x). energy: E(x), from which the constraint's term is subtracted.
    virtual double distortion_energy(const std::vector<double>& x, double energy) const = 0;
    // The part of E that no x can remove: of a constraint, penalty/2 (|c|^2 - |P c|^2).
    virtual double lost_energy(const std::vector<double>& /*x*/) const { return 0; }
    // How much of a step is valid, in [0, 1]: DistortionEnergy::valid_fraction().
    virtual double valid_fraction(const std::vector<double>& x, const std::vector<double>& to) const {
        return distortion.valid_fraction(x, to);
    }
    // Finer quadrature of elements that are bent at x or that steps were cut for. Whether E has changed.
    virtual bool refine_quadrature(const std::vector<double>& x) const { return distortion.refine_quadrature(x); }
    virtual void gradient(const std::vector<double>& x, std::vector<double>& g) const = 0;
    virtual void hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                         const Projection& projection = {}) const = 0;
    // The change of E by the rounding of x, besides the rounding of sums. force: work space, the size of x.
    virtual double rounding_error(const std::vector<double>& /*x*/, std::vector<double>& /*force*/) const { return 0; }
    // Second-order correction of the step d from x (constraint.hpp); empty where there is none. x, d: used when called.
    virtual Correction correction(const std::vector<double>& /*x*/, const std::vector<double>& /*d*/) const {
        return {};
    }
    // Sets the entries of fixed nodes to zero, and those of nodes that are eliminated to what others give them.
    virtual void fix(std::vector<double>& /*d*/) const {}
    // The functional of the nodes with moves[i] alone; fixed nodes are excluded.
    virtual std::unique_ptr<LocalFunctional> part(const std::vector<double>& x, std::vector<char> moves) const = 0;
};

struct AugmentedFunctional : Functional {
    Constraint& constraint;
    std::vector<double> lambda;
    double penalty;
    std::vector<char> fixed;  // per node: whether it stays where it is; empty: none does

    AugmentedFunctional(DistortionEnergy& of_elements, Constraint& of_boundary, std::vector<double> multipliers,
                        double weight = 0, std::vector<char> nodes = {})
        : Functional(of_elements),
          constraint(of_boundary),
          lambda(std::move(multipliers)),
          penalty(weight),
          fixed(std::move(nodes)) {}

    double energy(const std::vector<double>& x) const override {
        const double value = distortion.energy(x);
        return std::isfinite(value) ? value + constraint.value(x, lambda, penalty) : value;
    }

    double distortion_energy(const std::vector<double>& x, double energy) const override {
        return energy - constraint.value(x, lambda, penalty);
    }

    void gradient(const std::vector<double>& x, std::vector<double>& g) const override {
        std::fill(g.begin(), g.end(), 0.0);
        distortion.add_gradient(x, g);
        constraint.add_gradient(x, lambda, penalty, g);
        distortion.pairs().fold(g);
        fix_nodes(fixed, distortion.dim(), g);
    }

    std::vector<double> gradient(const std::vector<double>& x) const {
        std::vector<double> g(x.size());
        gradient(x, g);
        return g;
    }

    void hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                 const Projection& projection = {}) const override {
        H.set_zero();
        distortion.add_hessian(x, kind, H, projection);
        constraint.add_hessian(x, lambda, penalty, kind != HessianKind::full, H);
        distortion.pairs().fold(H);
        fix_nodes(fixed, H);
    }

    double lost_energy(const std::vector<double>& x) const override {
        const double c = constraint.norm(x), Pc = constraint.projected_norm(x);
        return 0.5 * penalty * (c - Pc) * (c + Pc);
    }

    // Rounding of the positions in the constraint: a small c is a difference of positions, and is multiplied by large
    // multipliers and penalties.
    double rounding_error(const std::vector<double>& x, std::vector<double>& force) const override {
        std::fill(force.begin(), force.end(), 0.0);
        constraint.add_gradient(x, lambda, penalty, force);
        double sum = 0;
        for (std::size_t i = 0; i < x.size(); ++i) sum += std::abs(force[i] * x[i]);
        return std::numeric_limits<double>::epsilon() * sum;
    }

    Correction correction(const std::vector<double>& x, const std::vector<double>& d) const override {
        if (!constraint.corrects_steps()) return {};
        return [this, &x, &d](double t, std::vector<double>& y) { constraint.correct(x, d, t, y); };
    }

    void fix(std::vector<double>& d) const override {
        fix_nodes(fixed, distortion.dim(), d);
        distortion.pairs().spread(d);
    }
    std::unique_ptr<LocalFunctional> part(const std::vector<double>& x, std::vector<char> moves) const override;
};

}  // namespace almesh
