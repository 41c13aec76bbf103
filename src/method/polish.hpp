// The last steps. Boundary nodes, which the method has brought to their targets up to its tolerances, are set to them
// to the last bit. With the boundary there the nodes that it leaves free, all inside and those that slide along their
// surfaces, go to the minimum of the distortion, as nearly as it can be computed: no penalty and no tolerance of
// Algorithm 1 is in that.
#pragma once
#include <vector>

#include "constraint/sliding_nodes.hpp"
#include "constraint/surface.hpp"
#include "method/functional.hpp"
#include "method/newton.hpp"

namespace almesh {

// x: a valid mesh, before and after. Nodes are set together, and where elements do not stay valid on the way, in halves
// of their list, down to single ones; after `most_tries` what is left stays. Returns the number of nodes that are not
// at their targets.
// chosen: per node of the mesh, which of them; empty: all.
int snap_to_targets(DistortionEnergy& distortion, const Constraint& constraint, std::vector<double>& x,
                    const std::vector<char>& chosen = {});

// Nodes of the constraint that are not at their targets, to the last bit.
int nodes_off_target(const Constraint& constraint, const std::vector<double>& x);

// The distortion of meshes with the boundary on its target. D_i: derivative of the distance r_i of a node i of the
// boundary from its target, or from its surfaces (constraint.hpp); P_i: the projector onto the directions in which the
// node is free, D P = 0. Then P grad E = 0 at the minimum, and with the forces f_i that hold the boundary there,
// D f = -grad E, the Hessian is P (H + K) P, K_i = f_i . r_i'': what the curvature of the surfaces adds.
class OnTarget : public AugmentedFunctional {
public:
    // Of one of the constraint's nodes.
    struct Node {
        int node;
        Mat<3> P, D_inverse, K;  // D_inverse: where D is not zero
        Vec<3> f;
    };

    OnTarget(DistortionEnergy& energy, Constraint& on_boundary, int node_count);

    const std::vector<Node>& nodes() const { return nodes_; }  // at the point that was set last
    int place(int node) const { return place_[node]; }         // which of these the node of the mesh is, or -1

    std::vector<double> set_point(const std::vector<double>& x) const;  // returns P grad E
    void project(std::vector<double>& v) const;                         // P v
    void project(BlockCsr& H) const;  // P (H + K) P, and on the rest of each diagonal block a multiple of 1

    void gradient(const std::vector<double>& x, std::vector<double>& g) const override {
        if (slides_) g = set_point(x);
        else AugmentedFunctional::gradient(x, g);
    }
    // At the point of the last gradient.
    void hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                 const Projection& projection = {}) const override {
        AugmentedFunctional::hessian(x, kind, H, projection);
        if (slides_) project(H);
    }
    double rounding_error(const std::vector<double>&, std::vector<double>&) const override { return rounding_; }
    std::unique_ptr<LocalFunctional> part(const std::vector<double>& x, std::vector<char> moves) const override;

private:
    friend NewtonResult polish(OnTarget& E, Newton& newton, double omega, std::vector<double>& x);

    std::vector<int> place_;
    mutable std::vector<Node> nodes_;
    bool slides_;
    double rounding_ = 0;
};

// x: a valid mesh near its target, before and after. Ends at |P grad E| <= omega, or as small as rounding lets it be;
// stalled where the boundary cannot be set to its target.
NewtonResult polish(OnTarget& E, Newton& newton, double omega, std::vector<double>& x);

}  // namespace almesh
