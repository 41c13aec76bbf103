// Lagrange basis of degree p on the reference simplex of dimension 1, 2 or 3, or on the quadrilateral, with equispaced
// nodes in Gmsh's order.
//
// A node is a multi-index a = (a_0, ..., a_dim), sum a = p, at the barycentric coordinates l = a / p, where
// l_0 = 1 - sum xi and l_k = xi_{k-1}. Its basis function is the product over k of
// P_{a_k}(p l_k), P_m(t) = t (t-1) ... (t-m+1) / m!  (Silvester's formula; Karniadakis & Sherwin, sec. 3.2).
// A quadrilateral is a product of two lines: l = (1 - xi_0, xi_0, 1 - xi_1, xi_1), and the same product over all four.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct LagrangeBasis {
    const CellType& cell;
    int dim, degree, count;
    std::vector<MultiIndex> nodes;  // count multi-indices

    LagrangeBasis(int dim, int degree);
    LagrangeBasis(const CellType& cell, int degree);

    std::array<double, 3> point(int node) const;  // its reference coordinates
    // Of a node between the vertices: by which weights it is the mean of these in the straight-sided cell. Sum: degree.
    std::vector<double> vertex_weights(int node) const;

    // xi: dim coordinates. N: count values. dN: count x dim derivatives with respect to xi. Cost: O(count p) and
    // O(count p^2).
    void values(const double* xi, double* N) const;
    void gradients(const double* xi, double* dN) const;

    // Node whose multi-index is that of `node` with its entries permuted: b_k = a_{permutation[k]}.
    int permuted_node(int node, const MultiIndex& permutation) const;

    // Nodes on face k, in the Gmsh order of a simplex of dimension dim - 1, oriented so that the normal of the face
    // points out of a positively oriented element; and those of all faces.
    std::vector<int> face_nodes(int k) const;
    std::vector<std::vector<int>> face_nodes() const;

    int find(const MultiIndex& a) const;  // index of a node, or -1

private:
    int entries() const { return cell.is_simplex() ? dim + 1 : 4; }  // of a multi-index
    std::array<double, 4> coordinates(const double* xi) const;       // l
};

// Of the groups of elements.
inline std::vector<LagrangeBasis> bases_of(const Mesh& mesh) {
    std::vector<LagrangeBasis> bases;
    for (const ElementGroup& group : mesh.element_groups()) bases.emplace_back(*group.cell, mesh.degree);
    return bases;
}

}  // namespace almesh
