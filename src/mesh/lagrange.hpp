// Lagrange basis of degree p on the reference simplex {xi >= 0, sum xi <= 1} of dimension 1, 2 or 3, with equispaced
// nodes in Gmsh's order: vertices, edge interiors, face interiors, volume interior, the last two recursively.
//
// A node is a multi-index a = (a_0, ..., a_dim), sum a = p, at the barycentric coordinates l = a / p, where
// l_0 = 1 - sum xi and l_k = xi_{k-1}. Its basis function is the product over k of
// P_{a_k}(p l_k), P_m(t) = t (t-1) ... (t-m+1) / m!  (Silvester's formula; Karniadakis & Sherwin, sec. 3.2).
#pragma once
#include <array>
#include <vector>

namespace almesh {

using MultiIndex = std::array<int, 4>;  // a_0 .. a_dim; entries beyond dim are zero

// binomial(degree + dim, dim). Asked for at every element of a loop: inline, divisions by constants are
// multiplications.
constexpr int simplex_node_count(int dim, int degree) {
    if (dim == 3) return (degree + 1) * (degree + 2) * (degree + 3) / 6;
    if (dim == 2) return (degree + 1) * (degree + 2) / 2;
    return dim == 1 ? degree + 1 : 1;
}

// Multi-indices of the nodes in Gmsh's order.
std::vector<MultiIndex> gmsh_node_order(int dim, int degree);

struct LagrangeBasis {
    int dim, degree, count;
    std::vector<MultiIndex> nodes;  // count multi-indices

    LagrangeBasis(int dim, int degree);

    // xi: dim coordinates. N: count values. dN: count x dim derivatives with respect to xi.
    void values(const double* xi, double* N) const;
    void gradients(const double* xi, double* dN) const;

    // Node whose multi-index is that of `node` with its barycentric entries permuted: b_k = a_{permutation[k]}.
    int permuted_node(int node, const MultiIndex& permutation) const;

    // Nodes that lie on the face opposite vertex `opposite`, in the Gmsh order of a simplex of dimension dim-1, seen
    // so that the face normal points out of a positively oriented element.
    std::vector<int> face_nodes(int opposite) const;

    int find(const MultiIndex& a) const;  // index of a node, or -1
};

// Local vertices of the face opposite vertex `opposite`, oriented outward (2D: domain on the left).
std::array<int, 3> outward_face(int dim, int opposite);

}  // namespace almesh
