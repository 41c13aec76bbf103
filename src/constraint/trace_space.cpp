#include "constraint/trace_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/small_matrix.hpp"
#include "linalg/direct/cholesky.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// Length of the edge or area of the triangle spanned by the face's vertices.
double face_measure(const Mesh& mesh, const std::vector<double>& ideal, int f) {
    const auto edge = [&](int v, int a) {
        return ideal[offset(mesh.face(f)[v], mesh.dim, a)] - ideal[offset(mesh.face(f)[0], mesh.dim, a)];
    };
    if (mesh.dim == 2) return std::hypot(edge(1, 0), edge(1, 1));
    const double n0 = edge(1, 1) * edge(2, 2) - edge(1, 2) * edge(2, 1),
                 n1 = edge(1, 2) * edge(2, 0) - edge(1, 0) * edge(2, 2),
                 n2 = edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0);
    return 0.5 * std::sqrt(n0 * n0 + n1 * n1 + n2 * n2);
}

}  // namespace

TraceSpace::TraceSpace(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target)
    : dim(mesh.dim) {
    const LagrangeBasis basis(mesh.dim - 1, mesh.degree);
    face_values.resize(offset(target.quadrature.count, basis.count));
    for (int q = 0; q < target.quadrature.count; ++q)
        basis.values(&target.quadrature.xi[q * (mesh.dim - 1)], &face_values[offset(q, basis.count)]);
    face_weight.resize(mesh.face_count());
    double one_squared = 0;
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (target.hold_of_face(mesh, f) == BoundaryHold::free) continue;
        const double measure = face_measure(mesh, ideal, f), h = mesh.dim == 2 ? measure : std::sqrt(measure);
        one_squared += measure / h;
        face_weight[f] = measure / h * (mesh.dim == 2 ? 1 : 2);
    }
    norm_of_one = std::sqrt(one_squared);
    number_nodes(mesh);
    measure_heights(mesh, ideal);
    assemble_mass(mesh, target.quadrature);
}

void TraceSpace::number_nodes(const Mesh& mesh) {
    std::vector<int> trace(mesh.nodes(), -1);
    for (int node : mesh.faces) trace[node] = 0;
    for (int node = 0; node < mesh.nodes(); ++node) {
        if (trace[node] < 0) continue;
        trace[node] = static_cast<int>(nodes.size());
        nodes.push_back(node);
    }
    faces.resize(mesh.faces.size());
    std::transform(mesh.faces.begin(), mesh.faces.end(), faces.begin(), [&](int node) { return trace[node]; });
}

void TraceSpace::measure_heights(const Mesh& mesh, const std::vector<double>& ideal) {
    const int m = mesh.face_nodes();
    height.assign(nodes.size(), std::numeric_limits<double>::infinity());
    with_dimension(mesh.dim, [&](auto n) {
        for (int f = 0; f < mesh.face_count(); ++f) {
            const int e = mesh.face_element[f];
            const double volume = mesh.cell(e).is_simplex() ? determinant(straight_jacobian<n>(mesh.element(e), ideal))
                                                            : almesh::volume(mesh, ideal, e);
            const double measure = face_measure(mesh, ideal, f);
            // where a curved ideal element has vertices that span no volume: the size of the face
            const double of_face = volume > 0        ? volume / ((mesh.dim - 1) * measure)
                                   : mesh.dim == 2 ? measure
                                                   : std::sqrt(measure);
            for (int i = 0; i < m; ++i) {
                double& least = height[faces[offset(f, m, i)]];
                least = std::min(least, of_face);
            }
        }
    });
}

void TraceSpace::assemble_mass(const Mesh& mesh, const Quadrature& quadrature) {
    const int m = mesh.face_nodes();
    std::vector<double> reference(m * m, 0.0);  // integrals of N_i N_j over the reference face
    for (int q = 0; q < quadrature.count; ++q)
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j)
                reference[i * m + j] +=
                    quadrature.weight[q] * face_values[offset(q, m, i)] * face_values[offset(q, m, j)];
    LargeVector<int> place;
    M = pattern_of_cells(static_cast<int>(nodes.size()), 1, faces, m, &place);
    M.value.assign(M.col.size(), 0.0);
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int ij = 0; ij < m * m; ++ij) M.value[place[offset(f, m * m, ij)]] += face_weight[f] * reference[ij];
}

