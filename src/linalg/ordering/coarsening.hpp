// One step of multilevel coarsening: groups of up to three vertices along heavy edges are merged into one. O(edges).
// Groups of three instead of pairs: two thirds of the levels, and no worse separators. Large graphs are worked on in
// fixed blocks by all threads, with the same result for any number of them.
#pragma once
#include <cstdint>
#include <vector>

namespace almesh {

// As Graph, with weights: a vertex stands for `weight` vertices of the finest graph, an edge for `edge_weight` edges.
struct WeightedGraph {
    std::vector<int> start{0};
    std::vector<int> adjacent;
    std::vector<int> edge_weight;  // one per entry of adjacent
    std::vector<int> weight;       // one per vertex

    int size() const { return static_cast<int>(start.size()) - 1; }
};

struct Coarsening {
    WeightedGraph graph;          // the merged graph
    std::vector<int> coarse_of;   // its vertex for every vertex of the finer graph
};

// Groups heavier than `heaviest` are not merged, so that the coarsest vertices stay comparable.
Coarsening coarsen(const WeightedGraph& graph, int heaviest, std::uint64_t seed);

}  // namespace almesh
