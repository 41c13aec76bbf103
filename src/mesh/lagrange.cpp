#include "mesh/lagrange.hpp"

#include <algorithm>

namespace almesh {

namespace {

// Vertex pairs of the edges and triples of the faces, in Gmsh's order.
constexpr int triangle_edges[3][2] = {{0, 1}, {1, 2}, {2, 0}};
constexpr int tetrahedron_edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};
constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {3, 1, 2}};

// The vertices' multi-indices are `corner`; appends all nodes of the simplex they span, at lattice distance p.
void append_nodes(int dim, int p, const std::array<MultiIndex, 4>& corner, std::vector<MultiIndex>& out) {
    // `steps` lattice steps from a towards b.
    const auto towards = [p](const MultiIndex& a, const MultiIndex& b, int steps) {
        MultiIndex r = a;
        for (int k = 0; k < 4; ++k) r[k] += (b[k] - a[k]) / p * steps;
        return r;
    };
    if (p == 0) {
        out.push_back(corner[0]);
        return;
    }
    for (int v = 0; v <= dim; ++v) out.push_back(corner[v]);
    const auto append_edge = [&](int a, int b) {
        for (int s = 1; s < p; ++s) out.push_back(towards(corner[a], corner[b], s));
    };
    // The interior of the face (a, b, c) is a triangle of degree p - 3, one lattice step inside each edge.
    const auto append_interior = [&](int a, int b, int c) {
        if (p < 3) return;
        std::array<MultiIndex, 4> in{};
        const int vertex[3] = {a, b, c};
        for (int k = 0; k < 3; ++k) {
            const int u = vertex[k], v = vertex[(k + 1) % 3], w = vertex[(k + 2) % 3];
            MultiIndex r = towards(corner[u], corner[v], 1);
            for (int m = 0; m < 4; ++m) r[m] += (corner[w][m] - corner[u][m]) / p;
            in[k] = r;
        }
        append_nodes(2, p - 3, in, out);
    };
    if (dim == 1) append_edge(0, 1);
    if (dim == 2) {
        for (const auto& e : triangle_edges) append_edge(e[0], e[1]);
        append_interior(0, 1, 2);
    }
    if (dim == 3) {
        for (const auto& e : tetrahedron_edges) append_edge(e[0], e[1]);
        for (const auto& f : tetrahedron_faces) append_interior(f[0], f[1], f[2]);
        if (p < 4) return;
        std::array<MultiIndex, 4> in{};
        for (int v = 0; v < 4; ++v) {
            in[v] = corner[v];
            for (int w = 0; w < 4; ++w)
                for (int m = 0; m < 4; ++m)
                    if (w != v) in[v][m] += (corner[w][m] - corner[v][m]) / p;
        }
        append_nodes(3, p - 4, in, out);
    }
}

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

std::vector<MultiIndex> gmsh_node_order(int dim, int degree) {
    std::array<MultiIndex, 4> corner{};
    for (int v = 0; v <= dim; ++v) corner[v][v] = degree;
    std::vector<MultiIndex> nodes;
    append_nodes(dim, degree, corner, nodes);
    return nodes;
}

LagrangeBasis::LagrangeBasis(int dim_, int degree_)
    : dim(dim_), degree(degree_), count(simplex_node_count(dim_, degree_)), nodes(gmsh_node_order(dim_, degree_)) {}

void LagrangeBasis::values(const double* xi, double* N) const {
    double l[4] = {1, 0, 0, 0};
    for (int k = 0; k < dim; ++k) {
        l[k + 1] = xi[k];
        l[0] -= xi[k];
    }
    for (int i = 0; i < count; ++i) {
        N[i] = 1;
        for (int k = 0; k <= dim; ++k) N[i] *= silvester(nodes[i][k], degree * l[k]);
    }
}

void LagrangeBasis::gradients(const double* xi, double* dN) const {
    double l[4] = {1, 0, 0, 0};
    for (int k = 0; k < dim; ++k) {
        l[k + 1] = xi[k];
        l[0] -= xi[k];
    }
    for (int i = 0; i < count; ++i) {
        double dl[4];  // derivative with respect to each barycentric coordinate, as if they were independent
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

std::array<int, 3> outward_face(int dim, int opposite) {
    if (dim == 2) return {(opposite + 1) % 3, (opposite + 2) % 3, -1};
    constexpr int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    return {face[opposite][0], face[opposite][1], face[opposite][2]};
}

std::vector<int> LagrangeBasis::face_nodes(int opposite) const {
    const std::array<int, 3> vertex = outward_face(dim, opposite);
    std::vector<int> local;
    for (const MultiIndex& b : gmsh_node_order(dim - 1, degree)) {
        MultiIndex a{};
        for (int k = 0; k < dim; ++k) a[vertex[k]] = b[k];
        local.push_back(find(a));
    }
    return local;
}

}  // namespace almesh
