// A graph and coarser ones made from it, each by merging vertices of the one before, that nested dissection makes once
// and cuts to the size of its pieces instead of coarsening every piece anew.
//
// Cut pieces keep edges between merged vertices whose last common edge has gone. They do no harm: a separator of the
// coarser graph is still one of the finer. O(edges) to make and to cut.
#pragma once
#include <cstdint>
#include <vector>

#include "linalg/ordering/coarsening.hpp"

namespace almesh {

struct Hierarchy {
    WeightedGraph finest;
    std::vector<Coarsening> coarser;  // of the finest graph, of the one made from it, and so on

    const WeightedGraph& coarsest() const { return coarser.empty() ? finest : coarser.back().graph; }
};

// local[v] of the vertices kept, their place in `kept`; -1 of all others.
std::vector<int> numbered(int size, const std::vector<int>& kept);

// The vertices `kept` of a graph, numbered by local[v], and the edges among them; the vertices' weights are left out.
WeightedGraph induced(const WeightedGraph& from, const std::vector<int>& kept, const std::vector<int>& local);

// The graph coarsened up to `steps` times, as long as that leaves many vertices.
Hierarchy build_hierarchy(WeightedGraph finest, int steps, std::uint64_t seed);

// The part of all graphs that the vertices `kept` of the finest one, ascending, belong to. Coarse graphs that become
// too small to be worth it are left out.
Hierarchy restrict_to(const Hierarchy& whole, const std::vector<int>& kept);

}  // namespace almesh
