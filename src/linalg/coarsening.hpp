// One step of multilevel coarsening: heavy-edge matching, then merging of the matched pairs. O(edges).
#pragma once
#include <cstdint>
#include <vector>

#include "linalg/separator.hpp"

namespace almesh {

struct Coarsening {
    WeightedGraph graph;          // the merged graph
    std::vector<int> coarse_of;   // its vertex for every vertex of the finer graph
};

// Pairs heavier than `heaviest` are not merged, so that the coarsest vertices stay comparable.
Coarsening coarsen(const WeightedGraph& graph, int heaviest, std::uint64_t seed);

}  // namespace almesh
