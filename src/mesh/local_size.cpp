// v_i = mean of V_e over the elements at node i,   V_e <- mean of v_i over the nodes of e: first for elements without a
// volume, layer by layer, then once for all.
//
// The map from the regular cell to an element is known but for a rotation by T = V S V^T, with the singular values S
// and right singular vectors V of its mean Jacobian. Where an element does not count, the logarithms of S are the means
// of its neighbours', mostly of those in the same layer, and the first column of V is that of an edge across the layer.
// These edges, and the layers, are found from the boundary: nodes are joined by edges much shorter than others at their
// ends, or as the only ones left between two levels. So they do not depend on where a few nodes have been pushed.
// Outside layers it is a regular cell.
#include "mesh/local_size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "linalg/dense_solve.hpp"
#include "mesh/part.hpp"
#include "mesh/quadrature.hpp"
#include "mesh/regular_cell.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// 0 for elements and nodes that have none yet.
std::vector<double> at_vertices(const Mesh& mesh, const std::vector<double>& of_elements) {
    std::vector<double> sum(mesh.nodes(), 0);
    std::vector<int> count(mesh.nodes(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.cell(e).vertices && of_elements[e] > 0; ++k) {
            sum[mesh.element(e)[k]] += of_elements[e];
            ++count[mesh.element(e)[k]];
        }
    for (int i = 0; i < mesh.nodes(); ++i) sum[i] /= std::max(count[i], 1);
    return sum;
}

double mean_of_vertices(const Mesh& mesh, int e, const std::vector<double>& of_vertices) {
    double sum = 0;
    int count = 0;
    for (int k = 0; k < mesh.cell(e).vertices; ++k) {
        sum += of_vertices[mesh.element(e)[k]];
        count += of_vertices[mesh.element(e)[k]] > 0;
    }
    return sum / std::max(count, 1);
}

constexpr int unknown = 1000000;

// Per node the edges to others, the shortest first, and which of these are much shorter than others at both ends.
struct NodeEdges {
    std::vector<std::vector<std::pair<int, double>>> of;  // the other end, and the length
    std::vector<double> usual;                            // the length after the largest jump

    NodeEdges(const Mesh& mesh, const std::vector<double>& x) : of(mesh.nodes()) {
        for (int e = 0; e < mesh.element_count(); ++e)
            for (const auto [v, w] : mesh.cell(e).edges) {
                const int i = mesh.element(e)[v], j = mesh.element(e)[w];
                double squared = 0;
                for (int a = 0; a < mesh.dim; ++a)
                    squared += std::pow(point(x, i, mesh.dim)[a] - point(x, j, mesh.dim)[a], 2);
                of[i].push_back({j, std::sqrt(squared)});
                of[j].push_back({i, std::sqrt(squared)});
            }
        for (auto& edges : of) {
            std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
            usual.push_back(0);
            double jump = 1;
            for (std::size_t k = 1; k < edges.size(); ++k) {
                const double before = edges[k - 1].second, length = edges[k].second;
                if (!(length > jump * before)) continue;
                if (before > 0) jump = length / before;
                usual.back() = length;
            }
        }
    }

    bool is_short(int i, int j, double length) const {
        constexpr double shorter = 0.3;
        return length < shorter * std::min(usual[i], usual[j]);
    }
};

// The nodes of faces that short edges leave, and on which none lies, by what hangs together.
std::map<int, std::vector<int>> walls_of(const Mesh& mesh, const NodeEdges& edges) {
    std::vector<char> on_boundary(mesh.nodes(), 0), on_wall(mesh.nodes(), 0);
    for (const int i : mesh.faces) on_boundary[i] = 1;
    DisjointSets walls(mesh.nodes());
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::span<const int> vertices = mesh.face_vertices(f);
        bool has_short = false, leaves = false;
        for (const int i : vertices)
            for (const auto& [j, length] : edges.of[i]) {
                if (!edges.is_short(i, j, length)) continue;
                has_short = has_short || std::find(vertices.begin(), vertices.end(), j) != vertices.end();
                leaves = leaves || !on_boundary[j];
            }
        for (const int i : vertices) {
            if (!leaves || has_short) continue;
            on_wall[i] = 1;
            walls.join(i, vertices[0]);
        }
    }
    std::map<int, std::vector<int>> nodes;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (on_wall[i]) nodes[walls.find(i)].push_back(i);
    return nodes;
}

// Gives the nodes beyond these, along short edges, the next levels.
void spread(const NodeEdges& edges, std::vector<int> front, std::vector<int>& level) {
    for (std::vector<int> next; !front.empty(); front.swap(next), next.clear())
        for (const int i : front)
            for (const auto& [j, length] : edges.of[i])
                if (level[i] != unknown && level[j] == unknown && edges.is_short(i, j, length)) {
                    level[j] = level[i] + 1;
                    next.push_back(j);
                }
}

