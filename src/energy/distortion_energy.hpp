// The distortion part of the functional (paper, Eqs. 5 and 6): the integral over the ideal mesh
//
//     E(x) = sum over elements e of  w_e * integral over e of f(eta(D phi(y))) dy,   phi = sum x_i N_i,
//
// f one of the densities of densities.hpp, with gradient and Hessian with respect to the node positions x. The ideal
// elements are straight-sided, so D phi = J A^{-1} with the constant Jacobian A of the ideal element and
// J = sum x_i (grad N_i)^T. Weights w_e = |e|^(alpha-1), scaled so that sum w_e |e| = |Omega|: alpha = 1 is the paper,
// smaller alpha protects small elements.
//
// Two implementations: plain_energy.hpp, the textbook assembly, made to be read; simd_energy.hpp, the one that runs
// use, tested against it.
//
// Damping. Where the Hessian is a bad model, what keeps a step from inverting small elements is the Hessian of the
// integral of eta^2 with weights w'_e |e| proportional to |e|^{3/(2n)}: linear elasticity, stiffer where the mesh is
// finer, so that small elements move almost rigidly and large ones deform (as in mesh moving by stiffened elasticity:
// Stein, Tezduyar, Benney, J. Appl. Mech. 70, 2003). A damped Hessian is that of w f + t w' eta^2: a density again.
//
// Validity. The energy sees curved elements at the points of its quadrature only. valid_fraction() tells how far a step
// may go (valid_step.hpp), and elements that it would have folded unseen get a finer quadrature (refined_rule.hpp) when
// refine_quadrature() is called, for good.
//
// Evaluations use work space of the object: one call at a time.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "base/index.hpp"
#include "energy/options.hpp"
#include "energy/refined_rule.hpp"
#include "energy/valid_step.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Of eta of Eq. 1 itself, without regularisation: infinite for inverted elements.
struct DistortionStatistics {
    double relative_quality = 0;      // q = |1| / |M phi|, norms over the ideal mesh
    double max_distortion = 0;        // over quadrature points, element nodes among them
    std::vector<double> element_max;  // per element
};

// Where elements have folded: what their quadrature has been refined for so far, and what it will be for next.
struct QuadratureState {
    std::vector<Fold> refinements, folds;
};

class DistortionEnergy {
public:
    virtual ~DistortionEnergy() = default;

    // Infinite as soon as one quadrature point has infinite distortion.
    virtual double energy(const std::vector<double>& x) = 0;
    // Adds to g (node_count x dim); x must have finite energy.
    virtual void add_gradient(const std::vector<double>& x, std::vector<double>& g) = 0;
    virtual BlockCsr hessian_pattern() const = 0;  // all values zero
    // From now on with the rows of the Hessian in the order that `choose` makes of its pattern; none: as they are.
    using ChooseOrder = std::function<std::shared_ptr<const RowOrder>(const BlockCsr& pattern)>;
    virtual void order_hessian(const ChooseOrder& choose) = 0;
    // Adds to H, which has the pattern above. projection: for HessianKind::projected alone.
    virtual void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                             const Projection& projection = {}) = 0;
    virtual DistortionStatistics statistics(const std::vector<double>& x) = 0;

    // The elements that have a node with moves[i], with the same weights, as an energy of its own of their nodes;
    // node: their numbers in this mesh, those that move first. x: node_count x dim, positions by which elements are
    // ordered.
    virtual std::unique_ptr<DistortionEnergy> part(const std::vector<double>& x, const std::vector<char>& moves,
                                                   std::vector<int>& node) const = 0;

    // The largest s <= 1 found so that all elements are valid along (1 - r) x + r to for 0 <= r <= s; 1 with
    // regularisation, which lets elements invert. Notes where elements would fold.
    double valid_fraction(const std::vector<double>& x, const std::vector<double>& to);
    bool certified(const std::vector<double>& x);  // everywhere in every element, or regularised
    // A finer quadrature of the elements that steps were cut for since the last call. Whether E has changed.
    bool refine_quadrature();
    // The refinements of a part of this energy since it was made; this one has had none since. Whether E has changed.
    bool take_over_refinements(const DistortionEnergy& part);
    // Which quadratures have been refined, and are to be; set_quadrature() for one that has none or the first of them.
    QuadratureState quadrature() const { return {refinements_, folds_}; }
    void set_quadrature(const QuadratureState& state);
    // Another power in the density from now on.
    void set_power(const PowerParams& power) { params_.power = power; }
    const PowerParams& power() const { return params_.power; }
    // Another regularisation from now on.
    void set_delta(double delta) { params_.delta = delta; }
    double delta() const { return params_.delta; }
    int dim() const { return dim_; }
    double nodes_in_elements() const { return static_cast<double>(element_count_) * reference_.nodes; }
    double hessian_passes() const;  // passes of an iterative solver over an entry of a matrix that take as long as it
    bool is_curved() const { return reference_.degree > 1; }
    int refined_elements() const { return static_cast<int>(refined_.size()); }

    double domain_volume() const { return volume_; }
    // The energy of a mesh with the distortion eta everywhere.
    double uniform(double eta) const;
    // The scale of the damping at an energy: f'/2 at the eta whose density is the mean; the root mean square of eta or
    // eta - 1 for the densities that are squares.
    double mean_slope(double energy) const;

protected:
    // Of an element of its own; all others have reference_.
    struct Refined {
        int element;
        std::shared_ptr<const RefinedQuadrature> quadrature;
    };

    DistortionEnergy(const DistortionParams& params, const Mesh& mesh);
    // Some elements of another one; nodes_ and place_in_whole_ are to be set, then take_refined_of() called.
    DistortionEnergy(const DistortionEnergy& whole, int element_count);
    void take_refined_of(const DistortionEnergy& whole);
    const int* element(int e) const { return &nodes_[offset(e, reference_.nodes)]; }

    DistortionParams params_;
    int dim_, element_count_;
    Quadrature quadrature_;
    ReferenceElement reference_;
    std::vector<int> nodes_;  // element_count x element nodes, or more
    std::vector<int> place_in_whole_;  // of a part: element -> element of what it is a part of
    std::vector<Refined> refined_;
    double volume_ = 0;  // |Omega|

private:
    ValidStep valid_step_;
    std::vector<Fold> folds_;        // since the last refinement
    std::vector<Fold> refinements_;  // so far

    bool refine(const Fold& fold);
    void set_quadrature(int element, std::shared_ptr<const RefinedQuadrature> quadrature);
    int find_refined(int element) const;          // its place in refined_, or their number
    virtual void added_refined(int refined) = 0;  // refined_[refined] is new
};

// ideal: node_count x dim positions of the ideal mesh, whose elements must have positive volume: else InputError.
std::unique_ptr<DistortionEnergy> make_energy(const Mesh& mesh, const std::vector<double>& ideal,
                                              const DistortionParams& params);

// Exponent of |e| in w'_e |e|: 3/(2n), in 2D and 3D the power 3/2 of the element's size, or alpha if that is less.
double damping_exponent(int dim, double weight_exponent);

// Some elements of a mesh with their nodes numbered anew.
struct SubMesh {
    std::vector<int> place;     // of each element among those given
    std::vector<int> node;      // node here -> node of the mesh; those that move come first
    std::vector<int> elements;  // element x element nodes, numbers of here
};

// The elements with a node that moves. elements: count x m node numbers; moves: per node of the mesh.
SubMesh elements_around(const std::vector<int>& elements, int count, int m, const std::vector<char>& moves);

}  // namespace almesh
