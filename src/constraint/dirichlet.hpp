// The boundary constraint of the augmented Lagrangian (paper, Eq. 6),
//
//     c_D = (phi - g_D) / |1|,   (u, v) = sum over boundary faces f of the integral over f of u . v / h_f,
//     |1|^2 = (1, 1),
//
// h_f the length (2D) or the square root of the area (3D) of the ideal face.
//
// phi restricted to the boundary and the multipliers live in the degree-p trace space; a curved g_D does not. Let g_h
// be the projection of g_D onto the trace space in this scalar product. Then phi - g_h and g_h - g_D are orthogonal:
//
//     |c_D|^2 = |P c_D|^2 + floor^2,   P c_D = (phi - g_h) / |1|,   floor = |g_h - g_D| / |1|.
//
// The floor does not depend on phi, so everything but the norm itself needs g_h only, and with the trace mass matrix
// M_ij = (N_i, N_j), r = x - g_h on the boundary nodes:
//     -(lambda, c_D) + mu/2 |c_D|^2 = -lambda^T M r / |1| + mu/2 (r^T M r / |1|^2 + floor^2)
//     gradient M (mu r / |1|^2 - lambda / |1|),   Hessian mu M / |1|^2,   update lambda <- lambda - mu r / |1|.
// With the nodal target g_h interpolates g_D at the nodes, and the floor is zero by definition. Where every motion is
// affine, g_D is in the trace space: interpolation is the projection, and the floor is zero but for rounding.
#pragma once
#include <vector>

#include "constraint/target.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

enum class TargetKind { exact, nodal };

class BoundaryConstraint {
public:
    // ideal: node_count x dim positions of the ideal mesh.
    BoundaryConstraint(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                       TargetKind kind);

    int size() const { return static_cast<int>(nodes_.size()) * dim_; }  // of the multipliers
    const std::vector<int>& nodes() const { return nodes_; }             // trace node -> mesh node
    double norm_of_one() const { return norm_of_one_; }                  // |1|
    double floor() const { return floor_; }

    // x: node_count x dim. lambda: trace nodes x dim.
    double projected_norm(const std::vector<double>& x) const;  // |P c_D|
    double norm(const std::vector<double>& x) const;            // |c_D|
    // Largest |phi - g_D| over the nodes of the boundary faces and, unless the target is nodal, their quadrature
    // points.
    double max_error(const std::vector<double>& x) const;

    double value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) const;
    void add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                      std::vector<double>& g) const;
    // row: block row of H for each mesh node, or -1 where H leaves it out; nullptr: the node's own number.
    void add_hessian(double mu, BlockCsr& H, const std::vector<int>* row = nullptr) const;
    void update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) const;
    // P c_D at the trace nodes (trace nodes x dim).
    std::vector<double> projected_constraint(const std::vector<double>& x) const;

private:
    int dim_;
    TargetKind kind_;
    const Mesh& mesh_;
    BoundaryTarget target_;
    std::vector<int> nodes_;        // trace node -> mesh node
    std::vector<int> faces_;        // face x face node: trace nodes
    BlockCsr M_;                    // trace mass matrix, d = 1
    std::vector<double> g_h_;       // trace nodes x dim
    std::vector<double> face_values_;  // quadrature point x face node: N
    double norm_of_one_ = 0, floor_ = 0;
    mutable std::vector<double> v_;  // trace nodes x dim: what M is applied to

    void number_trace_nodes();
    void assemble_mass(const std::vector<double>& face_weight);
    void project_target(const std::vector<double>& ideal, const std::vector<double>& face_weight);
    void interpolate_target();
    void measure_floor(const std::vector<double>& face_weight);
    double difference(const std::vector<double>& x, int trace_node, int component) const;
    double squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes, int face,
                                 int point) const;
    template <class Entry>
    void set_v(const Entry& entry) const;
    template <int n>
    void mass_times_v(int trace_node, double* Mv) const;
    template <class Weight>
    double dot_mass_times_v(const Weight& weight) const;
};

}  // namespace almesh
