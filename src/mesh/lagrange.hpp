// Lagrange basis of degree p on the reference simplex of dimension 1, 2 or 3, with equispaced nodes in Gmsh's order.
//
// A node is a multi-index a = (a_0, ..., a_dim), sum a = p, at the barycentric coordinates l = a / p, where
// l_0 = 1 - sum xi and l_k = xi_{k-1}. Its basis function is the product over k of
// P_{a_k}(p l_k), P_m(t) = t (t-1) ... (t-m+1) / m!  (Silvester's formula; Karniadakis & Sherwin, sec. 3.2).
#pragma once
#include <vector>

#include "mesh/cells.hpp"

namespace almesh {

struct LagrangeBasis {
    int dim, degree, count;
    std::vector<MultiIndex> nodes;  // count multi-indices

    LagrangeBasis(int dim, int degree);

    // xi: dim coordinates. N: count values. dN: count x dim derivatives with respect to xi. Cost: O(count p) and
    // O(count p^2).
    void values(const double* xi, double* N) const;
    void gradients(const double* xi, double* dN) const;

    // Node whose multi-index is that of `node` with its barycentric entries permuted: b_k = a_{permutation[k]}.
    int permuted_node(int node, const MultiIndex& permutation) const;

    // Nodes on the face opposite vertex `opposite`, in the Gmsh order of a simplex of dimension dim - 1, oriented so
    // that the normal of the face points out of a positively oriented element; and those of all faces.
    std::vector<int> face_nodes(int opposite) const;
    std::vector<std::vector<int>> face_nodes() const;

    int find(const MultiIndex& a) const;  // index of a node, or -1
};

}  // namespace almesh