double TraceSpace::product(const std::vector<double>& u, const std::vector<double>& v) const {
    constexpr double mass_work = 40;  // simple operations that a row of M takes
    double sum = 0;
    with_dimension(dim, [&](auto n) {
        sum = deterministic_sum(count(), [&](int t) {
            double Mv[n], of_node = 0;
            mass_times<n>(v, t, Mv);
            for (int a = 0; a < n; ++a) of_node += u[t * n + a] * Mv[a];
            return of_node;
        }, mass_work);
    });
    return sum;
}

std::vector<double> TraceSpace::force_density(std::vector<double> r, const std::vector<double>& lambda,
                                              double mu) const {
    for (std::size_t k = 0; k < r.size(); ++k) r[k] = (mu * r[k] / norm_of_one - lambda[k]) / norm_of_one;
    return r;
}

std::vector<double> TraceSpace::distances(const std::vector<double>& x, const std::vector<double>& y) const {
    std::vector<double> result(nodes.size());
    for (int t = 0; t < count(); ++t) {
        double squared = 0;
        for (int a = 0; a < dim; ++a) squared += std::pow(x[offset(nodes[t], dim, a)] - y[offset(t, dim, a)], 2);
        result[t] = std::sqrt(squared);
    }
    return result;
}

std::vector<double> TraceSpace::relative_distances(const std::vector<double>& x, const std::vector<double>& y) const {
    std::vector<double> result = distances(x, y);
    for (int t = 0; t < count(); ++t) result[t] /= height[t];
    return result;
}

std::vector<double> TraceSpace::interpolation(const Mesh& mesh, const BoundaryTarget& target) const {
    std::vector<double> g_h(size());
    for (std::size_t k = faces.size(); k-- > 0;)  // the first face that holds a node decides, as in target_check
        for (int a = 0; a < mesh.dim; ++a) g_h[offset(faces[k], mesh.dim, a)] = target.node[k * mesh.dim + a];
    return g_h;
}

// Solves M (g_h - y) = (N, g_D - y): relative to the ideal positions y, a boundary that stays has no rounding error.
std::vector<double> TraceSpace::projection(const Mesh& mesh, const std::vector<double>& ideal,
                                           const BoundaryTarget& target) const {
    const int m = mesh.face_nodes(), points = target.quadrature.count;
    Cholesky factorisation(M);
    if (factorisation.factor(M).status != SolveStatus::success)
        throw InputError(
            "the mass matrix of the boundary cannot be factored: a boundary face is degenerate or memory is short");
    const auto ideal_at = [&](int t, int a) { return ideal[offset(nodes[t], dim, a)]; };
    std::vector<double> right(nodes.size()), displacement(nodes.size()), g_h(size());
    for (int a = 0; a < dim; ++a) {
        std::fill(right.begin(), right.end(), 0.0);
        for (int f = 0; f < mesh.face_count(); ++f) {
            const int* trace = &faces[offset(f, m)];
            for (int q = 0; q < points; ++q) {
                const double* N = &face_values[offset(q, m)];
                double d = target.sample[offset(offset(f, points, q), dim, a)];
                for (int i = 0; i < m; ++i) d -= N[i] * ideal_at(trace[i], a);
                for (int i = 0; i < m; ++i) right[trace[i]] += face_weight[f] * target.quadrature.weight[q] * N[i] * d;
            }
        }
        factorisation.solve(right.data(), displacement.data());
        for (std::size_t t = 0; t < nodes.size(); ++t)
            g_h[t * dim + a] = ideal_at(static_cast<int>(t), a) + displacement[t];
    }
    return g_h;
}

}  // namespace almesh
