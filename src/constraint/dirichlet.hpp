// Prescribed positions of the boundary (paper, Eqs. 4 and 6): the constraint
//
//     c_D = (phi - g_D) / |1|,   (u, v) = sum over boundary faces f of the integral over f of u . v / h_f,
//     |1|^2 = (1, 1),
//
// h_f the length (2D) or the square root of the area (3D) of the ideal face.
//
// phi restricted to the boundary and the multipliers live in the degree-p trace space; a curved g_D does not. Let g_h
// be the projection of g_D onto the trace space in this scalar product. Then phi - g_h and g_h - g_D are orthogonal:
//
//     |c_D|^2 = |P c_D|^2 + e_h^2,   P c_D = (phi - g_h) / |1|,   e_h = |g_h - g_D| / |1|.
//
// The best approximation error e_h does not depend on phi, so everything but the norm itself needs g_h only, and with
// the trace mass matrix M_ij = (N_i, N_j), r = x - g_h on the boundary nodes:
//     -(lambda, c_D) + mu/2 |c_D|^2 = -lambda^T M r / |1| + mu/2 (r^T M r / |1|^2 + e_h^2)
//     gradient M (mu r / |1|^2 - lambda / |1|),   Hessian mu M / |1|^2,   update lambda <- lambda - mu r / |1|.
// With the nodal target g_h interpolates g_D at the nodes, and e_h is zero by definition. Where every motion is affine,
// g_D is in the trace space: interpolation is the projection, and e_h is zero but for rounding.
//
// Sliding boundaries. A node that slides is held to the surfaces of the parts that it is on: to one, along the curve in
// which two of them meet, or to the corner of three. With r_i(x_i) the sum of its distance vectors from them
// (sliding_nodes.hpp) and D_i = dr_i/dx_i,
//
//     gradient D' f,  f = M (mu r / |1|^2 - lambda / |1|),   Hessian mu D' M D / |1|^2 + f . d2r/dx2,
//
// D_i = I where the place is prescribed, 0 where the node is free. D_i projects onto the normals where x is on the
// surface: nothing holds the node in other directions, and multipliers along the surface are of no account. d2r/dx2 is
// exact where x is on the surface; the Hessian without it (Gauss-Newton) is positive semidefinite. Sliding goes with
// the nodal target only.
#pragma once
#include <memory>
#include <vector>

#include "constraint/constraint.hpp"
#include "constraint/sliding.hpp"
#include "constraint/sliding_nodes.hpp"
#include "constraint/target.hpp"
#include "constraint/trace_space.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

enum class TargetKind { exact, nodal };

class Dirichlet : public Constraint {
public:
    // ideal: node_count x dim positions of the ideal mesh. The mesh must outlive this. sliding: null where all places
    // are prescribed; else the kind is nodal. Throws InputError where a prescribed place is off the surface along which
    // the node slides as well.
    Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target, TargetKind kind,
              std::shared_ptr<const SlidingSurfaces> sliding = nullptr);

    double best_approximation_error() const { return best_approximation_error_; }  // e_h

    // lambda: trace nodes x dim.
    int multipliers() const override { return static_cast<int>(g_h_.size()); }
    double norm_of_one() const override { return trace_.norm_of_one; }
    double norm(const std::vector<double>& x) override;
    double projected_norm(const std::vector<double>& x) override;
    // Over the nodes of the boundary faces and, unless the target is nodal, their quadrature points.
    double max_error(const std::vector<double>& x) override;
    double relative_error(const std::vector<double>& x) const override;
    std::vector<double> relative_errors(const std::vector<double>& x) const override;
    double value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) override;
    void add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                      std::vector<double>& g) override;
    void add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
                     BlockCsr& H) override;
    void update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) override;
    std::unique_ptr<ConstraintPart> part(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                                         const std::vector<int>& node, const BlockCsr& pattern) override;
    bool bends_steps() const override { return sliding_ && !prescribes_all(); }
    void bend(const std::vector<double>& x, const std::vector<double>& d, double t,
              std::vector<double>& y) const override;
    const std::vector<int>& nodes() const override { return trace_.nodes; }  // trace node -> mesh node
    std::vector<double> multiplier_field(const std::vector<double>& lambda) const override { return lambda; }
    std::vector<double> multipliers_of_field(const std::vector<double>& field) const override { return field; }
    std::vector<double> constraint_field(const std::vector<double>& x) const override;
    std::vector<double> targets(const std::vector<double>& x) const override;
    std::vector<char> off_target(const std::vector<double>& x) const override;

    // Of a trace node at x from where it should be.
    SurfaceDistance distance(int trace_node, const Vec<3>& x) const;
    // Sum over k of force_k times the second derivative of r_k; zero for nodes that do not slide.
    Mat<3> second_derivative_at(int trace_node, const Vec<3>& x, const Vec<3>& force) const;

private:
    int dim_;
    TargetKind kind_;
    const Mesh& mesh_;
    BoundaryTarget target_;
    TraceSpace trace_;
    std::vector<double> g_h_;  // trace nodes x dim
    double best_approximation_error_ = 0;
    std::shared_ptr<const SlidingSurfaces> sliding_;
    std::vector<std::vector<int>> parts_;  // trace nodes: along which it slides; empty where not
    std::vector<char> held_;               // trace nodes: whether its place is prescribed; empty where all are
    std::vector<double> r_, v_, slope_;    // trace nodes x dim: r, and what M is applied to; x dim x dim: D

    int count() const { return trace_.M.n; }
    bool prescribes_all() const { return held_.empty(); }
    void measure(const std::vector<double>& x);
    void measure_slopes(const std::vector<double>& x);
    void set_force(const std::vector<double>& lambda, double mu);
    void measure_best_approximation();
    double squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes, int face,
                                 int point) const;
    void add_matrix(double factor, BlockCsr& H) const;
    void add_second_derivatives(const std::vector<double>& x, BlockCsr& H) const;
    template <class Entry>
    void set_v(const Entry& entry);
    template <int n>
    void mass_times_v(int trace_node, double* Mv) const;
    template <class Weight>
    double dot_mass_times_v(const Weight& weight) const;
};

// C += factor A' B, d x d each.
inline void add_congruence(double factor, const double* A, const double* B, int d, double* C) {
    for (int c = 0; c < d; ++c)
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) C[a * d + b] += factor * A[c * d + a] * B[c * d + b];
}

}  // namespace almesh
