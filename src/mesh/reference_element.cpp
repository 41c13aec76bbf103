#include "mesh/reference_element.hpp"

#include <cstddef>

#include "mesh/lagrange.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

int default_exactness(int degree) { return degree == 1 ? 0 : 2 * degree + 2; }

namespace {

// Elements of degree p > 1 fold at vertices and edges first, where the quadrature has no points: a part `node_part` of
// the weight goes to the nodes, where the distortion then stops them as it does inside.
constexpr double node_part = 0.001;

void add_node_points(const LagrangeBasis& basis, Quadrature& quadrature) {
    double volume = 0;
    for (double& weight : quadrature.weight) {
        volume += weight;
        weight *= 1 - node_part;
    }
    for (const MultiIndex& a : basis.nodes)
        for (int k = 1; k <= basis.dim; ++k) quadrature.xi.push_back(static_cast<double>(a[k]) / basis.degree);
    quadrature.weight.insert(quadrature.weight.end(), basis.count, node_part * volume / basis.count);
    quadrature.count += basis.count;
}

}  // namespace

ReferenceElement reference_element(int dim, int degree, int exactness) {
    const LagrangeBasis basis(dim, degree);
    const bool by_default = exactness == 0 || degree == 1;
    Quadrature quadrature = simplex_quadrature(dim, by_default ? default_exactness(degree) : exactness);
    if (degree > 1) add_node_points(basis, quadrature);
    ReferenceElement element{degree, basis.count, quadrature.count, quadrature.weight, {}};
    const std::size_t stride = static_cast<std::size_t>(basis.count) * dim;
    element.gradients.resize(stride * quadrature.count);
    for (int q = 0; q < quadrature.count; ++q) basis.gradients(&quadrature.xi[q * dim], &element.gradients[stride * q]);
    return element;
}

}  // namespace almesh
