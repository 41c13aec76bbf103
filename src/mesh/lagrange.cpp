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

}  // namespace

LagrangeBasis::LagrangeBasis(int dim_, int degree_) : LagrangeBasis(simplex(dim_), degree_) {}

LagrangeBasis::LagrangeBasis(const CellType& cell_, int degree_)
    : cell(cell_),
      dim(cell_.dim),
      degree(degree_),
      count(cell_.node_count(degree_)),
      nodes(gmsh_node_order(cell_, degree_)) {}

std::array<double, 4> LagrangeBasis::coordinates(const double* xi) const {
    if (!cell.is_simplex()) return {1 - xi[0], xi[0], 1 - xi[1], xi[1]};
    std::array<double, 4> l = {1, 0, 0, 0};
    for (int k = 0; k < dim; ++k) {
        l[k + 1] = xi[k];
        l[0] -= xi[k];
    }
    return l;
}

std::array<double, 3> LagrangeBasis::point(int node) const {
    std::array<double, 3> xi{};
    for (int k = 0; k < dim; ++k)
        xi[k] = static_cast<double>(nodes[node][cell.is_simplex() ? k + 1 : 2 * k + 1]) / degree;
    return xi;
}

std::vector<double> LagrangeBasis::vertex_weights(int node) const {
    std::vector<double> weight(cell.vertices);
    LagrangeBasis(cell, 1).values(point(node).data(), weight.data());
    for (int v = 0; v < cell.vertices; ++v) weight[v] = cell.is_simplex() ? nodes[node][v] : degree * weight[v];
    return weight;
}

void LagrangeBasis::values(const double* xi, double* N) const {
    const std::array<double, 4> l = coordinates(xi);
    for (int i = 0; i < count; ++i) {
        N[i] = 1;
        for (int k = 0; k < entries(); ++k) N[i] *= silvester(nodes[i][k], degree * l[k]);
    }
}

void LagrangeBasis::gradients(const double* xi, double* dN) const {
    const std::array<double, 4> l = coordinates(xi);
    for (int i = 0; i < count; ++i) {
        double dl[4];  // derivatives by the coordinates l, taken as independent
        for (int k = 0; k < entries(); ++k) {
            dl[k] = degree * silvester_derivative(nodes[i][k], degree * l[k]);
            for (int m = 0; m < entries(); ++m)
                if (m != k) dl[k] *= silvester(nodes[i][m], degree * l[m]);
        }
        for (int k = 0; k < dim; ++k)
            dN[i * dim + k] = cell.is_simplex() ? dl[k + 1] - dl[0] : dl[2 * k + 1] - dl[2 * k];
    }
}

int LagrangeBasis::find(const MultiIndex& a) const {
    const auto it = std::find(nodes.begin(), nodes.end(), a);
    return it == nodes.end() ? -1 : static_cast<int>(it - nodes.begin());
}

int LagrangeBasis::permuted_node(int node, const MultiIndex& permutation) const {
    MultiIndex b{};
    for (int k = 0; k < entries(); ++k) b[k] = nodes[node][permutation[k]];
    return find(b);
}

std::vector<int> LagrangeBasis::face_nodes(int k) const {
    const CellFace& vertex = cell.faces[k];
    std::vector<int> local;
    for (const MultiIndex& b : gmsh_node_order(dim - 1, degree)) {
        MultiIndex a{};  // the mean of the vertices with the weights b
        for (int v = 0; v < dim; ++v)
            for (int e = 0; e < entries(); ++e) a[e] += b[v] * nodes[vertex[v]][e] / degree;
        local.push_back(find(a));
    }
    return local;
}

std::vector<std::vector<int>> LagrangeBasis::face_nodes() const {
    std::vector<std::vector<int>> of_faces;
    for (int k = 0; k < static_cast<int>(cell.faces.size()); ++k) of_faces.push_back(face_nodes(k));
    return of_faces;
}

}  // namespace almesh
