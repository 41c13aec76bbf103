// The distortion part of the functional (paper, Eqs. 5 and 6): the integral over the ideal mesh
//
//     sum over elements e of  w_e * integral over e of f(eta(D phi(y))) dy,   f = eta^2 or (eta - 1)^2,
//
// with gradient and Hessian with respect to the node positions x of phi = sum x_i N_i. The ideal elements are
// straight-sided, so D phi = J A^{-1} with the constant Jacobian A of the ideal element and J = sum x_i (grad N_i)^T.
// Weights w_e = |e|^(alpha-1), scaled so that sum w_e |e| = |Omega|: alpha = 1 is the paper, smaller alpha protects
// small elements.
//
// Damping. Where the Hessian is a bad model, what keeps a step from inverting small elements is the Hessian of the
// integral of eta^2 with weights |e|^{3/(2n)}: linear elasticity, stiffer where the mesh is finer, so that small
// elements move almost rigidly and large ones deform (as in mesh moving by stiffened elasticity: Stein, Tezduyar,
// Benney, J. Appl. Mech. 70, 2003). Since (w + t w')(eta - s)^2 with s = w/(w + t w') has the second derivatives of
// w (eta - 1)^2 + t w' eta^2, it costs nothing to add.
//
// Elements are worked on in batches, one in each lane of the vector registers (linear_batch.hpp, curved_batch.hpp), and
// in the order of element_chunks.hpp: the same bits for any number of threads. Cost per quadrature point and element
// with m nodes: O(m n^2) for the energy, O(m^2 n^3) for the Hessian.
// Memory per element: 4 m (m + 1) + 8 n^2 + 28 bytes.
#pragma once
#include <vector>

#include "base/lanes.hpp"
#include "base/large_array.hpp"
#include "energy/distortion.hpp"
#include "energy/element_chunks.hpp"
#include "mesh/quadrature.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct DistortionParams {
    Objective objective = Objective::deviation;
    double delta = 0;            // Eq. 3
    double weight_exponent = 1;  // alpha
    int exactness = 0;           // of the quadrature for p > 1; 0: default_exactness(degree)
};

enum class HessianKind {
    full,              // second derivative of the objective
    projected,         // its positive semidefinite part, point by point
    squared_projected  // the damping alone: the Hessian of Eq. 5 vanishes at the identity
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

    // The elements that have a node with moves[i], with the same weights, as an energy of its own of their nodes;
    // node: their numbers in this mesh. x: node_count x dim, near positions make good chunks.
    DistortionEnergy part(const std::vector<double>& x, const std::vector<char>& moves, std::vector<int>& node) const;

    // Infinite as soon as one quadrature point has infinite distortion.
    double energy(const std::vector<double>& x) const;
    // Adds to g (node_count x dim); x must have finite energy.
    void add_gradient(const std::vector<double>& x, std::vector<double>& g) const;
    BlockCsr hessian_pattern() const;  // all values zero
    // Adds to H, which has the pattern above. damping: t, for HessianKind::projected.
    void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H, double damping = 0) const;

    DistortionStatistics statistics(const std::vector<double>& x) const;
    double domain_volume() const { return volume_; }

private:
    int dim_, element_count_;
    DistortionParams params_;
    ReferenceElement reference_;
    ElementChunks chunks_;
    // By position in chunks_.order, filled up to whole batches with copies of the last element that weigh nothing:
    std::vector<int> nodes_;             // position x element nodes
    LargeVector<int> place_;             // position x element node x element node: block of the pattern
    LargeVector<Lanes> ideal_inverse_;   // batch x dim x dim, A^{-1}
    std::vector<Lanes> ideal_jacobian_;  // batch, det A
    std::vector<Lanes> weight_;          // batch, w_e det A
    std::vector<Lanes> damping_weight_;  // batch, the same with the exponent of the damping
    double volume_ = 0;
    bool is_large_;  // worth more than one thread
    mutable std::vector<double> chunk_value_;  // chunk, sums before they are added
    BlockCsr pattern_;  // without values

    // Of the elements at `position` in chunks_.order of `whole`, as a mesh of their own.
    DistortionEnergy(const DistortionEnergy& whole, const Mesh& mesh, const std::vector<int>& position);

    void resize();
    void measure();
    void set_geometry(const Mesh& mesh, const std::vector<double>& ideal);
    void set_places(int node_count);
    template <class Body>
    void with_batches(const Body& body) const;
    template <class Batch, class Body>
    void every_batch(int chunk, const std::vector<double>& x, const Body& body) const;
};

}  // namespace almesh
