// Silvester's formula: N_a = prod_k P_{a_k}(p l_k). By the product rule
// dN_a / dl_k = p P'_{a_k}(p l_k) prod_{m != k} P_{a_m}(p l_m), and by l_0 = 1 - sum xi
// dN_a / dxi_k = dN_a / dl_{k+1} - dN_a / dl_0.
#include "mesh/lagrange.hpp"

#include <algorithm>
#include <numeric>

#include "base/index.hpp"
#include "linalg/dense_solve.hpp"
#include "mesh/mesh.hpp"

namespace almesh {
namespace {

// P_m(t) = t (t-1) ... (t-m+1) / m! of all m up to the degree, and the derivatives: sums over the factor left out.
struct Silvester {
    double value[2 * max_degree + 1], derivative[2 * max_degree + 1];

    void evaluate(int degree, double t) {
        double factor[2 * max_degree];
        value[0] = 1;
        for (int j = 0; j < degree; ++j) {
            factor[j] = (t - j) / (j + 1);
            value[j + 1] = value[j] * factor[j];
        }
        std::fill_n(derivative, degree + 1, 0.0);
        for (int out = 0; out < degree; ++out) {
            double product = 1.0 / (out + 1);
            for (int j = 0; j < out; ++j) product *= factor[j];
            derivative[out + 1] += product;
            for (int j = out + 1; j < degree; ++j) derivative[j + 1] += product *= factor[j];
        }
    }
};

// Of each of the coordinates l.
struct SilvesterTable {
    Silvester of[6];
    int entries;

