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
// which two of them meet, or to the corner of three. During a subproblem each surface is its tangent plane at the point
// closest to the iterate before it (sliding.hpp), so that with P_i the orthogonal projection onto the planes' normals
//
//     r_i = P_i (x_i - p_i),   gradient P M (mu r / |1|^2 - lambda / |1|),   Hessian mu P M P / |1|^2,
//
// and nothing holds the node in other directions; P_i = I where its place is prescribed, 0 where it is free. Planes and
// lines are themselves; along curved surfaces, the distance that a node has moved within a subproblem leaves it off by
// the curvature times its square, which the next one removes. The forces turn with the surface: their second-order
// term, with S_i the curvature and n_i the normal at p_i,
//
//     1/2 sum_i (x_i - p_i)' B_i (x_i - p_i),   B_i = -(n_i . (M lambda)_i / |1|) S_i,
//
// vanishes where x is on the surface and makes the sequence of subproblems converge quadratically, as in sequential
// quadratic programming, if multipliers are updated with the r of the planes that the subproblem had; along a mesh's
// own faces it is left out, and they converge linearly. Sliding goes with the nodal target only.
#pragma once
#include <memory>
#include <vector>

#include "constraint/constraint.hpp"
#include "constraint/sliding.hpp"
#include "constraint/target.hpp"
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
    int multipliers() const override { return static_cast<int>(nodes_.size()) * dim_; }
    double norm_of_one() const override { return norm_of_one_; }
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
    const std::vector<int>& nodes() const override { return nodes_; }  // trace node -> mesh node
    std::vector<double> multiplier_field(const std::vector<double>& lambda) const override { return lambda; }
    std::vector<double> multipliers_of_field(const std::vector<double>& field) const override { return field; }
    std::vector<double> constraint_field(const std::vector<double>& x) const override;
    bool expand(const std::vector<double>& x, const std::vector<double>& lambda) override;
    std::vector<double> targets(const std::vector<double>& x) const override;
    std::vector<char> off_target(const std::vector<double>& x) const override;

private:
    int dim_;
    TargetKind kind_;
    const Mesh& mesh_;
    BoundaryTarget target_;
    std::vector<int> nodes_;           // trace node -> mesh node
    std::vector<int> faces_;           // face x face node: trace nodes
    BlockCsr M_;                       // trace mass matrix, d = 1
    std::vector<double> g_h_;          // trace nodes x dim
    std::vector<double> height_;       // trace nodes: least height over a boundary face of the ideal cells at it
    std::vector<double> face_values_;  // quadrature point x face node: N
    double norm_of_one_ = 0, best_approximation_error_ = 0;
    std::vector<double> v_;            // trace nodes x dim: what M is applied to
    std::shared_ptr<const SlidingSurfaces> sliding_;
    std::vector<std::vector<int>> parts_;  // trace nodes: along which it slides; empty where not
    std::vector<double> P_, B_;            // trace nodes x dim x dim; empty where all places are prescribed
    bool is_curved_ = false;               // a node slides along a curved surface: then
    std::vector<double> residual_;         // trace nodes x dim: r at the last expand(), by the planes before it

    void number_trace_nodes();
    void measure_heights(const std::vector<double>& ideal);
    void assemble_mass(const std::vector<double>& face_weight);
    void project_target(const std::vector<double>& ideal, const std::vector<double>& face_weight);
    void interpolate_target();
    void find_parts();
    void hold_to_planes(int trace_node, const Vec<3>& x, const Vec<3>& force);
    void project(int trace_node, double* v) const;
    Vec<3> turned_force(const std::vector<double>& x, int trace_node) const;
    double of_curvature(const std::vector<double>& x) const;
    void measure_best_approximation(const std::vector<double>& face_weight);
    double difference(const std::vector<double>& x, int trace_node, int component) const;
    double squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes, int face,
                                 int point) const;
    template <class Row>
    void add_matrix(double mu, bool projected, const Row& row, BlockCsr& H) const;
    template <class Entry>
    void set_v(const Entry& entry);
    template <int n>
    void mass_times_v(int trace_node, double* Mv) const;
    template <class Weight>
    double dot_mass_times_v(const Weight& weight) const;
};

}  // namespace almesh
