// The trace space: degree-p functions on the boundary, in the scalar product of the paper (below Eq. 6),
//
//     (u, v) = sum over boundary faces f of the integral over f of u . v / h_f = u^T M v,
//
// h_f the length (2D) or the square root of the area (3D) of the ideal face, a straight one: the area of a bilinear
// quadrilateral and integrals over it are those of the target's quadrature. A function is its values at the trace
// nodes, trace nodes x dim.
#pragma once
#include <algorithm>
#include <vector>

#include "base/index.hpp"
#include "constraint/target.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"
#include "mesh/restriction.hpp"

namespace almesh {

struct TraceSpace {
    int dim;
    std::vector<int> nodes;            // trace node -> mesh node, ascending in a whole mesh
    std::vector<int> faces;            // face x face node: trace nodes
    std::vector<double> face_weight;   // |f| / h_f over the measure of the reference face; 0 for faces that are free
    double norm_of_one = 0;            // |1|
    BlockCsr M;                        // trace mass matrix M_ij = (N_i, N_j), d = 1
    std::vector<double> height;        // trace nodes: least height over a boundary face of the ideal cells at it

    // ideal: node_count x dim positions of the ideal mesh.
    TraceSpace(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target);

    // Restricted to the nodes of some elements, in their numbers: rows of M are whole where nodes move, and have no
    // entries between others. It has no faces.
    TraceSpace(const TraceSpace& whole, const Restriction& around);

    // The entries of a function on `whole`, or of another array per trace node, at the nodes of this space.
    template <class Array>
    Array restricted(const Array& whole) const {
        const std::size_t entries = whole.size() / std::max<std::size_t>(1, whole_count_);
        Array here;
        for (const int t : in_whole_)
            here.insert(here.end(), whole.begin() + offset(t, entries), whole.begin() + offset(t + 1, entries));
        return here;
    }

    int count() const { return M.n; }
    std::size_t size() const { return nodes.size() * dim; }  // of a function

    // Quadrature weight of a point on the reference face, times the area element over |f| (simplices: times 1).
    double weight(const FaceRule& rule, int f, int q) const {
        return density_.empty() ? rule.quadrature.weight[q] : rule.quadrature.weight[q] * density_[rule.sample(f, q)];
    }

    double product(const std::vector<double>& u, const std::vector<double>& v) const;  // (u, v)

    // (mu r / |1| - lambda) / |1|: M times that is the derivative of the constraint's part of E with respect to r.
    std::vector<double> force_density(std::vector<double> r, const std::vector<double>& lambda, double mu) const;

    // The n = dim entries of M v at a trace node.
    template <int n>
    void mass_times(const std::vector<double>& v, int trace_node, double* Mv) const {
        std::fill_n(Mv, n, 0.0);
        for (int k = M.row[trace_node]; k < M.row[trace_node + 1]; ++k)
            for (int a = 0; a < n; ++a) Mv[a] += M.value[k] * v[offset(M.col[k], n, a)];
    }

    // |x - y| at the trace nodes, x: mesh nodes x dim.
    std::vector<double> distances(const std::vector<double>& x, const std::vector<double>& y) const;

    // The target at the nodes, and its projection, M g_h = (N, g_D), with the nodes of fixed boundaries held there.
    std::vector<double> interpolation(const Mesh& mesh, const BoundaryTarget& target) const;
    std::vector<double> projection(const Mesh& mesh, const BoundaryTarget& target) const;

private:
    std::vector<int> in_whole_;    // trace node -> that of the whole
    std::size_t whole_count_ = 0;
    std::vector<double> measure_;  // |f|
    std::vector<double> density_;  // sample: area element over |f|, 1 on simplices; empty where all faces are simplices

    double measure(const Mesh& mesh, const std::vector<double>& ideal, const FaceRule& rule, int f);
    void number_nodes(const Mesh& mesh);
    void measure_heights(const Mesh& mesh, const std::vector<double>& ideal);
    void assemble_mass(const Mesh& mesh, const BoundaryTarget& target);
    std::vector<double> products(const FaceRule& rule, int f, int m) const;
};

}  // namespace almesh
