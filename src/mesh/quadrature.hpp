// Quadrature on the reference cells: all weights positive, all points inside, any degree of exactness; and the
// derivatives of the basis at the points, the same for all elements of one type.
//
// On triangles and tetrahedra the symmetric rules of quadrature_table.hpp as far as they go; beyond them, and on lines,
// the conical product of Gauss-Jacobi rules (Stroud, Approximate Calculation of Multiple Integrals, 1971, sec. 2.4),
// which takes about twice the points in 2D, three times in 3D. On other cells the product of the rules of their factors.
#pragma once
#include <vector>

#include "base/index.hpp"
#include "base/small_matrix.hpp"
#include "mesh/cells.hpp"

namespace almesh {

struct Quadrature {
    int dim = 0, count = 0;
    std::vector<double> xi;      // count x dim reference coordinates
    std::vector<double> weight;  // sum: volume of the reference cell, 1 / dim! of a simplex
    // Of a cell that is a product with a line: so many points of the base, running fastest, times those of the line are
    // its first ones; any others are at the nodes.
    int of_base = 0, of_line = 0;
};

// Integrates polynomials of total degree <= exactness without error. One point, the centroid, for exactness 0 and 1;
// ((exactness + 2) / 2)^dim points where the conical product is used.
Quadrature simplex_quadrature(int dim, int exactness);

// The same on a cell of any type; on a product of simplices for degree <= exactness in each factor. to_apex: of a
// pyramid, in its third coordinate.
Quadrature cell_quadrature(const CellType& cell, int exactness, int to_apex);
inline Quadrature cell_quadrature(const CellType& cell, int exactness) {
    return cell_quadrature(cell, exactness, exactness);
}

// Points and basis of a cell that is the product of a base and a line: node (b, z) has the basis function B_b L_z, and
// sums over the points (r, s) may be taken over s first (sum factorisation; Orszag, J. Comput. Phys. 37, 1980).
struct ProductPoints {
    int of_base = 0, of_line = 0;  // R, S
    std::vector<int> point;        // R x S, numbers in the rule
    std::vector<double> base;      // R x nodes of the base x n: derivatives of B_b, then B_b itself
    std::vector<double> line;      // S x (p + 1) x 2: L_z and its derivative
};

// Linear simplices (m = n + 1) have one point: F is constant on them.
struct ReferenceElement {
    const CellType* cell = nullptr;
    int degree = 0;                 // p
    int nodes = 0;                  // m
    int points = 0;
    std::vector<double> weight;     // points
    std::vector<double> gradients;  // points x nodes x dim, dN_i/dxi_k
    // points x simplex_node_count(dim, 2 p - 2): products of powers l_0^a_0 ... l_dim^a_dim of the barycentric
    // coordinates, a in gmsh_node_order(dim, 2 p - 2). Products of two gradients are sums of these. Simplices only.
    std::vector<double> monomials;
    // Of products of degree above 1: the points inside, and those at the nodes; node (b, z) is product_node[z R + b].
    std::vector<ProductPoints> products;
    std::vector<int> product_node;
};

// Of elements of degree p. exactness: degree to which it is exact, but for linear simplices; 0: default_exactness(p).
// But for these a thousandth of the weight goes to the nodes of the element: it folds at vertices and edges first,
// where the rules have no points. Linear cells that are no simplices have them too: their Jacobian is not constant. That
// of a linear pyramid is the same all the way from the base to the apex, where one point is enough.
Quadrature element_quadrature(const CellType& cell, int degree, int exactness);

ReferenceElement reference_element(const CellType& cell, int degree, const Quadrature& quadrature);

// Of simplices.
inline Quadrature element_quadrature(int dim, int degree, int exactness) {
    return element_quadrature(simplex(dim), degree, exactness);
}
inline ReferenceElement reference_element(int degree, const Quadrature& quadrature) {
    return reference_element(simplex(quadrature.dim), degree, quadrature);
}

// dx/dxi at point q of the element with these nodes. x: nodes x n.
template <int n>
Mat<n> jacobian_at(const int* node, const std::vector<double>& x, const ReferenceElement& reference, int q) {
    Mat<n> J{};
    for (int i = 1; i < reference.nodes; ++i)  // relative to the first node: the gradients' sum is zero
        for (int a = 0; a < n; ++a)
            for (int k = 0; k < n; ++k)
                J[a][k] += (x[offset(node[i], n, a)] - x[offset(node[0], n, a)]) *
                           reference.gradients[offset(q, reference.nodes * n, i * n + k)];
    return J;
}

// 2 p + 2, on products of simplices in each factor, but 0 for linear simplices: the relative quality then agrees to six
// digits with that of more points; with fewer points the worst elements get worse. |F|^2 alone needs 2 p - 2, on
// products of simplices 2 p.
int default_exactness(const CellType& cell, int degree);

}  // namespace almesh
