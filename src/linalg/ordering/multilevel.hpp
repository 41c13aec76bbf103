// Vertex separators of graphs by the multilevel method: merge neighbours along heavy edges until few vertices are left
// (coarsening.cpp), split that graph from several seeds, and project the split back level by level, refining it at each
// with Fiduccia-Mattheyses moves (separator.cpp; Karypis & Kumar, SIAM J. Sci. Comput. 20, 1998; Hendrickson &
// Rothberg, same volume, for moves on vertex separators).
//
// Groups of up to three vertices instead of pairs take two thirds of the levels, and give no worse separators. Large
// graphs are coarsened in fixed blocks by all threads, with the same result for any number of them.
// Cost: O(edges) for each level, and the levels shrink geometrically.
#pragma once
#include <cstdint>
#include <vector>

#include "linalg/ordering/graph.hpp"

namespace almesh {

struct Coarsening {
    WeightedGraph graph;         // the merged graph
    std::vector<int> coarse_of;  // its vertex for every vertex of the finer graph
};

// One level. Groups heavier than `heaviest` are not merged, so that the coarsest vertices stay comparable.
Coarsening coarsen(const WeightedGraph& graph, int heaviest, std::uint64_t seed);

// At most `levels` of them at once, until at most `enough` vertices are left or none are merged.
Coarsening coarsen(const Graph& graph, int heaviest, int levels, int enough);

// A graph and coarser ones made from it, one from the other, which nested dissection makes once and restricts to its
// pieces instead of coarsening every piece anew.
struct Hierarchy {
    WeightedGraph finest;
    std::vector<Coarsening> coarser = {};  // of the finest graph, of the one made from it, and so on

    const WeightedGraph& coarsest() const { return coarser.empty() ? finest : coarser.back().graph; }
};

// The graph coarsened up to `steps` times, as long as that leaves many vertices.
Hierarchy build_hierarchy(WeightedGraph finest, int steps, std::uint64_t seed);

// The part of all graphs that the vertices `kept` of the finest one, ascending, belong to. Coarse graphs that become
// too small are left out. Edges stay between merged vertices whose last common edge has gone: they do no harm, as a
// separator of the coarser graph is still one of the finer. O(edges).
Hierarchy restrict_to(const Hierarchy& whole, const std::vector<int>& kept);

enum Part : unsigned char { left = 0, right = 1, separator = 2 };

// Part of every vertex of the finest graph such that no edge joins left and right, both hold less than about 60 % of
// the weight, and the separator is light. One side may be empty where the graph cannot be split. The same seed gives
// the same answer.
std::vector<Part> find_separator(const Hierarchy& graphs, std::uint64_t seed);

}  // namespace almesh
