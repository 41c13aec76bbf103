// Multilevel coarsening of graphs: groups of up to three vertices along heavy edges are merged into one. O(edges).
// Groups of three instead of pairs take two thirds of the levels, and give no worse separators. Large graphs are worked
// on in fixed blocks by all threads, with the same result for any number of them.
#pragma once
#include <cstdint>
#include <vector>

#include "linalg/ordering/graph.hpp"

namespace almesh {

// As Graph, with weights: a vertex represents `weight` vertices of the finest graph, an edge for `edge_weight` edges.
struct WeightedGraph {
    std::vector<int> start{0};
    std::vector<int> adjacent;
    std::vector<int> edge_weight;  // one per entry of adjacent
    std::vector<int> weight;       // one per vertex

    int size() const { return static_cast<int>(start.size()) - 1; }
};

// All weights 1.
WeightedGraph weighted(const Graph& graph);

// The vertices `kept` of a graph, in this order, and the edges among them.
WeightedGraph induced(const WeightedGraph& graph, const std::vector<int>& kept);

struct Coarsening {
    WeightedGraph graph;          // the merged graph
    std::vector<int> coarse_of;   // its vertex for every vertex of the finer graph
};

// Groups heavier than `heaviest` are not merged, so that the coarsest vertices stay comparable.
Coarsening coarsen(const WeightedGraph& graph, int heaviest, std::uint64_t seed);

// A graph and coarser ones made from it, one from the other, which nested dissection makes once and restricts to its
// pieces instead of coarsening every piece anew.
struct Hierarchy {
    WeightedGraph finest;
    std::vector<Coarsening> coarser;  // of the finest graph, of the one made from it, and so on

    const WeightedGraph& coarsest() const { return coarser.empty() ? finest : coarser.back().graph; }
};

// The graph coarsened up to `steps` times, as long as that leaves many vertices.
Hierarchy build_hierarchy(WeightedGraph finest, int steps, std::uint64_t seed);

// The part of all graphs that the vertices `kept` of the finest one, ascending, belong to. Coarse graphs that become
// too small are left out. Edges stay between merged vertices whose last common edge has gone: they do no harm, as a
// separator of the coarser graph is still one of the finer. O(edges).
Hierarchy restrict_to(const Hierarchy& whole, const std::vector<int>& kept);

}  // namespace almesh