    SilvesterTable(const LagrangeBasis& basis, const std::array<double, 6>& l) : entries(basis.cell.entries()) {
        for (int k = 0; k < entries; ++k) of[k].evaluate(basis.degree, basis.degree * l[k]);
    }
};

// B_i of degree m at t, and its derivative; zero for i < 0 and i > m.
double bernstein(int m, int i, double t) {
    if (i < 0 || i > m) return 0;
    double value = 1;
    for (int k = 0; k < i; ++k) value *= t * (m - k) / (k + 1);
    for (int k = i; k < m; ++k) value *= 1 - t;
    return value;
}

double bernstein_derivative(int m, int i, double t) {
    return m * (bernstein(m - 1, i - 1, t) - bernstein(m - 1, i, t));
}

}  // namespace

LagrangeBasis::LagrangeBasis(int dim_, int degree_) : LagrangeBasis(simplex(dim_), degree_) {}

LagrangeBasis::LagrangeBasis(const CellType& cell_, int degree_)
    : cell(cell_),
      dim(cell_.dim),
      degree(degree_),
      count(cell_.node_count(degree_)),
      nodes(gmsh_node_order(cell_, degree_)) {
    if (cell.is_collapsed) invert_pyramid();
}

std::array<double, 6> LagrangeBasis::coordinates(const double* xi) const {
    std::array<double, 6> l{};
    for (int k = 0; k < dim; ++k) {
        const auto [factor, from, to] = cell.coordinate(k);
        if (to == from + 1) l[from] = 1;
        l[to] = xi[k];
        l[from] -= xi[k];
    }
    return l;
}

std::array<double, 3> LagrangeBasis::point(int node) const {
    const MultiIndex& a = nodes[node];
    if (cell.is_collapsed) {
        const int m = std::max(degree - a[4], 1);
        return {static_cast<double>(a[1]) / m, static_cast<double>(a[3]) / m, static_cast<double>(a[4]) / degree};
    }
    std::array<double, 3> xi{};
    for (int k = 0; k < dim; ++k) xi[k] = static_cast<double>(a[cell.coordinate(k).to]) / degree;
    return xi;
}

void LagrangeBasis::invert_pyramid() {
    std::vector<double> V, unit(offset(count, count));
    for (int i = 0; i < count; ++i) {
        const std::vector<double> row = pyramid_form(point(i).data(), 0);
        V.insert(V.end(), row.begin(), row.end());
        unit[offset(i, count, i)] = 1;
    }
    solve_dense(std::move(V), std::move(unit), to_bernstein_);
}

std::vector<double> LagrangeBasis::pyramid_form(const double* xi, int d) const {
    std::vector<double> B;
    for (const MultiIndex& node : nodes) {
        const int i = node[1], j = node[3], k = node[4], p = degree, m = p - k;
        const auto factor = [m](bool along, int index, double t) {
            return along ? bernstein_derivative(m, index, t) : bernstein(m, index, t);
        };
        // m B_k^p(c) / (1 - c) = p B_k^{p-1}(c)
        const double along_c = d == 0   ? bernstein(p, k, xi[2])
                               : d == 3 ? bernstein_derivative(p, k, xi[2])
                                        : bernstein(p - 1, k, xi[2]) * p / std::max(m, 1);
        B.push_back(factor(d == 1, i, xi[0]) * factor(d == 2, j, xi[1]) * along_c);
    }
    return B;
}

void LagrangeBasis::pyramid_values(const double* xi, int d, double* to, int stride) const {
    const std::vector<double> B = pyramid_form(xi, d);
    for (int i = 0; i < count; ++i) {
        to[i * stride] = 0;
        for (int k = 0; k < count; ++k) to[i * stride] += to_bernstein_[offset(k, count, i)] * B[k];
    }
}

std::vector<double> LagrangeBasis::vertex_weights(int node) const {
    const std::array<int, 8> whole = almesh::vertex_weights(cell, nodes[node]);
    const int sum = std::accumulate(whole.begin(), whole.end(), 0);
    std::vector<double> weight;
    for (int v = 0; v < cell.vertices; ++v) weight.push_back(static_cast<double>(degree * whole[v]) / sum);
    return weight;
}

void LagrangeBasis::values(const double* xi, double* N) const {
    if (cell.is_collapsed) return pyramid_values(xi, 0, N, 1);
    const SilvesterTable P(*this, coordinates(xi));
    for (int i = 0; i < count; ++i) {
        N[i] = 1;
        for (int k = 0; k < P.entries; ++k) N[i] *= P.of[k].value[nodes[i][k]];
    }
}

void LagrangeBasis::gradients(const double* xi, double* dN) const {
    for (int d = 0; d < 3 && cell.is_collapsed; ++d) pyramid_values(xi, d + 1, dN + d, 3);
    if (cell.is_collapsed) return;
    const SilvesterTable P(*this, coordinates(xi));
    for (int i = 0; i < count; ++i) {
        double dl[6];  // derivatives by the coordinates l, taken as independent
        for (int k = 0; k < P.entries; ++k) {
            dl[k] = degree * P.of[k].derivative[nodes[i][k]];
            for (int m = 0; m < P.entries; ++m)
                if (m != k) dl[k] *= P.of[m].value[nodes[i][m]];
        }
        for (int k = 0; k < dim; ++k) {
            const auto [factor, from, to] = cell.coordinate(k);
            dN[i * dim + k] = dl[to] - dl[from];
        }
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

MultiIndex LagrangeBasis::mean(const std::array<int, 8>& weights, const int* vertices) const {
    MultiIndex mean{};
    for (std::size_t v = 0; v < weights.size(); ++v)
        for (std::size_t k = 0; k < mean.size() && weights[v] > 0; ++k) mean[k] += weights[v] * nodes[vertices[v]][k];
    const int sum = std::accumulate(weights.begin(), weights.end(), 0);
    for (int& entry : mean) entry /= sum;
    return mean;
}

std::vector<int> LagrangeBasis::nodes_of(const CellType& part, const std::vector<MultiIndex>& order,
                                         const int* vertices) const {
    std::vector<int> local;
    for (const MultiIndex& a : order) local.push_back(find(mean(almesh::vertex_weights(part, a), vertices)));
    return local;
}

std::vector<int> LagrangeBasis::face_nodes(int k) const {
    return nodes_of(cell.face_type(k), gmsh_node_order(cell.face_type(k), degree), cell.faces[k].data());
}

std::vector<LagrangeBasis> bases_of(const std::vector<ElementGroup>& groups, int degree) {
    std::vector<LagrangeBasis> bases;
    for (const ElementGroup& group : groups) bases.emplace_back(*group.cell, degree);
    return bases;
}

}  // namespace almesh
