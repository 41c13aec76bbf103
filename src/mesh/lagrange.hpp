// Lagrange basis of degree p on a cell of any type, with equispaced nodes in Gmsh's order.
//
// On a simplex, a node is a multi-index a = (a_0, ..., a_dim), sum a = p, at the barycentric coordinates l = a / p, where
// l_0 = 1 - sum xi and l_k = xi_{k-1}. Its basis function is the product over k of
// P_{a_k}(p l_k), P_m(t) = t (t-1) ... (t-m+1) / m!  (Silvester's formula; Karniadakis & Sherwin, sec. 3.2).
// On a product of simplices l is the coordinates of one factor after the other, of a quadrilateral
// (1 - xi_0, xi_0, 1 - xi_1, xi_1), and the same product goes over all. On a pyramid (cells.hpp) N = V^-T B, with
//
//     B_ijk(a, b, c) = B_i^m(a) B_j^m(b) B_k^p(c),   m = p - k,   V_ij = B_j(node i),
//
// B_i^m the Bernstein polynomials of degree m: the pyramid's own Bernstein form, with an index for each node.
#pragma once
#include <array>
#include <vector>

#include "mesh/cells.hpp"

namespace almesh {

struct ElementGroup;

struct LagrangeBasis {
    const CellType& cell;
    int dim, degree, count;
    std::vector<MultiIndex> nodes;  // count multi-indices

    LagrangeBasis(int dim, int degree);
    LagrangeBasis(const CellType& cell, int degree);

    std::array<double, 3> point(int node) const;  // its reference coordinates
    // Of a node between the vertices: by which weights it is the mean of these in the straight-sided cell. Sum: degree.
    std::vector<double> vertex_weights(int node) const;

    // xi: dim coordinates. N: count values. dN: count x dim derivatives with respect to xi, reduced ones of a pyramid.
    // Cost: O(count), of a pyramid O(count^2).
    void values(const double* xi, double* N) const;
    void gradients(const double* xi, double* dN) const;

    // Node whose multi-index is that of `node` with its entries permuted: b_k = a_{permutation[k]}.
    int permuted_node(int node, const MultiIndex& permutation) const;

    // The multi-index that is the mean of those of some vertices, with these weights.
    MultiIndex mean(const std::array<int, 8>& weights, const int* vertices) const;

    // Nodes of the face or edge with these vertices, where it has these multi-indices.
    std::vector<int> nodes_of(const CellType& part, const std::vector<MultiIndex>& order, const int* vertices) const;

    // Nodes on face k, in the Gmsh order of its type, oriented so that the normal of the face
    // points out of a positively oriented element.
    std::vector<int> face_nodes(int k) const;

    int find(const MultiIndex& a) const;  // index of a node, or -1

    // Of a pyramid, V^-1, count x count: the coefficients of its own Bernstein form are c = V^-1 x of values x at nodes.
    const std::vector<double>& to_bernstein() const { return to_bernstein_; }

private:
    int entries() const { return cell.entries(); }
    std::array<double, 6> coordinates(const double* xi) const;  // l
    void invert_pyramid();
    // d: 0 of B itself, 1 to 3 of its reduced derivative by coordinate d - 1. count values.
    std::vector<double> pyramid_form(const double* xi, int d) const;
    // The same of N: value i at to[i * stride].
    void pyramid_values(const double* xi, int d, double* to, int stride) const;
    std::vector<double> to_bernstein_;
};

// Of the groups of elements or faces, of one type each.
std::vector<LagrangeBasis> bases_of(const std::vector<ElementGroup>& groups, int degree);

}  // namespace almesh
