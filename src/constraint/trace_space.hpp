// The trace space of dirichlet.hpp: degree-p functions on the boundary, in the scalar product
//
//     (u, v) = sum over boundary faces f of the integral over f of u . v / h_f,
//
// h_f the length (2D) or the square root of the area (3D) of the ideal face.
#pragma once
#include <vector>

#include "constraint/target.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct TraceSpace {
    std::vector<int> nodes;            // trace node -> mesh node, ascending
    std::vector<int> faces;            // face x face node: trace nodes
    std::vector<double> face_values;   // quadrature point x face node: N
    std::vector<double> face_weight;   // |f| / h_f over the measure of the reference face; 0 for faces that are free
    double norm_of_one = 0;            // |1|
    BlockCsr M;                        // trace mass matrix M_ij = (N_i, N_j), d = 1
    std::vector<double> height;        // trace nodes: least height over a boundary face of the ideal cells at it

    // ideal: node_count x dim positions of the ideal mesh.
    TraceSpace(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target);

    // trace nodes x dim: the target at the nodes, and its projection, M g_h = (N, g_D).
    std::vector<double> interpolation(const Mesh& mesh, const BoundaryTarget& target) const;
    std::vector<double> projection(const Mesh& mesh, const std::vector<double>& ideal,
                                   const BoundaryTarget& target) const;

private:
    void number_nodes(const Mesh& mesh);
    void measure_heights(const Mesh& mesh, const std::vector<double>& ideal);
    void assemble_mass(const Mesh& mesh, const Quadrature& quadrature);
};

}  // namespace almesh
