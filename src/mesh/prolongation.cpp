// For each fine node: a fine element that has it, hence the coarse element around it; its reference coordinates there,
// rounded to the lattice on which they lie; the coarse basis at them.
#include "mesh/prolongation.hpp"

#include <cmath>

#include "base/parallel.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// For each node the last one of the elements that have it.
std::vector<int> element_of_nodes(const Mesh& mesh) {
    std::vector<int> element(mesh.nodes());
    const int count = mesh.element_nodes();
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int i = 0; i < count; ++i) element[mesh.element(e)[i]] = e;
    return element;
}

// Reference coordinates of the point y in the straight-sided element with the given vertices, on the lattice of
// 1/steps.
template <int n>
Vec<n> reference_point(const int* vertex, const std::vector<double>& ideal, const double* y, double steps) {
    const double* const y0 = point(ideal, vertex[0], n);
    const Mat<n> inverse_A = inverse<n>(straight_jacobian<n>(vertex, ideal));
    Vec<n> xi{};
    for (int k = 0; k < n; ++k) {
        for (int a = 0; a < n; ++a) xi[k] += inverse_A[k][a] * (y[a] - y0[a]);
        xi[k] = std::round(xi[k] * steps) / steps;
    }
    return xi;
}

}  // namespace

std::vector<double> prolong(const Mesh& coarse, const std::vector<double>& coarse_ideal, const Mesh& fine,
                            const std::vector<double>& fine_ideal, const std::vector<double>& field) {
    const LagrangeBasis basis(coarse.dim, coarse.degree);
    const std::vector<int> element = element_of_nodes(fine);
    const int children = fine.element_count() / coarse.element_count();  // those of e are numbered from e * children
    const double steps = std::round(std::pow(children, 1.0 / coarse.dim)) * fine.degree;
    std::vector<double> result(fine_ideal.size());
    with_dimension(coarse.dim, [&](auto dimension) {
        constexpr int n = dimension;
        parallel_for(fine.nodes(), [&](int i) {
            const int* const node = coarse.element(element[i] / children);
            const std::size_t at = offset(i, n);
            const Vec<n> xi = reference_point<n>(node, coarse_ideal, &fine_ideal[at], steps);
            double N[simplex_node_count(n, max_degree)];
            basis.values(xi.data(), N);
            for (int j = 0; j < basis.count; ++j)
                for (int a = 0; a < n; ++a) result[at + a] += N[j] * field[offset(node[j], n, a)];
        });
    });
    return result;
}

}  // namespace almesh
