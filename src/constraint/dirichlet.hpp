// Prescribed positions of the boundary (paper, Eqs. 4 and 6): the constraint
//
//     c_D = (phi - g_D) / |1|,   |1|^2 = (1, 1),
//
// in the scalar product of trace_space.hpp. phi restricted to the boundary and the multipliers live in the trace space;
// a curved g_D does not. Let g_h be the projection of g_D onto the trace space in this scalar product. Then phi - g_h
// and g_h - g_D are orthogonal:
//
//     |c_D|^2 = |P c_D|^2 + e_h^2,   P c_D = (phi - g_h) / |1|,   e_h = |g_h - g_D| / |1|.
//
// The best approximation error e_h does not depend on phi, so everything but the norm itself needs g_h only, and with
// the trace mass matrix M_ij = (N_i, N_j), r = x - g_h on the boundary nodes:
//     -(lambda, c_D) + mu/2 |c_D|^2 = -lambda^T M r / |1| + mu/2 (r^T M r / |1|^2 + e_h^2)
//     gradient M (mu r / |1|^2 - lambda / |1|),   Hessian mu M / |1|^2,   update lambda <- lambda - mu r / |1|.
// That is the target `least_squares` of the paper. Nodes of fixed boundaries keep their positions: the projection is
// onto the functions with these values, and the orthogonality holds only for a phi that has them too.
// With the nodal target g_h interpolates g_D at the nodes, and e_h is zero by definition. Where every motion is affine,
// g_D is in the trace space: interpolation is the projection, and e_h is zero but for rounding.
//
// sliding_boundary.hpp uses the same form with another r.
#pragma once
#include <memory>
#include <vector>

#include "constraint/sliding_nodes.hpp"
#include "constraint/target.hpp"
#include "constraint/trace_space.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

class Dirichlet : public Constraint {
public:
    // ideal: node_count x dim positions of the ideal mesh. Throws InputError where the target does not prescribe all
    // positions. The mesh must outlive this.
    Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target, TargetKind kind);

    double best_approximation_error() const { return best_approximation_error_; }  // e_h

    // lambda: trace nodes x dim.
    int multipliers() const override { return static_cast<int>(g_h_.size()); }
    double norm_of_one() const override { return trace_.norm_of_one; }
    double norm(const std::vector<double>& x) override;
    double projected_norm(const std::vector<double>& x) override;
    double max_error(const std::vector<double>& x) override;
    double error_between_nodes(const std::vector<double>& x) override;
    std::vector<double> relative_errors(const std::vector<double>& x) const override;
    double value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) override;
    void add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                      std::vector<double>& g) override;
    void add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
                     BlockCsr& H) override;
    void update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) override;
    std::unique_ptr<Constraint> part(const Restriction& around, std::vector<double>& lambda) const override;
    const std::vector<int>& nodes() const override { return trace_.nodes; }  // trace node -> mesh node
    std::vector<double> multiplier_field(const std::vector<double>& lambda) const override { return lambda; }
    std::vector<double> multipliers_of_field(const std::vector<double>& field) const override { return field; }
    std::vector<double> constraint_field(const std::vector<double>& x) const override;
    std::vector<double> targets(const std::vector<double>& /*x*/) const override { return g_h_; }
    std::vector<char> off_target(const std::vector<double>& x) const override;
    SurfaceDistance distance(int t, const Vec<3>& x) const override;

protected:
    TraceSpace trace_;
    std::vector<double> g_h_;  // trace nodes x dim

    // With the nodal target.
    Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target);
    Dirichlet(const Dirichlet& whole, const Restriction& around);

    virtual bool slides(int /*t*/) const { return false; }
    Vec<3> at(const std::vector<double>& x, int t) const { return at_node(x, trace_.nodes[t], trace_.dim); }

private:
    const Mesh& mesh_;
    BoundaryTarget target_;
    double best_approximation_error_ = 0;

    std::vector<double> residual(const std::vector<double>& x, std::vector<Mat<3>>* slope = nullptr) const;  // r
    double squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes, int face,
                                 int point) const;
};

}  // namespace almesh
