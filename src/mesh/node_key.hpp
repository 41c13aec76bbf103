// How elements that are made of others find the nodes that they share, how many there may be, and the ids of new nodes.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/index.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {

// A node by the vertices of the edge, face or element it lies in: (vertex, barycentric entry) for each non-zero entry,
// ascending by vertex, then (-1, 0). Elements that share a face find the same keys for the nodes on it.
using NodeKey = std::array<std::pair<int, int>, 4>;

struct NodeKeyHash {
    std::size_t operator()(const NodeKey& key) const {
        unsigned long long h = 14695981039346656037u;  // as FNV-1a, by whole pairs
        for (const auto& [vertex, entry] : key) h = (h ^ (offset(vertex, max_degree + 1, entry))) * 1099511628211u;
        return h;
    }
};

inline NodeKey key_of(const MultiIndex& a, const int* vertex, int dim) {
    NodeKey key;
    key.fill({-1, 0});
    int count = 0;
    for (int k = 0; k <= dim; ++k) {
        if (!a[k]) continue;
        int place = count++;  // insertion by vertex
        for (; place > 0 && key[place - 1].first > vertex[k]; --place) key[place] = key[place - 1];
        key[place] = {vertex[k], a[k]};
    }
    return key;
}

// The same in a cell of any type, for each node: its vertices by which it is found and their weights in lowest terms.
// Empty for a node that no other element has.
inline std::vector<std::vector<std::pair<int, int>>> shared_weights(const LagrangeBasis& basis) {
    std::vector<std::vector<std::pair<int, int>>> of_nodes(basis.count);
    for (int i = 0; i < basis.count; ++i) {
        const std::array<int, 8> weight = vertex_weights(basis.cell, basis.nodes[i]);
        const auto zeros = std::count(weight.begin(), weight.end(), 0);
        const int unit = std::accumulate(weight.begin(), weight.end(), 0, std::gcd<int, int>);
        for (int v = 0; v < basis.cell.vertices && zeros >= 4; ++v)
            if (weight[v] > 0) of_nodes[i].push_back({v, weight[v] / unit});
    }
    return of_nodes;
}

inline NodeKey key_of(const std::vector<std::pair<int, int>>& weights, const int* vertex) {
    NodeKey key;
    key.fill({-1, 0});
    for (std::size_t k = 0; k < weights.size(); ++k) key[k] = {vertex[weights[k].first], weights[k].second};
    std::sort(key.begin(), key.begin() + weights.size());
    return key;
}

// Refuses a mesh of this degree with so many times the elements where int cannot number what it would have.
inline void check_size(const Mesh& mesh, int degree, double times, const char* what) {
    double entries = 0;
    for (const ElementGroup& group : mesh.element_groups())
        entries += times * group.count * group.cell->node_count(degree);
    if (entries < std::numeric_limits<int>::max()) return;
    throw InputError(what, ": the mesh would have ", static_cast<long long>(entries),
                     " element nodes, more than this program can number");
}

// New nodes get ids that the mesh they come from does not have.
inline void append_node_ids(const Mesh& from, Mesh& mesh) {
    UnusedIds<long long> unused(from.file.node_id);
    while (static_cast<int>(mesh.file.node_id.size()) < mesh.nodes()) mesh.file.node_id.push_back(unused.next());
}

}  // namespace almesh
