// How elements that are made of others find the nodes that they share, and the ids of new nodes.
#pragma once
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "mesh/mesh.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {

// A node by the vertices of the edge, face or element it lies in: (vertex, barycentric entry) for each non-zero entry,
// ascending by vertex, then (-1, 0). Elements that share a face find the same keys for the nodes on it.
using NodeKey = std::array<std::pair<int, int>, 4>;

struct NodeKeyHash {
    std::size_t operator()(const NodeKey& key) const {
        std::size_t h = 14695981039346656037u;  // as FNV-1a, by whole pairs
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

// The same in a quadrilateral with entries (a_0, a_1, b_0, b_1): on an edge by its ends; else by the weights of all
// vertices, which tell its nodes apart.
inline NodeKey key_in_quadrilateral(const MultiIndex& a, const int* vertex) {
    const int degree = a[0] + a[1];
    const bool on_edge = a[0] * a[1] * a[2] * a[3] == 0;
    MultiIndex weight{};
    const std::array<int, 4> weights = vertex_weights(quadrilateral(), a);
    for (int k = 0; k < 4; ++k) weight[k] = weights[k] / (on_edge ? degree : 1);
    return key_of(weight, vertex, 3);
}

// New nodes get ids that the mesh they come from does not have.
inline void append_node_ids(const Mesh& from, Mesh& mesh) {
    std::vector<long long> taken = from.file.node_id;
    for (const LooseNode& node : from.file.loose) taken.push_back(node.id);
    UnusedIds<long long> unused(std::move(taken));
    while (static_cast<int>(mesh.file.node_id.size()) < mesh.nodes()) mesh.file.node_id.push_back(unused.next());
}

}  // namespace almesh
