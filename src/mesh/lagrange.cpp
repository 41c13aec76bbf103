// Silvester's formula: N_a = prod_k P_{a_k}(p l_k). By the product rule
// dN_a / dl_k = p P'_{a_k}(p l_k) prod_{m != k} P_{a_m}(p l_m), and by l_0 = 1 - sum xi
// dN_a / dxi_k = dN_a / dl_{k+1} - dN_a / dl_0.
#include "mesh/lagrange.hpp"

#include <algorithm>
#include <array>

#include "base/index.hpp"
#include "linalg/dense_solve.hpp"

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
    for (int f = 0, at = 0; f < 3 && cell.factors[f] > 0; at += cell.factors[f++] + 1) {
        l[at] = 1;
        for (int k = 1; k <= cell.factors[f]; ++k) {
            l[at + k] = *xi++;
            l[at] -= l[at + k];
        }
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
    for (int f = 0, at = 0, next = 0; f < 3 && cell.factors[f] > 0; at += cell.factors[f++] + 1)
        for (int k = 1; k <= cell.factors[f]; ++k) xi[next++] = static_cast<double>(a[at + k]) / degree;
    return xi;
}

void LagrangeBasis::invert_pyramid() {
    std::vector<double> transposed, column;
    for (int i = 0; i < count; ++i) {
        const std::vector<double> row = pyramid_form(point(i).data(), 0);
        transposed.insert(transposed.end(), row.begin(), row.end());
    }
    to_bernstein_.resize(offset(count, count));
    for (int i = 0; i < count; ++i) {
        std::vector<double> unit(count);
        unit[i] = 1;
        solve_dense(transposed, unit, column);
        for (int k = 0; k < count; ++k) to_bernstein_[offset(k, count, i)] = column[k];
    }
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

std::vector<double> LagrangeBasis::vertex_weights(int node) const {
    std::vector<double> weight(cell.vertices);
    LagrangeBasis(cell, 1).values(point(node).data(), weight.data());
    for (int v = 0; v < cell.vertices; ++v) weight[v] = cell.is_simplex() ? nodes[node][v] : degree * weight[v];
    return weight;
}

void LagrangeBasis::values(const double* xi, double* N) const {
    if (cell.is_collapsed) {
        std::fill_n(N, count, 0.0);
        const std::vector<double> B = pyramid_form(xi, 0);
        for (int k = 0; k < count; ++k)
            for (int i = 0; i < count; ++i) N[i] += to_bernstein_[offset(k, count, i)] * B[k];
        return;
    }
    const SilvesterTable P(*this, coordinates(xi));
    for (int i = 0; i < count; ++i) {
        N[i] = 1;
        for (int k = 0; k < P.entries; ++k) N[i] *= P.of[k].value[nodes[i][k]];
    }
}

void LagrangeBasis::gradients(const double* xi, double* dN) const {
    if (cell.is_collapsed) {
        std::fill_n(dN, 3 * count, 0.0);
        for (int d = 0; d < 3; ++d) {
            const std::vector<double> B = pyramid_form(xi, d + 1);
            for (int k = 0; k < count; ++k)
                for (int i = 0; i < count; ++i) dN[3 * i + d] += to_bernstein_[offset(k, count, i)] * B[k];
        }
        return;
    }
    const SilvesterTable P(*this, coordinates(xi));
    for (int i = 0; i < count; ++i) {
        double dl[6];  // derivatives by the coordinates l, taken as independent
        for (int k = 0; k < P.entries; ++k) {
            dl[k] = degree * P.of[k].derivative[nodes[i][k]];
            for (int m = 0; m < P.entries; ++m)
                if (m != k) dl[k] *= P.of[m].value[nodes[i][m]];
        }
        double* to = &dN[i * dim];
        for (int f = 0, at = 0; f < 3 && cell.factors[f] > 0; at += cell.factors[f++] + 1)
            for (int k = 1; k <= cell.factors[f]; ++k) *to++ = dl[at + k] - dl[at];
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
    const LagrangeBasis face(cell.face_type(k), degree);
    std::vector<int> local;
    for (int i = 0; i < face.count; ++i) {
        const std::vector<double> weight = face.vertex_weights(i);
        std::array<double, 6> mean{};  // of the vertices' multi-indices
        for (int v = 0; v < face.cell.vertices; ++v)
            for (int e = 0; e < entries(); ++e) mean[e] += weight[v] * nodes[vertex[v]][e] / degree;
        MultiIndex a;
        std::transform(mean.begin(), mean.end(), a.begin(), [](double m) { return static_cast<int>(m + 0.5); });
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