// Per node: the number of short edges from a wall to it, or unknown. Layers may go from one wall to another.
std::vector<int> levels_of(const Mesh& mesh, const NodeEdges& edges) {
    std::vector<int> level(mesh.nodes(), unknown);
    for (const auto& [first, nodes] : walls_of(mesh, edges)) {
        const auto is_reached = [&](int i) { return level[i] != unknown; };
        if (2 * std::count_if(nodes.begin(), nodes.end(), is_reached) > static_cast<int>(nodes.size())) continue;
        for (const int i : nodes)
            if (!is_reached(i)) level[i] = 0;
        spread(edges, nodes, level);
    }
    const std::vector<int> before = level;
    std::vector<int> all(mesh.nodes());
    std::iota(all.begin(), all.end(), 0);
    for (const int i : all) {  // whose short edges are long: as most of the nodes around them
        std::vector<int> around;
        for (const auto& [j, length] : edges.of[i])
            if (before[j] != unknown) around.push_back(before[j]);
        std::sort(around.begin(), around.end());
        if (level[i] == unknown && !around.empty() && 2 * around.size() >= edges.of[i].size())
            level[i] = around[around.size() / 2];
    }
    spread(edges, all, level);
    return level;
}

// Per node its level, and the node of the next one where the edge across the layer ends; or unknown.
struct Levels {
    std::vector<int> level, next;

    Levels(const Mesh& mesh, const std::vector<double>& x) : next(mesh.nodes(), unknown) {
        const NodeEdges edges(mesh, x);
        level = levels_of(mesh, edges);
        std::vector<int> down = next;
        std::vector<std::tuple<double, int, int>> across;  // the shortest first
        for (int i = 0; i < mesh.nodes(); ++i)
            for (const auto& [j, length] : edges.of[i])
                if (level[i] != unknown && level[j] == level[i] + 1) across.push_back({length, i, j});
        std::sort(across.begin(), across.end());
        for (const auto& [length, i, j] : across) {
            if (next[i] != unknown || down[j] != unknown) continue;
            next[i] = j;
            down[j] = i;
        }
    }

    bool has_across(int i, int j) const { return next[i] == j || next[j] == i; }
};

// Lets the values of the elements that do not count be the mean of their neighbours' and, a little, what they were.
template <int n>
void extend(const Mesh& mesh, const std::vector<int>& layer, const std::vector<char>& counts,
            std::vector<Vec<n>>& value) {
    constexpr int most_sweeps = 500;
    constexpr double of_itself = 1e-4, across_layers = 1e-3, change = 1e-4;
    const int most = mesh.most_sides(), count = mesh.element_count();
    std::vector<Side> sides;
    for_sides(mesh, [&](int e, int k, int number) { sides.push_back(side_of_element(mesh, e, k, number)); });
    std::vector<std::vector<int>> neighbours(count);  // of those that do not count
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        const int e = equal.front().number / most, f = equal.back().number / most;
        if (e == f || layer[e] == unknown || layer[f] == unknown) return;
        if (!counts[e]) neighbours[e].push_back(f);
        if (!counts[f]) neighbours[f].push_back(e);
    });
    const std::vector<Vec<n>> before = value;
    double largest = 1;
    for (int sweep = 0; sweep < most_sweeps && largest > change; ++sweep) {
        largest = 0;
        for (int k = 0; k < count; ++k) {
            const int e = sweep % 2 ? count - 1 - k : k;
            if (neighbours[e].empty()) continue;
            double sum = of_itself;
            Vec<n> mean = before[e];
            for (double& v : mean) v *= of_itself;
            for (const int f : neighbours[e]) {
                const double weight = layer[e] == layer[f] ? 1 : across_layers;
                sum += weight;
                for (int i = 0; i < n; ++i) mean[i] += weight * value[f][i];
            }
            for (int i = 0; i < n; ++i) {
                mean[i] /= sum;
                largest = std::max(largest, std::abs(mean[i] - value[e][i]));
            }
            value[e] = mean;
        }
    }
}

// T of an element: its right singular vectors, in columns, and the logarithms of its singular values, ascending.
template <int n>
struct Map {
    Mat<n> V;
    Vec<n> log;

    explicit Map(const Mat<n>& B) {
        Mat<n> G = multiply<n>(transpose<n>(B), B), W;
        diagonalise(n, G[0].data(), W[0].data());
        std::array<int, n> order;
        std::iota(order.begin(), order.end(), 0);
        std::sort(order.begin(), order.end(), [&](int i, int j) { return G[i][i] < G[j][j]; });
        for (int k = 0; k < n; ++k) {
            log[k] = 0.5 * std::log(G[order[k]][order[k]]);
            for (int i = 0; i < n; ++i) V[i][k] = W[i][order[k]];
        }
    }
};

