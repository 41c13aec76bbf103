#include "constraint/trace_space.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/patch.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/vector_ops.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

constexpr double no_extent = 1e-14;  // of a face, over the mean

// Length of the edge or area of the triangle spanned by the face's vertices.
double simplex_measure(const Mesh& mesh, const std::vector<double>& ideal, int f) {
    const Vec<3> n = flat_normal(positions(mesh, ideal, mesh.face(f), mesh.dim), mesh.dim - 1);
    return mesh.dim == 2 ? std::hypot(n[0], n[1]) : 0.5 * length(n);
}

// |dx/da x dx/db| of the bilinear face with the same vertices, at the points of the rule.
std::vector<double> area_elements(const Mesh& mesh, const std::vector<double>& ideal, int f, const Quadrature& rule) {
    static const LagrangeBasis bilinear(quadrilateral(), 1);
    const std::vector<Vec<3>> corner = positions(mesh, ideal, mesh.face(f), 4);
    std::vector<double> elements;
    for (int q = 0; q < rule.count; ++q) {
        double dN[8];
        bilinear.gradients(&rule.xi[2 * q], dN);
        Vec<3> along[2] = {};
        for (int v = 0; v < 4; ++v)
            for (int k = 0; k < 2; ++k) along[k] = along[k] + dN[2 * v + k] * (corner[v] - corner[0]);
        elements.push_back(length(cross(along[0], along[1])));
    }
    return elements;
}

}  // namespace

TraceSpace::TraceSpace(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target)
    : dim(mesh.dim), measure_(mesh.face_count()) {
    face_weight.resize(mesh.face_count());
    const FaceRule& last = target.rules.back();
    if (!mesh.groups_of_faces.empty())
        density_.assign(last.sample(last.faces.first + last.faces.count, 0), 1);
    for (const FaceRule& rule : target.rules)
        for (int f = rule.faces.first; f < rule.faces.first + rule.faces.count; ++f)
            measure_[f] = measure(mesh, ideal, rule, f);
    const std::vector<NodeKind> boundary = kinds_of_boundaries(mesh, target.kind);
    const double mean = std::accumulate(measure_.begin(), measure_.end(), 0.0) / mesh.face_count();
    double one_squared = 0;
    for (const FaceRule& rule : target.rules)
        for (int f = rule.faces.first; f < rule.faces.first + rule.faces.count; ++f) {
            if (!(measure_[f] > no_extent * mean)) measure_[f] = mean;  // of a mesh that is to be untangled
            if (boundary[mesh.face_boundary[f]] == NodeKind::free) continue;
            const double h = mesh.dim == 2 ? measure_[f] : std::sqrt(measure_[f]);
            one_squared += measure_[f] / h;
            face_weight[f] = measure_[f] / h * rule.faces.cell->inverse_volume;
        }
    norm_of_one = std::sqrt(one_squared);
    number_nodes(mesh);
    measure_heights(mesh, ideal);
    assemble_mass(mesh, target);
}

TraceSpace::TraceSpace(const TraceSpace& whole, const Restriction& around)
    : dim(whole.dim), norm_of_one(whole.norm_of_one), whole_count_(whole.nodes.size()) {
    const int last = whole.nodes.empty() ? -1 : *std::max_element(whole.nodes.begin(), whole.nodes.end());
    std::vector<int> number(last + 1, -1), here(whole.count(), -1);  // mesh node, trace node -> ours
    for (std::size_t k = 0; k < around.node.size(); ++k)
        if (around.node[k] <= last) number[around.node[k]] = static_cast<int>(k);
    for (int t = 0; t < whole.count(); ++t) {
        const int node = number[whole.nodes[t]];
        if (node < 0) continue;
        here[t] = static_cast<int>(nodes.size());
        nodes.push_back(node);
        in_whole_.push_back(t);
    }
    height = restricted(whole.height);
    M.row.assign(1, 0);
    for (const int t : in_whole_) {
        const bool moves = nodes[M.n++] < around.moving;
        for (int k = whole.M.row[t]; k < whole.M.row[t + 1]; ++k) {
            const int s = here[whole.M.col[k]];
            if (s < 0 || !(moves || nodes[s] < around.moving)) continue;
            M.col.push_back(s);
            M.value.push_back(whole.M.value[k]);
        }
        M.row.push_back(M.blocks());
    }
}

double TraceSpace::measure(const Mesh& mesh, const std::vector<double>& ideal, const FaceRule& rule, int f) {
    if (rule.faces.cell->is_simplex()) return simplex_measure(mesh, ideal, f);
    const std::vector<double> elements = area_elements(mesh, ideal, f, rule.quadrature);
    double area = 0;
    for (int q = 0; q < rule.quadrature.count; ++q) area += rule.quadrature.weight[q] * elements[q];
    for (int q = 0; q < rule.quadrature.count; ++q) density_[rule.sample(f, q)] = area > 0 ? elements[q] / area : 1;
    return area;
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
    height.assign(nodes.size(), std::numeric_limits<double>::infinity());
    with_dimension(mesh.dim, [&](auto n) {
        for (int f = 0; f < mesh.face_count(); ++f) {
            const int e = mesh.face_element[f];
            const double volume = mesh.cell(e).is_simplex()
                                      ? determinant(straight_jacobian<n>(mesh.element(e), ideal)) / (mesh.dim - 1)
                                      : almesh::volume(mesh, ideal, e);
            // where a curved ideal element has vertices that span no volume: the size of the face
            const double of_face = volume > 0        ? volume / measure_[f]
                                   : mesh.dim == 2 ? measure_[f]
                                                   : std::sqrt(measure_[f]);
            for (int i = 0; i < mesh.face_nodes(f); ++i) {
                double& least = height[faces[mesh.face_start(f) + i]];
                least = std::min(least, of_face);
            }
        }
    });
}

