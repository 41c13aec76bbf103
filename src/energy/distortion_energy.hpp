// The distortion part of the functional (paper, Eqs. 5 and 6): the integral over the ideal mesh
//
//     E(x) = sum over elements e of  w_e * integral over e of f(eta(D phi(y))) dy,   phi = sum x_i N_i,
//
// f one of the densities of densities.hpp, with gradient and Hessian with respect to the node positions x.
// D phi = J A^{-1} with J = sum x_i (grad N_i)^T and the Jacobian A of the ideal element: constant where that is
// straight-sided, as in the paper; sum y_i (grad N_i)^T where it is curved, with node positions y. Weights
// w_e = |e|^(alpha-1), scaled so that sum w_e |e| = |Omega|: alpha = 1 is the paper, smaller alpha protects small
// elements.
//
// Elements of one type have an energy of their own (group_energy.hpp): simd_energy.hpp, or the textbook assembly of the
// course, lessons/plain_energy.hpp, which it is tested against. That of a mesh with several types is their sum
// (mixed_energy.hpp).
//
// Damping. If the Hessian is a poor model, steps are kept from inverting small elements by adding the Hessian of the
// integral of eta^2 with weights w'_e |e| proportional to |e|^min(3/(2n), alpha): linear elasticity, stiffer where the
// mesh is finer, so that small elements move almost rigidly and large ones deform (Stein, Tezduyar, Benney,
// J. Appl. Mech. 70, 2003). A damped Hessian is that of w f + t w' eta^2: a density again.
//
// Evaluations use work space of the object: one call at a time.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "base/index.hpp"
#include "energy/element_rules.hpp"
#include "energy/options.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"
#include "mesh/periodic.hpp"
#include "mesh/restriction.hpp"

namespace almesh {

// Of eta without regularisation (Eq. 1), which is infinite for inverted elements.
struct DistortionStatistics {
    double relative_quality = 0;      // q = |1| / |M phi|, norms over the ideal mesh
    double max_distortion = 0;        // over quadrature points, element nodes among them
    std::vector<double> element_max;  // per element
};

class DistortionEnergy {
public:
    virtual ~DistortionEnergy() = default;

    // Infinite as soon as one quadrature point has infinite distortion.
    virtual double energy(const std::vector<double>& x) = 0;
    // Adds to g (node_count x dim); x must have finite energy.
    virtual void add_gradient(const std::vector<double>& x, std::vector<double>& g) = 0;
    // Adds to H, which has the pattern below. projection: for HessianKind::projected alone.
    virtual void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                             const Projection& projection = {}) = 0;
    BlockCsr hessian_pattern() const;  // all values zero
    // Reorders the rows of the Hessian as `choose` says for its pattern; null leaves them as they are.
    using ChooseOrder = std::function<std::shared_ptr<const RowOrder>(const BlockCsr& pattern)>;
    void order_hessian(const ChooseOrder& choose);
    // Nodes that whoever minimises E has to eliminate: the pattern gets room for that. Before order_hessian().
    void set_pairs(const PeriodicPairs& pairs);
    const PeriodicPairs& pairs() const { return pairs_; }
    virtual DistortionStatistics statistics(const std::vector<double>& x) = 0;

    // Restriction to the nodes with moves[i]: the energy of the elements at these nodes, with the same weights. around:
    // on return these, in this energy's order. x: node_count x dim, positions that order the elements.
    virtual std::unique_ptr<DistortionEnergy> part(const std::vector<double>& x, const std::vector<char>& moves,
                                                   Restriction& around) const = 0;

    int dim() const { return dim_; }
    double domain_volume() const { return volume_; }
    // The energy of a mesh with the distortion eta everywhere.
    double uniform(double eta) const;
    // Scale of the damping at an energy: f'/2 at the eta for which f is the mean density; for squares the root mean
    // square of eta or eta - 1.
    double mean_slope(double energy) const;

    // Changes the power of the density, or the regularisation.
    virtual void set_power(const PowerParams& power) { params_.power = power; }
    const PowerParams& power() const { return params_.power; }
    virtual void set_delta(double delta) { params_.delta = delta; }
    double delta() const { return params_.delta; }

    // Valid elements and the quadrature that sees them: element_rules.hpp. With regularisation elements may invert.
    virtual double valid_fraction(const std::vector<double>& x, const std::vector<double>& to) = 0;
    virtual bool certified(const std::vector<double>& x) const = 0;
    // Whether E has changed, here and below. x: where elements may be bent.
    virtual bool refine_quadrature(const std::vector<double>& x = {}) = 0;
    virtual bool take_over_refinements(const DistortionEnergy& part) = 0;
    virtual QuadratureState quadrature() const = 0;
    virtual void set_quadrature(const QuadratureState& state) = 0;
    virtual int refined_elements() const = 0;

    // What evaluations cost.
    virtual bool is_curved() const = 0;
    virtual double nodes_in_elements() const = 0;
    virtual double hessian_work() const = 0;  // in passes of an iterative solver over an entry of a matrix

protected:
    DistortionEnergy(const DistortionParams& params, int dim) : params_(params), dim_(dim) {}

    DistortionParams params_;
    int dim_;
    BlockCsr pattern_;   // of the Hessian, without values
    double volume_ = 0;  // |Omega|

private:
    PeriodicPairs pairs_;

    virtual void blocks_moved(const LargeVector<int>& place) = 0;  // of the pattern: place as of ordered_pattern()
};

// ideal: node_count x dim positions of the ideal mesh, whose elements must have positive volume: else InputError.
std::unique_ptr<DistortionEnergy> make_energy(const Mesh& mesh, const std::vector<double>& ideal,
                                              const DistortionParams& params);

}  // namespace almesh