// Of the straight element with these vertices.
template <int n>
Mat<n> mean_jacobian(const int* node, const std::vector<double>& x, const ReferenceElement& reference) {
    Mat<n> mean{};
    for (int q = 0; q < reference.points; ++q) {
        const Mat<n> J = jacobian_at<n>(node, x, reference, q);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) mean[i][j] += J[i][j] * reference.weight[q] / reference.cell->volume();
    }
    return mean;
}

// B without what it does along `across`, a vector of the regular cell.
template <int n>
Mat<n> without(const Vec<n>& across, const Mat<n>& B) {
    double squared = 0;
    for (const double a : across) squared += a * a;
    Mat<n> result = B;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) result[i][j] -= B[i][k] * across[k] * across[j] / squared;
    return result;
}

template <int n>
std::vector<double> shapes(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& counts) {
    const std::vector<double> volumes = local_volumes(mesh, x, counts);
    const Levels of_nodes(mesh, x);
    std::vector<int> layer;  // per element, or unknown
    std::vector<Mat<n>> V;
    std::vector<Vec<n>> log;
    bool in_layers = false;
    for (const ElementGroup& group : mesh.element_groups()) {
        constexpr int vertices[] = {0, 1, 2, 3, 4, 5, 6, 7};
        const std::vector<double> regular = regular_nodes(*group.cell, 1);
        const ReferenceElement reference = reference_element(*group.cell, 1, cell_quadrature(*group.cell, 2));
        const Mat<n> to_regular = inverse<n>(mean_jacobian<n>(vertices, regular, reference));
        for (const int e : elements_of(group)) {
            const int* const node = mesh.element(e);
            layer.push_back(unknown);
            Vec<n> across{};
            for (const auto [v, w] : group.cell->edges) {
                if (layer[e] != unknown || !of_nodes.has_across(node[v], node[w])) continue;
                layer[e] = std::min(of_nodes.level[node[v]], of_nodes.level[node[w]]);
                for (int i = 0; i < n; ++i) across[i] = regular[w * n + i] - regular[v * n + i];
            }
            const Mat<n> B = multiply<n>(mean_jacobian<n>(node, x, reference), to_regular);
            const bool is_guessed = !counts[e] && layer[e] != unknown;
            in_layers = in_layers || is_guessed;
            Map<n> map(is_guessed ? without<n>(across, B) : B);
            if (!counts[e]) map.log.fill(std::log(volumes[e] / group.cell->volume()) / n);
            else {  // the least is more exact than the root of an eigenvalue
                map.log[0] = std::log(determinant(B));
                for (int k = 1; k < n; ++k) map.log[0] -= map.log[k];
            }
            V.push_back(map.V);
            log.push_back(map.log);
        }
    }
    if (!in_layers) return {};
    extend<n>(mesh, layer, counts, log);
    std::vector<double> maps;
    for (int e = 0; e < mesh.element_count(); ++e) {
        Mat<n> VS = V[e];
        for (int k = 0; k < n; ++k)
            for (int i = 0; i < n; ++i) VS[i][k] *= std::exp(log[e][k]);
        for (const auto& row : multiply<n>(VS, transpose<n>(V[e]))) maps.insert(maps.end(), row.begin(), row.end());
    }
    return maps;
}

}  // namespace

std::vector<double> local_shapes(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& counts) {
    return mesh.dim == 2 ? shapes<2>(mesh, x, counts) : shapes<3>(mesh, x, counts);
}

std::vector<double> local_volumes(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& valid) {
    std::vector<double> V(mesh.element_count(), 0);
    double total = 0;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const double of = volume(mesh, x, e);
        total += of;
        if (valid[e]) V[e] = std::max(of, 0.0);
    }
    if (std::all_of(V.begin(), V.end(), [](double v) { return v == 0; })) std::fill(V.begin(), V.end(), 1);
    for (std::vector<double> before; V != before;) {  // what hangs together with no element that has one stays 0
        before = V;
        const std::vector<double> of_vertices = at_vertices(mesh, V);
        for (int e = 0; e < mesh.element_count(); ++e)
            if (V[e] == 0) V[e] = mean_of_vertices(mesh, e, of_vertices);
    }
    const std::vector<double> of_vertices = at_vertices(mesh, V);
    for (int e = 0; e < mesh.element_count(); ++e) V[e] = mean_of_vertices(mesh, e, of_vertices);
    const double sum = std::accumulate(V.begin(), V.end(), 0.0), mean = sum / mesh.element_count();
    for (double& v : V) {
        if (v == 0) v = mean;
        if (total > 0) v *= total / sum;
    }
    return V;
}

}  // namespace almesh
