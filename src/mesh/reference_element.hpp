// Quadrature on the reference element with the derivatives of the basis there, the same for all elements of a mesh.
#pragma once
#include <vector>

namespace almesh {

// Linear elements (m = n + 1) have one point: F is constant on them.
struct ReferenceElement {
    int degree = 0;                 // p
    int nodes = 0;                  // m
    int points = 0;
    std::vector<double> weight;     // points
    std::vector<double> gradients;  // points x nodes x dim, dN_i/dxi_k
};

// exactness: degree to which the quadrature is exact for p > 1; 0: default_exactness(degree). For p > 1 a thousandth of
// the weight goes to the element's nodes: see add_node_points().
ReferenceElement reference_element(int dim, int degree, int exactness);

// With 2 p + 2 for p > 1 the relative quality has six digits of what more points give, and below it the worst elements
// suffer; |F|^2 alone needs 2 p - 2.
int default_exactness(int degree);

}  // namespace almesh
