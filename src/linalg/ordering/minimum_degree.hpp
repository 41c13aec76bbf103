// Minimum degree ordering of small graphs, for the leaves of nested dissection.
//
// The elimination graph is kept explicitly, one row of bits per vertex, so degrees are exact and eliminating a vertex
// is a few word operations per neighbour: faster than a quotient graph up to a few hundred vertices, O(n^3 / 64) at
// worst.
#pragma once
#include <utility>
#include <vector>

namespace almesh {

struct SmallGraph {
    int size = 0;                            // vertices
    int eliminable = 0;                      // vertices [0, eliminable) are to be ordered, the rest (the halo) stays
    std::vector<int> weight;                 // one per vertex
    std::vector<std::pair<int, int>> edges;  // each edge once or twice, no loops
};

// The vertices [0, eliminable) in elimination order: always one of least weight of neighbours (halo included), the
// lowest number among equals.
std::vector<int> minimum_degree(const SmallGraph& graph);

}  // namespace almesh
