// Silvester's formula: N_a = prod_k P_{a_k}(p l_k). By the product rule
// dN_a / dl_k = p P'_{a_k}(p l_k) prod_{m != k} P_{a_m}(p l_m), and by l_0 = 1 - sum xi
// dN_a / dxi_k = dN_a / dl_{k+1} - dN_a / dl_0.
#include "mesh/lagrange.hpp"

#include <algorithm>
#include <array>

namespace almesh {
namespace {

// P_m(t) = t (t-1) ... (t-m+1) / m! and its derivative.
double silvester(int m, double t) {
    double value = 1;
    for (int j = 0; j < m; ++j) value *= (t - j) / (j + 1);
    return value;
}

double silvester_derivative(int m, double t) {
    double sum = 0;
    for (int skip = 0; skip < m; ++skip) {
        double product = 1.0 / (skip + 1);
        for (int j = 0; j < m; ++j)
            if (j != skip) product *= (t - j) / (j + 1);
        sum += product;
    }
    return sum;
}

std::array<double, 4> barycentric(const double* xi, int dim) {
    std::array<double, 4> l = {1, 0, 0, 0};
    for (int k = 0; k < dim; ++k) {
        l[k + 1] = xi[k];
        l[0] -= xi[k];
    }
    return l;
}

}  // namespace

LagrangeBasis::LagrangeBasis(int dim_, int degree_)
    : dim(dim_), degree(degree_), count(simplex_node_count(dim_, degree_)), nodes(gmsh_node_order(dim_, degree_)) {}

void LagrangeBasis::values(const double* xi, double* N) const {
    const std::array<double, 4> l = barycentric(xi, dim);
    for (int i = 0; i < count; ++i) {
        N[i] = 1;
        for (int k = 0; k <= dim; ++k) N[i] *= silvester(nodes[i][k], degree * l[k]);
    }
}

void LagrangeBasis::gradients(const double* xi, double* dN) const {
    const std::array<double, 4> l = barycentric(xi, dim);
    for (int i = 0; i < count; ++i) {
        double dl[4];  // derivatives by the barycentric coordinates, taken as independent
        for (int k = 0; k <= dim; ++k) {
            dl[k] = degree * silvester_derivative(nodes[i][k], degree * l[k]);
            for (int m = 0; m <= dim; ++m)
                if (m != k) dl[k] *= silvester(nodes[i][m], degree * l[m]);
        }
        for (int k = 0; k < dim; ++k) dN[i * dim + k] = dl[k + 1] - dl[0];
    }
}

int LagrangeBasis::find(const MultiIndex& a) const {
    const auto it = std::find(nodes.begin(), nodes.end(), a);
    return it == nodes.end() ? -1 : static_cast<int>(it - nodes.begin());
}

int LagrangeBasis::permuted_node(int node, const MultiIndex& permutation) const {
    MultiIndex b{};
    for (int k = 0; k <= dim; ++k) b[k] = nodes[node][permutation[k]];
    return find(b);
}

std::vector<int> LagrangeBasis::face_nodes(int opposite) const {
    const CellFace& vertex = simplex(dim).faces[opposite];
    std::vector<int> local;
    for (const MultiIndex& b : gmsh_node_order(dim - 1, degree)) {
        MultiIndex a{};
        for (int k = 0; k < dim; ++k) a[vertex[k]] = b[k];
        local.push_back(find(a));
    }
    return local;
}

std::vector<std::vector<int>> LagrangeBasis::face_nodes() const {
    std::vector<std::vector<int>> of_faces;
    for (int opposite = 0; opposite <= dim; ++opposite) of_faces.push_back(face_nodes(opposite));
    return of_faces;
}

}  // namespace almesh