void TraceSpace::assemble_mass(const Mesh& mesh, const BoundaryTarget& target) {
    std::vector<BlockCsr> patterns;
    std::vector<LargeVector<int>> place(target.rules.size());  // of each type's blocks in its pattern
    for (const FaceRule& rule : target.rules) {
        const int m = rule.faces.cell->node_count(mesh.degree);
        const auto begin = faces.begin() + static_cast<std::ptrdiff_t>(rule.faces.start);
        const std::vector<int> cells(begin, begin + static_cast<std::ptrdiff_t>(offset(rule.faces.count, m)));
        patterns.push_back(pattern_of_cells(static_cast<int>(nodes.size()), 1, cells, m, &place[patterns.size()]));
    }
    std::vector<const BlockCsr*> all;
    for (const BlockCsr& pattern : patterns) all.push_back(&pattern);
    std::vector<LargeVector<int>> joint;  // of each pattern's blocks in M
    M = joint_pattern(all, joint);
    M.value.assign(M.col.size(), 0.0);
    for (std::size_t g = 0; g < target.rules.size(); ++g) {
        const FaceRule& rule = target.rules[g];
        const bool is_affine = rule.faces.cell->is_simplex();
        const int m = rule.faces.cell->node_count(mesh.degree);
        std::vector<double> reference;  // integrals of N_i N_j over the reference face, by the area of this one
        for (int f = rule.faces.first; f < rule.faces.first + rule.faces.count; ++f) {
            if (!is_affine || f == rule.faces.first) reference = products(rule, f, m);
            for (int ij = 0; ij < m * m; ++ij)
                M.value[joint[g][place[g][offset(f - rule.faces.first, m * m, ij)]]] += face_weight[f] * reference[ij];
        }
    }
}

std::vector<double> TraceSpace::products(const FaceRule& rule, int f, int m) const {
    std::vector<double> integral(m * m, 0.0);
    for (int q = 0; q < rule.quadrature.count; ++q)
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j)
                integral[i * m + j] += weight(rule, f, q) * rule.values[offset(q, m, i)] * rule.values[offset(q, m, j)];
    return integral;
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
    std::vector<double> result;
    for (int t = 0; t < count(); ++t) result.push_back(length(at_node(x, nodes[t], dim) - at_node(y, t, dim)));
    return result;
}

std::vector<double> TraceSpace::interpolation(const Mesh& mesh, const BoundaryTarget& target) const {
    std::vector<double> g_h(size());
    for (std::size_t k = faces.size(); k-- > 0;)  // the first face that has a node decides, as in at_target()
        for (int a = 0; a < mesh.dim; ++a) g_h[offset(faces[k], mesh.dim, a)] = target.node[k * mesh.dim + a];
    return g_h;
}

// Solves M (g_h - y) = (N, g_D - y), y the interpolation, for the nodes that are not held; the others have y.
std::vector<double> TraceSpace::projection(const Mesh& mesh, const BoundaryTarget& target) const {
    const std::vector<double> y = interpolation(mesh, target);
    std::vector<char> held(nodes.size(), 0);
    for (std::size_t k = 0; k < faces.size(); ++k)
        if (target.kind[k] == NodeKind::fixed) held[faces[k]] = 1;
    BlockCsr A = M;
    for (int t = 0; t < count(); ++t)
        for (int k = A.row[t]; k < A.row[t + 1]; ++k)
            if (A.col[k] != t && (held[t] || held[A.col[k]])) A.value[k] = 0;
    Cholesky factorisation(A);
    if (factorisation.factor(A).status != SolveStatus::success)
        throw InputError(
            "the mass matrix of the boundary cannot be factored: a boundary face is degenerate or memory is short");
    std::vector<double> right(nodes.size()), difference(nodes.size()), g_h = y;
    for (int a = 0; a < dim; ++a) {
        std::fill(right.begin(), right.end(), 0.0);
        for (const FaceRule& rule : target.rules) {
            const int m = rule.faces.cell->node_count(mesh.degree);
            for (int f = rule.faces.first; f < rule.faces.first + rule.faces.count; ++f) {
                const int* trace = &faces[mesh.face_start(f)];
                for (int q = 0; q < rule.quadrature.count; ++q) {
                    const double* N = &rule.values[offset(q, m)];
                    double d = target.sample[rule.sample(f, q) * dim + a];
                    for (int i = 0; i < m; ++i) d -= N[i] * y[offset(trace[i], dim, a)];
                    for (int i = 0; i < m; ++i) right[trace[i]] += face_weight[f] * weight(rule, f, q) * N[i] * d;
                }
            }
        }
        for (int t = 0; t < count(); ++t) right[t] *= !held[t];
        factorisation.solve(right.data(), difference.data());
        for (int t = 0; t < count(); ++t) g_h[offset(t, dim, a)] += difference[t];
    }
    return g_h;
}

}  // namespace almesh
